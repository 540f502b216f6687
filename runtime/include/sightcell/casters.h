/* casters.h: the polygons that a renderer draws into the shadow map of a sun.
 *
 * A host that culls its shadow map by the set of the camera loses shadows: polygons that the camera does not see cast
 * shadows on what it sees. `sightcell bake --sun` finds these casters for each cell and sun. A shadow map needs the set
 * of the camera and the casters; both together are the outputs of this header.
 *
 *   1. sightcell_casters_create   once per view
 *   2. sightcell_casters_suns     once, for the number of each sun
 *   3. sightcell_view_casters     where the frame has SIGHTCELL_FRAME_CHANGED, or the sun is another one
 *
 * The conventions of sightcell.h hold here too: statuses, lists, memory, threads, fail open.
 *
 * ERROR BOUND. The file has a bound for each cell and sun: of the probability that a ray from a valid viewpoint, in a
 * random direction, shows a point that these polygons leave lit by mistake.
 */
#ifndef SIGHTCELL_CASTERS_H
#define SIGHTCELL_CASTERS_H

#include "sightcell/sightcell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The casters of a file, with the memory that their output needs. Used by one thread at a time. */
typedef struct sightcell_casters sightcell_casters;

/* A sun of the file. It moves from one direction to the other; both are equal where it does not move. */
typedef struct sightcell_sun {
  float from[3]; /* unit vector toward the sun */
  float to[3];
} sightcell_sun;

/* Opens the shadow casters of a file.
 * db: must outlive the casters.
 * out: receives the casters, or NULL on failure.
 * Fails with ARGUMENT; with ABSENT if the file has no casters, or pages; with CHECKSUM or CORRUPT if they are damaged;
 *   with MEMORY; with PENDING before sightcell_db_opened has returned OK.
 * Cost: reads all casters once. One allocation of the allocator of db: 62 KB and at most 5 bytes per polygon. */
SIGHTCELL_API sightcell_status sightcell_casters_create(const sightcell_db* db, sightcell_casters** out);

/* Destroys casters and releases their memory. NULL is allowed. */
SIGHTCELL_API void sightcell_casters_destroy(sightcell_casters* casters);

/* Lists the suns of the file, in the order of the bake.
 * dst, capacity, count: in suns, 1 or more. */
SIGHTCELL_API sightcell_status sightcell_casters_suns(const sightcell_casters* casters, sightcell_sun* dst,
                                                      size_t capacity, size_t* count);

/* Lists the polygons to draw into the shadow map of a sun as ranges, in ascending order of draws, then of first: those
 * of the last move, and the casters of the cells that it shows. Everything under DRAW_ALL, and where the casters of a
 * cell are damaged. Hidden named groups are left out.
 * casters: of the db of the view.
 * sun: its number.
 * dst, capacity, count: in ranges.
 * Fails with ARGUMENT also if casters are of another db and if there is no such sun.
 * Cost: O(polygons / 64 + ranges). Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_view_casters(const sightcell_view* view, sightcell_casters* casters,
                                                      uint32_t sun, sightcell_range* dst, size_t capacity,
                                                      size_t* count);

/* Copies the indices of the same polygons into one index list, as sightcell_view_indices does.
 * stored_indices, dst, capacity, count: as for sightcell_view_indices. */
SIGHTCELL_API sightcell_status sightcell_view_caster_indices(const sightcell_view* view, sightcell_casters* casters,
                                                             uint32_t sun, const uint32_t* stored_indices,
                                                             uint32_t* dst, size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_CASTERS_H */
