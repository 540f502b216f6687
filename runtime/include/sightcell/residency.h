/* residency.h: the mip levels of textures that a camera can need, for hosts that load them when they need them.
 *
 * `sightcell bake --residency` finds, for each cell and texture, the finest mip level that any picture from a valid
 * viewpoint of the cell can need. A texture here is an image of the glTF file.
 *
 *   1. sightcell_residency_create        once per view
 *   2. sightcell_residency_textures      once, for the image of each number
 *   3. sightcell_view_texture_levels     where the frame has SIGHTCELL_FRAME_CHANGED
 *   4. sightcell_residency_cell_levels   for cells that the camera may enter next
 *
 * The conventions of sightcell.h hold here too: statuses, lists, memory, threads, fail open.
 *
 * LEVELS. Level 0 has all texels of the image; each other one has half of them on each axis. A host that keeps level n
 * of a texture keeps all coarser ones too. A host that made its textures smaller than the images by half on each axis
 * needs the level before.
 *
 * PIXELS PER RADIAN. How dense the pixels of the host's picture are: height / (2 tan(angle / 2)) for a picture of a
 * height in pixels and a vertical angle of view. That is the density at the center; at the angle a from it, pixels are
 * denser by 1 / cos(a)^2, and a host with a wide picture takes the density at its edges. A picture with twice as many
 * needs levels that are finer by one. A host that shifts levels by a bias multiplies them with 2^-bias.
 *
 * NOT COVERED. Textures of objects that the host moves (dynamic) and that are in no set; images that the file does not
 * list; textures that the host maps in another way than the glTF file.
 */
#ifndef SIGHTCELL_RESIDENCY_H
#define SIGHTCELL_RESIDENCY_H

#include "sightcell/sightcell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A level that no texture has: no picture needs the texture. */
#define SIGHTCELL_NO_LEVEL 255u

/* The texture residency of a file, with the memory that its output needs. Used by one thread at a time. */
typedef struct sightcell_residency sightcell_residency;

/* A texture. */
typedef struct sightcell_texture {
  uint32_t image; /* number in the glTF file */
  uint32_t width; /* texels of level 0 */
  uint32_t height;
} sightcell_texture;

/* Opens the texture residency of a file. Files that page have it too.
 * db: must outlive the residency.
 * out: receives the residency, or NULL on failure.
 * Fails with ARGUMENT; with ABSENT if the file has none; with CHECKSUM or CORRUPT if it is damaged; with MEMORY; with
 *   PENDING before sightcell_db_opened has returned OK.
 * Cost: reads all levels once. One allocation of the allocator of db: 5 KB and 2 bytes per texture. */
SIGHTCELL_API sightcell_status sightcell_residency_create(const sightcell_db* db, sightcell_residency** out);

/* Destroys a residency and releases its memory. NULL is allowed. */
SIGHTCELL_API void sightcell_residency_destroy(sightcell_residency* residency);

/* Lists the textures of the file, in ascending order of images.
 * dst, capacity, count: in textures. */
SIGHTCELL_API sightcell_status sightcell_residency_textures(const sightcell_residency* residency,
                                                            sightcell_texture* dst, size_t capacity, size_t* count);

/* Lists the finest level of each texture that a picture from the cells of the last move can need, or
 * SIGHTCELL_NO_LEVEL. Level 0 of all textures under DRAW_ALL, and where the levels of a cell are damaged.
 * residency: of the db of the view.
 * pixels_per_radian: of the picture; above 0, at most 1048576.
 * dst, capacity, count: in textures.
 * Fails with ARGUMENT also if residency is of another db.
 * Cost: O(textures + changes from cell to cell). Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_view_texture_levels(const sightcell_view* view, sightcell_residency* residency,
                                                             float pixels_per_radian, uint8_t* dst, size_t capacity,
                                                             size_t* count);

/* Lists the levels of one cell.
 * cell: its number.
 * Other parameters, failures and cost: as for sightcell_view_texture_levels. */
SIGHTCELL_API sightcell_status sightcell_residency_cell_levels(sightcell_residency* residency, uint32_t cell,
                                                               float pixels_per_radian, uint8_t* dst, size_t capacity,
                                                               size_t* count);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_RESIDENCY_H */
