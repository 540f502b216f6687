/* identity.h: finds the objects of a host in a file by what they are, and finds out that a file is of another scene.
 *
 * The draw table is not in source order, importers drop glTF node numbers, and a file of another scene opens without an
 * error. A host that maps draws by their numbers then draws the wrong objects, and no call fails. Files that were baked
 * with --names have a hash of the geometry of each draw, and the names of nodes and meshes. The host computes the same
 * hash of each of its draws, and sightcell_db_match maps them or returns SIGHTCELL_ERR_OTHER_SCENE.
 *
 *   1. sightcell_geometry_hash   for each draw of the host; instances of a mesh have the same
 *   2. sightcell_db_match        once per file
 *   3. sightcell_db_draw_name    for a message, where it has failed
 *
 * The conventions of sightcell.h hold here too.
 *
 * GEOMETRY HASH. The hash is about the positions of the corners of all triangles, bit for bit, in the space of the
 * mesh. It does not depend on the order of triangles, on the order and number of vertices, on winding, and on triangles
 * with two equal corners, which importers drop. The hashes of the parts of a split mesh add up to that of the whole,
 * modulo 2^64. It differs where an importer moves vertices, and for draws that a skin or morph targets bend, of which
 * the file has the pose of the bake. format/SPEC.md defines it, for hosts that compute it elsewhere. 0 is the hash of a
 * draw without triangles.
 */
#ifndef SIGHTCELL_IDENTITY_H
#define SIGHTCELL_IDENTITY_H

#include "sightcell/sightcell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* In a map of draws: the file has no draw for this one. */
#define SIGHTCELL_NO_DRAW 0xFFFFFFFFu

/* Which name of a draw. */
enum {
  SIGHTCELL_NAME_NODE = 0, /* of its glTF node */
  SIGHTCELL_NAME_MESH = 1  /* of its glTF mesh */
};

/* How the draws of a host and of a file match. */
typedef struct sightcell_draw_match {
  uint32_t struct_size;   /* set by the caller to sizeof(sightcell_draw_match) */
  uint32_t matched;       /* draws of the host that have a draw of the file */
  uint32_t by_order;      /* of these, those that others are equal to: found by order */
  uint32_t missing;       /* draws of the file that the host does not have */
  uint32_t extra;         /* draws of the host that the file does not have */
  uint32_t first_missing; /* the first of them in source order, a number of the draw table; SIGHTCELL_NO_DRAW if none */
  uint32_t first_extra;   /* the first of them, an index of the host; SIGHTCELL_NO_DRAW if none */
} sightcell_draw_match;

/* Computes the geometry hash of triangles.
 * positions: x, y and z of each vertex as floats, in the space of the mesh, with any alignment.
 * stride: bytes from vertex to vertex, 12 or more.
 * indices: three per triangle.
 * hash: receives the hash.
 * Fails with ARGUMENT also if index_count is not a multiple of 3, and if an index is not below vertex_count.
 * Cost: O(index_count). */
SIGHTCELL_API sightcell_status sightcell_geometry_hash(const void* positions, size_t stride, size_t vertex_count,
                                                       const uint32_t* indices, size_t index_count, uint64_t* hash);

/* Finds the draw of the file for each draw of the host: one with the same hash, and if there are several, first one
 * with the same name of its node, then the next one in source order. Each draw of the file is found once.
 * hashes: of the draws of the host, in the order of the scene as far as the host has it (source order). Draws with the
 *   hash 0, of the host and of the file, are matched with nothing and count as neither missing nor extra.
 * names: of the glTF nodes of these draws, UTF-8 with a zero at the end; elements may be NULL. NULL: no names.
 * count: elements of hashes, of names, and of draw_of_host.
 * draw_of_host: receives the number in the draw table of the file for each draw of the host, or SIGHTCELL_NO_DRAW.
 * match: receives the counts. The caller sets match->struct_size, as for sightcell_view_statistics.
 * Fails with OTHER_SCENE if a draw is missing or extra; draw_of_host and match are complete then too, so that a host
 *   can name what differs, or use what matched. Fails with ABSENT if the file has no draw identity: bake with --names,
 *   or add it with `sightcell recode --names`. Fails with CHECKSUM or CORRUPT if this part of the file is damaged,
 *   which open does not check; with MEMORY; with PENDING before sightcell_db_opened has returned OK.
 * Cost: O(n log n). One allocation of the allocator of db, released before the call returns. */
SIGHTCELL_API sightcell_status sightcell_db_match(const sightcell_db* db, const uint64_t* hashes,
                                                  const char* const* names, size_t count, uint32_t* draw_of_host,
                                                  sightcell_draw_match* match);

/* Returns the geometry hash of a draw.
 * draw: number in the draw table.
 * hash: receives the hash; 0 for a draw without polygons.
 * Fails with ABSENT, CHECKSUM, CORRUPT and PENDING as sightcell_db_match.
 * Cost: O(draws), because it checks that part of the file. */
SIGHTCELL_API sightcell_status sightcell_db_draw_hash(const sightcell_db* db, uint32_t draw, uint64_t* hash);

/* Returns a name of a draw.
 * draw: number in the draw table.
 * kind: SIGHTCELL_NAME_NODE or SIGHTCELL_NAME_MESH.
 * dst, capacity, count: in bytes of UTF-8, without a zero at the end; at most 255, since longer names are stored
 *   without their end. 0 bytes if the glTF file has no name there.
 * Fails with ABSENT, CHECKSUM, CORRUPT and PENDING as sightcell_db_match.
 * Cost: O(draws + names). For messages. */
SIGHTCELL_API sightcell_status sightcell_db_draw_name(const sightcell_db* db, uint32_t draw, uint32_t kind, char* dst,
                                                      size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_IDENTITY_H */
