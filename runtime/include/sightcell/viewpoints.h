/* viewpoints.h: camera positions in the cells of a file at which its sets hold, and the error bounds of cells.
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
 * Fails with ABSENT if the file has no viewpoint of this number for the cell: files of version 0 and of bakes before
 *   bake version 22 have none. There is no substitute: the runtime cannot distinguish valid viewpoints from others.
 *   Fails with CHECKSUM or CORRUPT if this part of the file is damaged, which open does not check; with PENDING before
 *   sightcell_db_opened has returned OK.
 * Cost: O(cells), because it checks that part of the file. Not for calls per frame. */
SIGHTCELL_API sightcell_status sightcell_db_cell_eye(const sightcell_db* db, uint32_t cell, uint32_t number,
                                                     float eye[3]);

/* Lists the upper bound of the miss probability of each cell (ERROR BOUND in sightcell.h), in the order of the cells.
 * info.max_pixel_error is the largest of them. For maps and tools.
 * dst: receives a number 0 .. 1 for each cell; 1 for a cell whose bound was not measured.
 * capacity, count: in cells.
 * Fails with ABSENT if the file has no bounds; with PENDING before sightcell_db_opened has returned OK.
 * Cost: O(cells). Not for calls per frame. */
SIGHTCELL_API sightcell_status sightcell_db_error_bounds(const sightcell_db* db, float* dst, size_t capacity,
                                                        size_t* count);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_VIEWPOINTS_H */
