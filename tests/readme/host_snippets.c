/* The snippets of docs/hosting.md, docs/levels.md and docs/streaming.md that draw, with a host around them that records
 * what it is asked to draw: every way must draw the same polygons. service_snippets.c has the others.
 * usage: readme_host_snippets FILE.pvs ... */
#include <sightcell/clusters.h>
#include <sightcell/sightcell.h>
#include <sightcell/viewpoints.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- The host: what GL and Vulkan would be given. ----------------------------------------------------------------- */
typedef int GLsizei;
typedef struct {
  uint32_t index_count, instance_count, first_index;
  int32_t vertex_offset;
  uint32_t first_instance;
} VkDrawIndexedIndirectCommand;
enum { GL_TRIANGLES = 4, GL_UNSIGNED_INT = 0x1405 };

static sightcell_db* db;
static sightcell_view* view;
static sightcell_frame frame;
static sightcell_draw* draws;
static sightcell_range* ranges;
static uint32_t polygon_total, bound_draw;
static unsigned char* drawn; /* of each stored polygon: how often */
static uint32_t *source_id_of_stored, *source_indices, *stored_indices, *mapped;
static size_t draw_total, range_bound, mapped_count;

static void require(int good, const char* what) {
  if (good) return;
  fprintf(stderr, "%s\n", what);
  exit(1);
}
/* The polygon that three indices of the host's buffers stand for: they are 3 s, 3 s + 1, 3 s + 2 of stored polygon s. */
static void draw_polygon(const uint32_t* corners) {
  require(corners[0] % 3 == 0 && corners[1] == corners[0] + 1 && corners[2] == corners[0] + 2, "torn polygon");
  ++drawn[corners[0] / 3];
}
static void bind_draw(uint32_t draw) { bound_draw = draw; }
static void glMultiDrawElements(int mode, const GLsizei* counts, int type, const void* const* offsets, GLsizei n) {
  require(mode == GL_TRIANGLES && type == GL_UNSIGNED_INT, "mode");
  const uint32_t* buffer = stored_indices + 3 * (size_t)draws[bound_draw].first_stored;
  for (GLsizei i = 0; i < n; ++i)
    for (GLsizei at = 0; at < counts[i]; at += 3) draw_polygon(buffer + (size_t)offsets[i] / sizeof(uint32_t) + at);
}
static uint32_t* map_index_buffer(size_t indices) {
  mapped_count = indices;
  return mapped;
}
static void unmap_index_buffer(void) {}
static void draw_elements(size_t indices) {
  require(indices == mapped_count, "indices");
  for (size_t at = 0; at < indices; at += 3) draw_polygon(mapped + at);
}
static void vkCmdDrawIndexedIndirect(int cmd, const VkDrawIndexedIndirectCommand* buffer, uint64_t offset, uint32_t n,
                                     uint32_t stride) {
  require(cmd == 1 && offset == 0 && stride == sizeof *buffer, "command buffer");
  for (uint32_t i = 0; i < n; ++i) {
    require(buffer[i].instance_count == 1, "instances");
    const uint32_t* own = stored_indices + 3 * (size_t)draws[buffer[i].first_instance].first_stored;
    for (uint32_t at = 0; at < buffer[i].index_count; at += 3) draw_polygon(own + buffer[i].first_index + at);
  }
}
static void draw_object(uint32_t draw) {
  for (uint32_t i = 0; i < draws[draw].polygon_count; ++i) ++drawn[draws[draw].first_stored + i];
}

/* Clusters of five triangles, numbered by the source ids of their draws. */
static sightcell_cluster_map* map;
static uint32_t *uploaded_row, *gpu_row;
static uint32_t first_cluster_of(const sightcell_draw* d) {
  uint32_t first = 0;
  for (size_t i = 0; i < draw_total; ++i)
    if (draws[i].first_source < d->first_source) first += (draws[i].polygon_count + 4) / 5;
  return first;
}
static uint32_t cluster_of_triangle(const sightcell_draw* d, uint32_t triangle) {
  require(triangle < d->polygon_count, "triangle");
  return triangle / 5;
}
static void upload_word(uint32_t index, uint32_t bits) { gpu_row[index] = bits; }

