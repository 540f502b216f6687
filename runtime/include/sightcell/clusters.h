/* clusters.h: the visible clusters (meshlets) of a host, as one bit each.
 *
 * A renderer that culls clusters of 64 to 128 triangles keeps its own triangle order and its own clusters. It gives the
 * runtime one table, once per file: the cluster of each polygon. From then on, sightcell_view_clusters writes a bit for
 * each cluster, 1 if any of its polygons is in the set. The row of bits is an array of 32-bit words that can be
 * uploaded to the GPU as it is. No index buffer is permuted, and no new bake is needed.
 *
 *   1. sightcell_cluster_map_create   once per file
 *   2. sightcell_view_clusters        where the frame has SIGHTCELL_FRAME_CHANGED
 *   3. sightcell_cluster_changes      for hosts that upload only the words that changed
 *
 * The conventions of sightcell.h hold here too: statuses, lists, memory, threads, fail open.
 *
 * CLUSTERS. Clusters are numbered by the host, 0 .. cluster_count - 1. Polygons of one cluster need not follow each
 * other. Each instance of a mesh has clusters of its own, because one instance may be visible and another not: a host
 * whose mesh has m clusters gives its n instances n * m numbers. Consecutive numbers for neighboring clusters make maps
 * small and fast.
 *
 * FILES OF CLUSTERS. `sightcell bake --granularity cluster` and `sightcell recode` make files whose sets are of
 * clusters of up to 128 triangles: those of the host, where the scene has them, or others. Such files are a fraction of
 * the size. Their clusters are numbered 0 .. sightcell_db_cluster_count - 1, draw by draw. sightcell_db_clusters lists
 * them as ranges of the stored polygon order, so a host can make its meshlets of them; sightcell_cluster_map_of_file
 * makes a map whose bits are these clusters. A host with clusters of its own uses sightcell_cluster_map_create here
 * too, which needs 4 bytes per cluster where each cluster of the file is in one of the host. All other outputs work
 * with such files, and return whole clusters.
 *
 * ERROR BOUND. A cluster is visible if any of its polygons is in the set, so the host draws a superset of the set, and
 * the error bound of the file holds.
 */
#ifndef SIGHTCELL_CLUSTERS_H
#define SIGHTCELL_CLUSTERS_H

#include "sightcell/sightcell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* In a table of clusters: the polygon is in no cluster, because the host does not draw it. */
#define SIGHTCELL_NO_CLUSTER 0xFFFFFFFFu

/* The clusters of a host, arranged for the polygon order of one file. Never changes; shared by threads. */
typedef struct sightcell_cluster_map sightcell_cluster_map;

/* A word of a row that changed. */
typedef struct sightcell_cluster_word {
  uint32_t index; /* of the word in the row */
  uint32_t bits;  /* its new value */
} sightcell_cluster_word;

/* Makes a map.
 * db: must outlive the map.
 * cluster_of_source: element i is the cluster of the polygon with source id i, or SIGHTCELL_NO_CLUSTER. Read during the
 *   call only.
 * polygon_count: elements of cluster_of_source; must be sightcell_db_polygon_count.
 * cluster_count: number of clusters. A cluster may have no polygon in the table.
 * out: receives the map, or NULL on failure.
 * Fails with ARGUMENT also if polygon_count differs and if a cluster is not below cluster_count; with MEMORY; with
 *   PENDING before sightcell_db_opened has returned OK.
 * Cost: O(polygons). One allocation of the allocator of db: 2 bytes per polygon, and 8 bytes for each word of the row
 *   that 16 consecutive polygons of the file have clusters in: about 3 to 4 bytes per polygon in all for clusters of
 *   neighboring triangles. */
SIGHTCELL_API sightcell_status sightcell_cluster_map_create(const sightcell_db* db, const uint32_t* cluster_of_source,
                                                            size_t polygon_count, uint32_t cluster_count,
                                                            sightcell_cluster_map** out);

/* Returns the number of clusters of a file of clusters; 0 for other files, for NULL, and before sightcell_db_opened has
 * returned OK. Cost: O(1). */
SIGHTCELL_API uint32_t sightcell_db_cluster_count(const sightcell_db* db);

/* Lists the clusters of a file of clusters in the order of their numbers: the draw (draw group of a merged file) of
 * each, its first polygon in the stored order of the draw, and its number of polygons, 1 to 256.
 * dst, capacity, count: in clusters; the list has sightcell_db_cluster_count.
 * Fails with PENDING too.
 * Cost: O(clusters). */
SIGHTCELL_API sightcell_status sightcell_db_clusters(const sightcell_db* db, sightcell_range* dst, size_t capacity,
                                                     size_t* count);

/* Makes a map of the clusters of a file of clusters: bit c of a row is cluster c of the file.
 * db: must outlive the map.
 * out: receives the map, or NULL on failure.
 * Fails with ABSENT if the sets of the file are of polygons; with MEMORY; with PENDING before sightcell_db_opened has
 *   returned OK.
 * Cost: O(clusters + polygons / 64). One allocation of the allocator of db: 4 bytes per cluster and for each 64
 *   polygons. */
SIGHTCELL_API sightcell_status sightcell_cluster_map_of_file(const sightcell_db* db, sightcell_cluster_map** out);

/* Destroys a map and releases its memory. NULL is allowed. */
SIGHTCELL_API void sightcell_cluster_map_destroy(sightcell_cluster_map* map);

/* Writes a bit for each cluster: 1 if it has a polygon to draw. Like the outputs of sightcell.h, this returns the
 * result of the last move, and everything under DRAW_ALL. The bit of a cluster without a polygon in the table is 0.
 * map: of the db of the view.
 * bits: the row. Cluster c is bit c % 32 of word c / 32. Bits after the last cluster are 0.
 * words: elements of bits, (cluster_count + 31) / 32 or more, all of which are written.
 * Fails with ARGUMENT also if map is of another db; with CAPACITY if there are fewer words.
 * Cost: O(ranges + clusters / 32 + polygons in the set / 16). Takes 17 KB of the stack. */
SIGHTCELL_API sightcell_status sightcell_view_clusters(const sightcell_view* view, const sightcell_cluster_map* map,
                                                       uint32_t* bits, size_t words);

/* Lists the clusters whose bits are 1, in ascending order.
 * bits, words: a row of sightcell_view_clusters, or a row that the host has changed, such as one without the clusters
 *   outside the frustum.
 * dst, capacity, count: in clusters.
 * Cost: O(words + clusters in the list). */
SIGHTCELL_API sightcell_status sightcell_cluster_list(const uint32_t* bits, size_t words, uint32_t* dst,
                                                      size_t capacity, size_t* count);

/* Lists the words in which two rows differ, in ascending order, for hosts that update a row on the GPU in place. The
 * host keeps two rows and fills them in turn. This also works across DRAW_ALL, and for rows that are several changes
 * apart.
 * before: the row that the GPU has.
 * now: the row that it is to have.
 * words: of each row.
 * dst, capacity, count: in words.
 * Cost: O(words). */
SIGHTCELL_API sightcell_status sightcell_cluster_changes(const uint32_t* before, const uint32_t* now, size_t words,
                                                         sightcell_cluster_word* dst, size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_CLUSTERS_H */
