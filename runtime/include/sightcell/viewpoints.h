/* viewpoints.h: camera positions in the cells of a file at which its sets hold.
 *
 * The center of a cell, or a random point in it, is often inside a wall or a piece of furniture. There the picture is
 * wrong, because the set does not hold (EYE POSITIONS in sightcell.h). The bake stores one or a few valid viewpoints of
 * each cell. Tests, camera tours and positions to start from should use these.
 *
 * The conventions of sightcell.h hold here too.
 */
#ifndef SIGHTCELL_VIEWPOINTS_H
#define SIGHTCELL_VIEWPOINTS_H

#include "sightcell/sightcell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Returns a valid viewpoint of a cell. It is in the box of the cell, without the margin.
 * number: 0 for the first one, which each cell of a new bake has; wide cells have further ones, away from each other.
 * eye: receives the position, in meters of world space.
 * Fails with ABSENT if the cell has no viewpoint of this number in the file. A file of a bake before version 22 has none,
 *   and so has a file of version 0. There is no substitute: the runtime cannot tell valid viewpoints from others. Fails
 *   with CHECKSUM or CORRUPT if this part of the file is damaged, which open does not check; with PENDING before
 *   sightcell_db_opened has returned OK.
 * Cost: O(cells), because it checks that part of the file. Not for calls per frame. */
SIGHTCELL_API sightcell_status sightcell_db_cell_eye(const sightcell_db* db, uint32_t cell, uint32_t number,
                                                     float eye[3]);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_VIEWPOINTS_H */