/* --- What the documents show. --------------------------------------------------------------------------------------- */

/* [draws in source order */
static int by_first_source(const void* a, const void* b) {
  const sightcell_draw* x = &draws[*(const uint32_t*)a];
  const sightcell_draw* y = &draws[*(const uint32_t*)b];
  if (x->first_source != y->first_source) return x->first_source < y->first_source ? -1 : 1;
  return (x->polygon_count > y->polygon_count) - (x->polygon_count < y->polygon_count); /* empty draws first */
}

static void find_objects(uint32_t* sorted, uint32_t* object_of_draw) {
  for (uint32_t i = 0; i < draw_total; ++i) sorted[i] = i;
  qsort(sorted, draw_total, sizeof *sorted, by_first_source);
  for (uint32_t i = 0; i < draw_total; ++i) object_of_draw[sorted[i]] = i; /* draw sorted[i] is the host's object i */
}
/* draws in source order] */

static void permute_primitive(const sightcell_draw* d, const uint32_t* indices, uint32_t* permuted) {
  /* [permute a primitive */
  for (uint32_t i = 0; i < d->polygon_count; ++i) {
    const uint32_t triangle = source_id_of_stored[d->first_stored + i] - d->first_source;
    memcpy(permuted + 3 * (size_t)i, indices + 3 * (size_t)triangle, 3 * sizeof(uint32_t));
  }
  /* permute a primitive] */
}

static void permute_all(void) {
  /* [permute all */
  for (size_t s = 0; s < polygon_total; ++s) {
    memcpy(stored_indices + 3 * s, source_indices + 3 * (size_t)source_id_of_stored[s], 3 * sizeof(uint32_t));
  }
  /* permute all] */
}

static void make_cluster_map(uint32_t* cluster_of_source, uint32_t cluster_count) {
  /* [cluster map */
  for (const sightcell_draw* d = draws; d != draws + draw_total; ++d)
    for (uint32_t t = 0; t < d->polygon_count; ++t)
      cluster_of_source[d->first_source + t] = first_cluster_of(d) + cluster_of_triangle(d, t);
  if (sightcell_cluster_map_create(db, cluster_of_source, polygon_total, cluster_count, &map) != SIGHTCELL_OK) exit(1);
  /* cluster map] */
}

static void update_clusters(uint32_t* row, size_t words, sightcell_cluster_word* changed) {
  size_t count;
  /* [clusters */
  if (frame.flags & SIGHTCELL_FRAME_CHANGED) {
    sightcell_view_clusters(view, map, row, words);                              /* a bit for each cluster */
    sightcell_cluster_changes(uploaded_row, row, words, changed, words, &count); /* or upload all of the row */
    for (size_t i = 0; i < count; ++i) upload_word(changed[i].index, changed[i].bits);
    memcpy(uploaded_row, row, words * sizeof *row);
  }
  /* clusters] */
}

/* A host without clusters of its own: those of the file, as parts of the permuted index buffers. */
static void add_meshlet(uint32_t draw, uint32_t first, uint32_t count) {
  require(draw < draw_total && count > 0 && first + count <= draws[draw].polygon_count, "meshlet");
}

/* A host that draws a file of pack --meshlets: its index buffers stay as they are. */
static uint32_t meshlet_polygons;
static void add_meshlet_of(const sightcell_draw* d, uint32_t first_index, uint32_t count) {
  require(first_index / 3 < d->polygon_count && count > 0, "meshlet of the packed file");
  meshlet_polygons += count / 3;
}

