/* Opens a .pvs file, moves an eye through its view cells and prints how much there is to draw. Needs no window and no
 * scene file. */
#include <sightcell/sightcell.h>
#include <sightcell/viewpoints.h>
#include <stdio.h>
#include <stdlib.h>

static int fail(const char *what, sightcell_status status) {
  fprintf(stderr, "sightcell-hello-cull: %s: %s\n", what, sightcell_status_text(status));
  return 1;
}

/* One frame: moves the eye and takes the draw ranges. A renderer would draw each range here: 3 * count indices of the
 * index buffer of its draw, starting at index 3 * first. For a merged file it would draw them from the one index buffer
 * of the scene, counted from the first index of the draw group. */
static sightcell_status show(sightcell_view *view, uint32_t all, const float eye[3], sightcell_range *ranges,
                             size_t capacity) {
  sightcell_frame frame;
  size_t count = 0;
  sightcell_status status = sightcell_view_move(view, eye, &frame);
  if (status == SIGHTCELL_OK) status = sightcell_view_ranges(view, ranges, capacity, &count);
  if (status != SIGHTCELL_OK) return status;
  printf("eye %9.3f %9.3f %9.3f  ", eye[0], eye[1], eye[2]);
  if (frame.cell == SIGHTCELL_NO_CELL) {
    printf("outside      ");
  } else {
    printf("cell %7u ", (unsigned)frame.cell);
  }
  printf("draws %9u of %9u polygons (%6.2f %%) in %6zu ranges%s%s%s\n", (unsigned)frame.polygon_count, (unsigned)all,
         all > 0 ? 100.0 * frame.polygon_count / all : 0.0, count,
         (frame.flags & SIGHTCELL_FRAME_CHANGED) ? " changed" : "",
         (frame.flags & SIGHTCELL_FRAME_DRAW_ALL) ? " draw-all" : "",
         (frame.flags & SIGHTCELL_FRAME_DAMAGED) ? " damaged" : "");
  return SIGHTCELL_OK;
}

/* A valid viewpoint of a cell. A file of an older bake has none: then the center of the cell, which may be inside a wall,
 * where the set does not hold. */
static sightcell_status find_eye(const sightcell_db *db, uint32_t cell, float eye[3]) {
  float min[3], max[3];
  sightcell_status status = sightcell_db_cell_eye(db, cell, 0, eye);
  if (status != SIGHTCELL_ERR_ABSENT) return status;
  status = sightcell_db_cell_box(db, cell, min, max);
  for (int axis = 0; axis < 3; ++axis) eye[axis] = 0.5f * (min[axis] + max[axis]);
  return status;
}

/* Moves the eye to a valid viewpoint of each cell. */
static sightcell_status walk_cells(const sightcell_db *db, sightcell_view *view, uint32_t all, sightcell_range *ranges,
                                   size_t capacity) {
  sightcell_status status = SIGHTCELL_OK;
  for (uint32_t cell = 0; cell < sightcell_db_cell_count(db) && status == SIGHTCELL_OK; ++cell) {
    float eye[3];
    status = find_eye(db, cell, eye);
    if (status == SIGHTCELL_OK) status = show(view, all, eye, ranges, capacity);
  }
  return status;
}

/* Moves the eye to each of the positions given on the command line, three numbers each. */
static sightcell_status walk_positions(sightcell_view *view, uint32_t all, int count, char **numbers,
                                       sightcell_range *ranges, size_t capacity) {
  sightcell_status status = SIGHTCELL_OK;
  for (int i = 0; i + 2 < count && status == SIGHTCELL_OK; i += 3) {
    float eye[3];
    for (int axis = 0; axis < 3; ++axis) {
      char *end = NULL;
      eye[axis] = strtof(numbers[i + axis], &end);
      if (end == numbers[i + axis] || *end != '\0') return SIGHTCELL_ERR_ARGUMENT;
    }
    status = show(view, all, eye, ranges, capacity);
  }
  return status;
}

int main(int argc, char **argv) {
  if (argc < 2 || (argc - 2) % 3 != 0) {
    fprintf(stderr, "usage: sightcell-hello-cull FILE.pvs [X Y Z]...\n");
    return 2;
  }
  sightcell_db *db = NULL;
  sightcell_view *view = NULL;
  sightcell_range *ranges = NULL;
  sightcell_info info = {.struct_size = sizeof info};

  sightcell_status status = sightcell_db_open_file(argv[1], NULL, &db);
  if (status != SIGHTCELL_OK) return fail(argv[1], status);
  status = sightcell_db_info(db, &info);
  if (status == SIGHTCELL_OK) {
    printf("%s: %u polygons, %u draws, %u cells, pixel error at most %.3g\n", argv[1], (unsigned)info.polygon_count,
           (unsigned)info.draw_count, (unsigned)info.cell_count, info.max_pixel_error);
    ranges = malloc((info.range_bound + (size_t)1) * sizeof *ranges);
    status = ranges == NULL ? SIGHTCELL_ERR_MEMORY : sightcell_view_create(db, &view);
  }
  if (status == SIGHTCELL_OK) {
    status = argc == 2 ? walk_cells(db, view, info.polygon_count, ranges, info.range_bound)
                       : walk_positions(view, info.polygon_count, argc - 2, argv + 2, ranges, info.range_bound);
  }
  sightcell_view_destroy(view);
  sightcell_db_close(db);
  free(ranges);
  return status == SIGHTCELL_OK ? 0 : fail(argv[1], status);
}
