/* lights.h: the polygons that the light of each lamp reaches, and the lights that touch what a camera sees.
 *
 * `sightcell bake --lights` finds, for each point and spot light of the scene, the polygons that its light reaches: the
 * polygons to draw into its shadow map. A light that does not touch the set of a cell needs neither a shadow map nor
 * shading while the camera is in that cell.
 *
 *   1. sightcell_lights_create       once per view
 *   2. sightcell_lights_list         once, to find the host's light of each number
 *   3. sightcell_view_lights         where the frame has SIGHTCELL_FRAME_CHANGED
 *   4. sightcell_view_light_ranges   once for each light that does not move: its shadow map can be kept
 *
 * The conventions of sightcell.h hold here too: statuses, lists, memory, threads, fail open.
 *
 * NOT COVERED. Directional lights: casters.h serves suns. Lights that move. Objects that the host moves (dynamic,
 * animated): light them, and draw their shadows, with the culling that you have.
 */
#ifndef SIGHTCELL_LIGHTS_H
#define SIGHTCELL_LIGHTS_H

#include "sightcell/sightcell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The lights of a file, with the memory that their output needs. Used by one thread at a time. */
typedef struct sightcell_lights sightcell_lights;

/* A point or spot light. */
typedef struct sightcell_light {
  uint32_t node;      /* number in the glTF file */
  float position[3];  /* world space, meters */
  float direction[3]; /* unit vector in which a spot light shines */
  float range;        /* meters; infinity: no limit */
  float cone;         /* of a spot light: angle between axis and edge, radians; 0: a point light */
  float error_bound;  /* of the probability that a ray from the light meets a polygon that its set lacks, 0 .. 1 */
} sightcell_light;

/* Opens the lights of a file.
 * db: must outlive the lights.
 * out: receives the lights, or NULL on failure.
 * Fails with ARGUMENT; with ABSENT if the file has no lights, or pages; with CHECKSUM or CORRUPT if they are damaged;
 *   with MEMORY; with PENDING before sightcell_db_opened has returned OK.
 * Cost: reads all lights once. One allocation of the allocator of db: 62 KB and at most 16 bytes per run of the largest
 *   set of a light. */
SIGHTCELL_API sightcell_status sightcell_lights_create(const sightcell_db* db, sightcell_lights** out);

/* Destroys lights and releases their memory. NULL is allowed. */
SIGHTCELL_API void sightcell_lights_destroy(sightcell_lights* lights);

/* Lists the lights of the file, in the order of the scene's nodes. Their numbers are used below.
 * dst, capacity, count: in lights, 1 or more. */
SIGHTCELL_API sightcell_status sightcell_lights_list(const sightcell_lights* lights, sightcell_light* dst,
                                                     size_t capacity, size_t* count);

/* Lists the numbers of the lights that touch what the cells of the last move see, ascending. A light touches a cell if
 * it reaches a polygon of the set of the cell. All lights under DRAW_ALL.
 * lights: of the db of the view.
 * dst, capacity, count: in lights.
 * Fails with ARGUMENT also if lights are of another db.
 * Cost: O(lights). Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_view_lights(const sightcell_view* view, const sightcell_lights* lights,
                                                     uint32_t* dst, size_t capacity, size_t* count);

/* Lists the polygons that a light reaches as ranges, in ascending order of draws, then of first. They do not depend on
 * where the view is. Everything where the set of the light is damaged. Hidden named groups of the view are left out.
 * lights: of the db of the view.
 * light: its number.
 * dst, capacity, count: in ranges.
 * Fails with ARGUMENT also if lights are of another db and if there is no such light.
 * Cost: O(runs of the set + draws, where there are named groups). Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_view_light_ranges(const sightcell_view* view, sightcell_lights* lights,
                                                           uint32_t light, sightcell_range* dst, size_t capacity,
                                                           size_t* count);

/* Copies the indices of the same polygons into one index list, as sightcell_view_indices does.
 * stored_indices, dst, capacity, count: as for sightcell_view_indices. */
SIGHTCELL_API sightcell_status sightcell_view_light_indices(const sightcell_view* view, sightcell_lights* lights,
                                                            uint32_t light, const uint32_t* stored_indices,
                                                            uint32_t* dst, size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_LIGHTS_H */