static void use_clusters_of_the_file(void) {
  sightcell_cluster_map* own_map;
  size_t count;
  if (sightcell_db_cluster_count(db) == 0) return;
  /* [file clusters */
  sightcell_range* clusters = malloc(sightcell_db_cluster_count(db) * sizeof *clusters);
  sightcell_db_clusters(db, clusters, sightcell_db_cluster_count(db), &count);
  for (size_t c = 0; c < count; ++c) add_meshlet(clusters[c].draw, clusters[c].first, clusters[c].count);
  if (sightcell_cluster_map_of_file(db, &own_map) != SIGHTCELL_OK) exit(1); /* bit c of a row is cluster c */
  /* file clusters] */
  meshlet_polygons = 0;
  /* [packed clusters */
  for (size_t c = 0; c < count; ++c) { /* meshlet c, in the order of the file */
    const sightcell_draw* d = &draws[clusters[c].draw];
    const uint32_t triangle = source_id_of_stored[d->first_stored + clusters[c].first] - d->first_source;
    add_meshlet_of(d, 3 * triangle, 3 * clusters[c].count); /* in the index buffer of its primitive */
  }
  /* packed clusters] */
  require(meshlet_polygons == polygon_total, "all polygons are in meshlets");
  sightcell_cluster_map_destroy(own_map);
  free(clusters);
}

static float camera[3];
static int cameras_put;
static void put_camera(const float at[3]) {
  memcpy(camera, at, sizeof camera);
  ++cameras_put;
}

static void start_in(uint32_t cell) {
  /* [start in a cell */
  float start[3];
  if (sightcell_db_cell_eye(db, cell, 0, start) == SIGHTCELL_OK) put_camera(start);
  /* start in a cell] */
}

static void multi_draw(sightcell_range* ranges, GLsizei* counts, const void** offsets) {
  size_t count;
  /* [multi-draw */
  sightcell_view_ranges(view, ranges, range_bound, &count);
  for (size_t i = 0; i < count;) {
    const uint32_t draw = ranges[i].draw;
    GLsizei n = 0;
    for (; i < count && ranges[i].draw == draw; ++i, ++n) {
      counts[n] = (GLsizei)(3 * ranges[i].count);
      offsets[n] = (const void*)(3 * sizeof(uint32_t) * ranges[i].first);
    }
    bind_draw(draw);  /* its vertex array with the permuted index buffer, its transform, its material */
    glMultiDrawElements(GL_TRIANGLES, counts, GL_UNSIGNED_INT, offsets, n);
  }
  /* multi-draw] */
}

static void index_buffer(void) {
  /* [index buffer */
  size_t needed = 3 * (size_t)frame.polygon_count;
  if (frame.flags & SIGHTCELL_FRAME_CHANGED) {
    uint32_t* dst = map_index_buffer(needed);  /* written from front to back, never read */
    sightcell_view_indices(view, stored_indices, dst, needed, &needed);
    unmap_index_buffer();
  }
  draw_elements(needed);
  /* index buffer] */
}

static const uint32_t* permuted_indices_of(uint32_t draw) { return stored_indices + 3 * (size_t)draws[draw].first_stored; }

static void shared_index_buffers(void) {
  size_t count;
  /* [shared index buffers */
  size_t needed = 0;
  uint32_t* dst = map_index_buffer(3 * (size_t)frame.polygon_count);
  sightcell_view_ranges(view, ranges, range_bound, &count);
  for (size_t i = 0; i < count; needed += 3 * (size_t)ranges[i++].count) {
    const uint32_t* permuted = permuted_indices_of(ranges[i].draw);  /* of its primitive, shared by all instances */
    memcpy(dst + needed, permuted + 3 * (size_t)ranges[i].first, 3 * sizeof *dst * ranges[i].count);
  }
  unmap_index_buffer();
  /* shared index buffers] */
  draw_elements(needed);
}

