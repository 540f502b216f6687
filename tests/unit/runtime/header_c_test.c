/* The headers are C11, and their structs have the sizes and offsets that other tools count on. */
#include <sightcell/casters.h>
#include <sightcell/clusters.h>
#include <sightcell/identity.h>
#include <sightcell/lights.h>
#include <sightcell/residency.h>
#include <sightcell/sightcell.h>
#include <sightcell/viewpoints.h>
#include <stdio.h>

_Static_assert(sizeof(sightcell_frame) == 64, "for ever");
_Static_assert(offsetof(sightcell_frame, revision) == 12, "frame");
_Static_assert(sizeof(sightcell_range) == 12, "range");
_Static_assert(sizeof(sightcell_draw) == 48, "draw");
_Static_assert(offsetof(sightcell_draw, host_tag) == 40, "draw");
_Static_assert(sizeof(sightcell_info) == 60, "info");
_Static_assert(offsetof(sightcell_info, range_bound) == 24, "info");
_Static_assert(offsetof(sightcell_info, scene_fingerprint) == 40, "info");
_Static_assert(offsetof(sightcell_info, player_radius) == 56, "info");
_Static_assert(SIGHTCELL_ERR_STALE == 4 && SIGHTCELL_ERR_IO == 10 && SIGHTCELL_ERR_NOT_OURS == 20, "statuses");
_Static_assert(SIGHTCELL_ERR_OTHER_SCENE == 26 && SIGHTCELL_ERR_CHECKSUM == 23, "statuses");
_Static_assert(SIGHTCELL_FRAME_DAMAGED == 16 && SIGHTCELL_FRAME_DRAW_ALL == 2, "flags");
_Static_assert(sizeof(sightcell_cluster_word) == 8, "word of a row");
_Static_assert(sizeof(sightcell_sun) == 24, "sun");
_Static_assert(sizeof(sightcell_light) == 40, "light");
_Static_assert(sizeof(sightcell_texture) == 12, "texture");

int main(int argc, char** argv) {
  sightcell_db* db = NULL;
  if (argc != 2 || sightcell_version() != SIGHTCELL_API_VERSION) return 2;
  sightcell_status status = sightcell_db_open_file(argv[1], NULL, &db);
  if (status != SIGHTCELL_OK) {
    fprintf(stderr, "%s\n", sightcell_status_text(status));
    return 1;
  }
  status = sightcell_db_check(db);
  sightcell_db_close(db);
  return status == SIGHTCELL_OK ? 0 : 1;
}
