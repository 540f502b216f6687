/* The snippet of README.md and docs/hosting.md, compiled and run. What the host brings is around it; check_readme.py
 * compares the documents with the text between the markers. */
#include <sightcell/sightcell.h>
#include <stdio.h>

static unsigned long drawn = 0;

static int draw_everything(void) { return 1; }

static void draw_triangles(const sightcell_draw* from, uint32_t first_index, uint32_t index_count) {
  if (first_index + index_count <= 3 * from->polygon_count) drawn += index_count / 3;
}

/* Three frames on a line through the first cell. */
static int next_frame(float eye[3]) {
  static int frame = 0;
  eye[0] = 0.25f * (float)frame, eye[1] = 0.5f, eye[2] = 0.5f;
  return frame++ < 3;
}

static int walk(const char* file, sightcell_draw* draws, size_t draw_capacity, sightcell_range* ranges,
                size_t range_capacity) {
  float eye[3];
  /* [ten lines */
  sightcell_db* db;
  sightcell_view* view;
  sightcell_frame frame;
  size_t count;

  if (sightcell_db_open_file(file, NULL, &db) != SIGHTCELL_OK) return draw_everything();
  if (sightcell_view_create(db, &view) != SIGHTCELL_OK) return draw_everything();
  sightcell_db_draws(db, draws, draw_capacity, &count);  /* not in the order of the scene: look each draw up */
  while (next_frame(eye)) {
    sightcell_view_move(view, eye, &frame);              /* decodes only when the view cell changes */
    sightcell_view_ranges(view, ranges, range_capacity, &count);
    for (size_t i = 0; i < count; ++i) {
      const sightcell_draw* d = &draws[ranges[i].draw];  /* glTF node, primitive and instance */
      draw_triangles(d, 3 * ranges[i].first, 3 * ranges[i].count);
    }
  }
  sightcell_view_destroy(view);
  sightcell_db_close(db);
  /* ten lines] */
  return 0;
}

int main(int argc, char** argv) {
  sightcell_draw draws[64];
  sightcell_range ranges[64];
  if (argc != 2 || walk(argv[1], draws, sizeof draws / sizeof *draws, ranges, sizeof ranges / sizeof *ranges) != 0)
    return 1;
  printf("%lu polygons drawn\n", drawn);
  return drawn > 0 ? 0 : 1;
}