static void vulkan_indirect(int cmd, VkDrawIndexedIndirectCommand* buffer) {
  size_t count;
  /* [indirect */
  sightcell_view_commands(view, 0, buffer, sizeof(VkDrawIndexedIndirectCommand), range_bound, &count);
  vkCmdDrawIndexedIndirect(cmd, buffer, 0, (uint32_t)count, sizeof(VkDrawIndexedIndirectCommand));
  /* indirect] */
}

static void objects(uint64_t* bits, size_t words) {
  /* [objects */
  sightcell_view_objects(view, bits, words);
  for (uint32_t draw = 0; draw < draw_total; ++draw) {
    if (bits[draw / 64] >> (draw % 64) & 1) draw_object(draw);
  }
  /* objects] */
}

/* Objects with levels of detail: each draw is one, and has a coarser level that takes its whole place. */
typedef struct {
  uint32_t draws[1], draw_count; /* of level 0, in the draw table */
  float center[3], begins[1];    /* where each coarser level begins: meters from the center */
  uint32_t level_count;          /* coarser ones */
} leveled_object;
static leveled_object* leveled;
static size_t leveled_count;
static int drawn_at_level[2];
static float distance_to(const float center[3]) {
  float squares = 0.0f;
  for (int k = 0; k < 3; ++k) squares += (center[k] - camera[k]) * (center[k] - camera[k]);
  return sqrtf(squares);
}
static void draw_level(const leveled_object* object, uint32_t level) {
  require(level == (distance_to(object->center) >= object->begins[0]), "level");
  ++drawn_at_level[level];
  draw_object(object->draws[0]);
}

static void objects_with_levels(uint64_t* bits, size_t words) {
  /* [levels */
  sightcell_view_objects(view, bits, words);
  for (const leveled_object* o = leveled; o != leveled + leveled_count; ++o) {
    uint32_t visible = 0, level = 0;
    for (uint32_t i = 0; i < o->draw_count; ++i) visible |= bits[o->draws[i] / 64] >> (o->draws[i] % 64) & 1;
    while (level < o->level_count && distance_to(o->center) >= o->begins[level]) ++level;
    if (visible) draw_level(o, level); /* 0: the draws themselves */
  }
  /* levels] */
}

/* Every other object is far enough away for its coarser level. */
static void make_levels(void) {
  leveled_count = draw_total;
  leveled = calloc(draw_total + 1, sizeof *leveled);
  for (uint32_t i = 0; i < draw_total; ++i)
    leveled[i] = (leveled_object){{i}, 1, {camera[0] + 10.0f, camera[1], camera[2]}, {i % 2 ? 5.0f : 15.0f}, 1};
}

static unsigned char* requested; /* of each draw: was its mesh requested? */
static void request_mesh(size_t draw, float priority) {
  require(priority > 0.0f, "priority");
  requested[draw] = 1;
}

/* Requests the draws that have a polygon to draw and no others, where the file has importance. */
static int load_by_importance(const unsigned char* to_draw) {
  size_t count;
  float* steradians = malloc((draw_total + 1) * sizeof *steradians);
  requested = calloc(draw_total + 1, 1);
  /* [importance */
  if (sightcell_view_importance(view, steradians, draw_total, &count) == SIGHTCELL_OK)
    for (size_t draw = 0; draw < count; ++draw)
      if (steradians[draw] > 0.0f) request_mesh(draw, steradians[draw]);
  /* importance] */
  int requests = 0;
  for (size_t d = 0; d < draw_total; ++d) {
    requests += requested[d];
    if (requested[d]) require(to_draw[draws[d].first_stored], "a request of what is not to be drawn");
  }
  for (size_t d = 0; d < draw_total && requests > 0; ++d)
    require(draws[d].polygon_count == 0 || requested[d] == to_draw[draws[d].first_stored], "a draw without a request");
  free(requested);
  free(steradians);
  return requests;
}

/* --- A cell, drawn in every way. ------------------------------------------------------------------------------------ */

static void expect_drawn(const unsigned char* expected, const char* what) {
  require(memcmp(drawn, expected, polygon_total) == 0, what);
  memset(drawn, 0, polygon_total);
}

