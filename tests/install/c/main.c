/* What a C host writes: prints how many polygons are seen from the middle of every cell. */
#include <sightcell/sightcell.h>
#include <stdio.h>

int main(int argc, char **argv) {
  sightcell_db *db = NULL;
  sightcell_view *view = NULL;
  if (argc != 2 || sightcell_version() != SIGHTCELL_API_VERSION) return 2;
  if (sightcell_db_open_file(argv[1], NULL, &db) != SIGHTCELL_OK) return 1;
  if (sightcell_view_create(db, &view) != SIGHTCELL_OK) return 1;
  for (uint32_t cell = 0; cell < sightcell_db_cell_count(db); ++cell) {
    sightcell_frame frame;
    float min[3], max[3], eye[3];
    if (sightcell_db_cell_box(db, cell, min, max) != SIGHTCELL_OK) return 1;
    for (int axis = 0; axis < 3; ++axis) eye[axis] = 0.5f * (min[axis] + max[axis]);
    if (sightcell_view_move(view, eye, &frame) != SIGHTCELL_OK) return 1;
    printf("cell %u: %u\n", (unsigned)cell, (unsigned)frame.polygon_count);
  }
  sightcell_view_destroy(view);
  sightcell_db_close(db);
  return 0;
}