static unsigned char *expected, *of_objects; /* of each stored polygon: is it to be drawn? */

static void open_file(const char* path) {
  require(sightcell_db_open_file(path, NULL, &db) == SIGHTCELL_OK, "open");
  require(sightcell_view_create(db, &view) == SIGHTCELL_OK, "view");
  sightcell_info info = {.struct_size = sizeof info};
  require(sightcell_db_info(db, &info) == SIGHTCELL_OK && info.layout == 0, "info");
  polygon_total = info.polygon_count;
  range_bound = info.range_bound;
  draws = malloc((info.draw_count + 1) * sizeof *draws);
  sightcell_db_draws(db, draws, info.draw_count, &draw_total);
  drawn = calloc(polygon_total, 1);
  expected = calloc(polygon_total, 1);
  of_objects = calloc(polygon_total, 1);
  ranges = malloc((range_bound + 1) * sizeof *ranges);
  source_indices = malloc(3 * sizeof(uint32_t) * polygon_total);
  stored_indices = malloc(3 * sizeof(uint32_t) * polygon_total);
  mapped = malloc(3 * sizeof(uint32_t) * polygon_total);
  source_id_of_stored = malloc(polygon_total * sizeof *source_id_of_stored);
  size_t n;
  sightcell_db_order(db, source_id_of_stored, polygon_total, &n);
  for (uint32_t s = 0; s < polygon_total; ++s)
    for (uint32_t k = 0; k < 3; ++k) source_indices[3 * (size_t)source_id_of_stored[s] + k] = 3 * s + k;
  permute_all();
}

/* Source ids ascend from object to object of the host without a gap. */
static void expect_objects_in_source_order(void) {
  uint32_t* sorted = malloc((draw_total + 1) * sizeof *sorted);
  uint32_t* object_of_draw = malloc((draw_total + 1) * sizeof *object_of_draw);
  find_objects(sorted, object_of_draw);
  uint32_t next = 0;
  for (uint32_t object = 0; object < draw_total; ++object) {
    const sightcell_draw* d = &draws[sorted[object]];
    require(object_of_draw[sorted[object]] == object && d->first_source == next, "objects in source order");
    next += d->polygon_count;
  }
  require(next == polygon_total, "all objects");
  free(sorted);
  free(object_of_draw);
}

/* Each draw by itself gives what permute_all gives for all of them. */
static void expect_permuted_primitives(void) {
  uint32_t* permuted = malloc(3 * sizeof(uint32_t) * polygon_total);
  for (size_t d = 0; d < draw_total; ++d) {
    permute_primitive(&draws[d], source_indices + 3 * (size_t)draws[d].first_source, permuted);
    require(memcmp(permuted, stored_indices + 3 * (size_t)draws[d].first_stored,
                   3 * sizeof(uint32_t) * draws[d].polygon_count) == 0, "permuted primitive");
  }
  free(permuted);
}

static uint32_t *cluster_of_source, *row;
static size_t row_words;
static sightcell_cluster_word* changed_words;

static void prepare_clusters(void) {
  uint32_t clusters = 0;
  for (size_t i = 0; i < draw_total; ++i) clusters += (draws[i].polygon_count + 4) / 5;
  row_words = (clusters + 31) / 32;
  cluster_of_source = malloc(polygon_total * sizeof *cluster_of_source);
  row = calloc(row_words, sizeof *row);
  uploaded_row = calloc(row_words, sizeof *uploaded_row);
  gpu_row = calloc(row_words, sizeof *gpu_row);
  changed_words = malloc(row_words * sizeof *changed_words);
  make_cluster_map(cluster_of_source, clusters);
}

static void release_clusters(void) {
  sightcell_cluster_map_destroy(map);
  free(cluster_of_source);
  free(row);
  free(uploaded_row);
  free(gpu_row);
  free(changed_words);
}

/* The GPU has the clusters with a polygon to draw, and no others. */
static void expect_clusters(const unsigned char* to_draw) {
  uint32_t* wanted = calloc(row_words, sizeof *wanted);
  for (uint32_t s = 0; s < polygon_total; ++s) {
    const uint32_t cluster = cluster_of_source[source_id_of_stored[s]];
    if (to_draw[s]) wanted[cluster / 32] |= 1u << (cluster % 32);
  }
  update_clusters(row, row_words, changed_words);
  require(memcmp(gpu_row, wanted, row_words * sizeof *wanted) == 0, "clusters");
  free(wanted);
}

static void close_file(void) {
  release_clusters();
  sightcell_view_destroy(view);
  sightcell_db_close(db);
  free(draws);
  free(drawn);
  free(expected);
  free(of_objects);
  free(ranges);
  free(source_id_of_stored);
  free(source_indices);
  free(stored_indices);
  free(mapped);
}

/* What the view shows. */
static void expect_ranges(void) {
  size_t n;
  sightcell_view_ranges(view, ranges, range_bound, &n);
  memset(expected, 0, polygon_total);
  memset(of_objects, 0, polygon_total);
  for (size_t i = 0; i < n; ++i) {
    const sightcell_draw* d = &draws[ranges[i].draw];
    memset(expected + d->first_stored + ranges[i].first, 1, ranges[i].count);
    memset(of_objects + d->first_stored, 1, d->polygon_count);
  }
  expect_clusters(expected);
}

static void draw_in_every_way(void) {
  GLsizei* counts = malloc((range_bound + 1) * sizeof *counts);
  const void** offsets = malloc((range_bound + 1) * sizeof *offsets);
  VkDrawIndexedIndirectCommand* commands = malloc((range_bound + 1) * sizeof *commands);
  const size_t words = (draw_total + 63) / 64;
  uint64_t* bits = malloc((words + 1) * sizeof *bits);
  multi_draw(ranges, counts, offsets);
  expect_drawn(expected, "multi-draw");
  frame.flags |= SIGHTCELL_FRAME_CHANGED;
  index_buffer();
  expect_drawn(expected, "index buffer");
  shared_index_buffers();
  expect_drawn(expected, "shared index buffers");
  vulkan_indirect(1, commands);
  expect_drawn(expected, "indirect");
  objects(bits, words);
  expect_drawn(of_objects, "objects");
  make_levels();
  objects_with_levels(bits, words);
  expect_drawn(of_objects, "objects with levels");
  free(leveled);
  free(counts);
  free((void*)offsets);
  free(commands);
  free(bits);
}

int main(int argc, char** argv) {
  require(argc > 1, "usage: readme_host_snippets FILE.pvs ...");
  int requests = 0;
  for (int file = 1; file < argc; ++file) {
    open_file(argv[file]);
    expect_objects_in_source_order();
    expect_permuted_primitives();
    prepare_clusters();
    use_clusters_of_the_file();
    for (uint32_t cell = 0; cell < sightcell_db_cell_count(db); ++cell) {
      float min[3], max[3];
      sightcell_db_cell_box(db, cell, min, max);
      for (int k = 0; k < 3; ++k) camera[k] = (min[k] + max[k]) / 2;
      start_in(cell);
      const float* eye = camera;
      const float away[3] = {1e6f, 1e6f, 1e6f}; /* else the view may keep the cell before in its grown box */
      sightcell_view_move(view, away, &frame);
      require(sightcell_view_move(view, eye, &frame) == SIGHTCELL_OK && frame.cell == cell, "move");
      expect_ranges();
      draw_in_every_way();
      requests += load_by_importance(of_objects);
    }
    close_file();
  }
  require(requests > 0, "no file has importance");
  require(cameras_put > 0, "no file has eyes");
  require(drawn_at_level[0] > 0 && drawn_at_level[1] > 0, "both levels are drawn");
  return 0;
}
