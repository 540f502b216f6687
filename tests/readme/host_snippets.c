/* What runtime/README.md shows beyond the ten lines, with a host around it that writes down what it is asked to draw:
 * every way must draw the same polygons. usage: readme_host_snippets FILE.pvs FILE_WITH_A_DOOR.pvs */
#include <sightcell/sightcell.h>
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
static uint32_t polygon_total, bound_draw;
static unsigned char* drawn; /* of each stored polygon: how often */
static uint32_t *source_indices, *stored_indices, *mapped;
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

/* --- What the README shows. ---------------------------------------------------------------------------------------- */

static void permute_index_buffers(uint32_t* source_id_of_stored) {
  /* [order */
  size_t n = polygon_total;
  sightcell_db_order(db, source_id_of_stored, n, &n);
  for (size_t s = 0; s < n; ++s) {  /* three indices of each polygon, as the source has them and as the file stores them */
    memcpy(stored_indices + 3 * s, source_indices + 3 * (size_t)source_id_of_stored[s], 3 * sizeof(uint32_t));
  }
  /* order] */
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

typedef struct {
  float eye[3], min[3], max[3];
  sightcell_view* view;
} player;
static size_t sent;
static void send_position(const player* to, const player* of) { sent += to != of; }

static void server(player* players, size_t player_count) {
  /* [server */
  for (player* p = players; p != players + player_count; ++p) {
    sightcell_frame unused;
    sightcell_view_move(p->view, p->eye, &unused);
    for (const player* other = players; other != players + player_count; ++other) {
      uint32_t visible;
      sightcell_view_box_visible(p->view, other->min, other->max, &visible);
      if (visible) send_position(p, other);
    }
  }
  /* server] */
}

static void use_door(uint32_t is_open) {
  /* [door */
  uint32_t door;
  sightcell_db_find_named_group(db, "door", &door);  /* in the scene: "extras": {"sightcell": {"group": "door"}} */
  if (door != SIGHTCELL_NO_NAMED_GROUP) sightcell_view_show_named_group(view, door, !is_open);
  /* door] */
}

/* Of a scene with a named group: the first cell that sees the door has it when it is shut, and not when it is open. */
static void doors(const char* path) {
  require(sightcell_db_open_file(path, NULL, &db) == SIGHTCELL_OK, "open");
  require(sightcell_view_create(db, &view) == SIGHTCELL_OK, "view");
  uint32_t polygons[2];
  for (uint32_t cell = 0, hidden = 0; !hidden; ++cell) {
    float min[3], max[3];
    require(sightcell_db_cell_box(db, cell, min, max) == SIGHTCELL_OK, "no cell sees the door");
    const float eye[3] = {(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2};
    for (uint32_t is_open = 0; is_open < 2; ++is_open) {
      use_door(is_open);
      require(sightcell_view_move(view, eye, &frame) == SIGHTCELL_OK && frame.cell == cell, "move");
      polygons[is_open] = frame.polygon_count;
    }
    require(polygons[1] <= polygons[0], "an open door adds nothing");
    hidden = polygons[0] - polygons[1];
  }
  sightcell_view_destroy(view);
  sightcell_db_close(db);
}

/* A host that reads its file at once; an asynchronous one returns and delivers later. */
static sightcell_db* paged;
/* [source */
static sightcell_status request(void* user, uint64_t offset, uint32_t size, uint32_t ticket) {
  FILE* file = user;
  void* bytes = malloc(size);
  sightcell_status s = SIGHTCELL_ERR_IO;
  if (bytes && fseek(file, (long)offset, SEEK_SET) == 0 && fread(bytes, 1, size, file) == size)
    s = sightcell_db_deliver(paged, ticket, bytes, size);
  free(bytes);
  return s;
}
/* source] */

static void stream(const char* path, const float eye[3], const float velocity[3]) {
  FILE* file = fopen(path, "rb");
  require(file && fseek(file, 0, SEEK_END) == 0, "file");
  const uint64_t size = (uint64_t)ftell(file);
  /* [stream */
  const sightcell_source source = {file, size, request};
  if (sightcell_db_open_source(&source, NULL, 16 << 20, &paged) != SIGHTCELL_OK) exit(1);
  sightcell_db_prefetch(paged, eye, velocity, 2.0f);  /* now and then: what may be needed within two seconds */
  /* stream] */
  sightcell_view* of_stream;
  sightcell_frame there;
  require(sightcell_view_create(paged, &of_stream) == SIGHTCELL_OK, "view");
  require(sightcell_view_move(of_stream, eye, &there) == SIGHTCELL_OK, "move");
  require(there.flags == frame.flags && there.polygon_count == frame.polygon_count, "the same, piece by piece");
  sightcell_view_destroy(of_stream);
  sightcell_db_close(paged);
  fclose(file);
}

/* --- A cell, drawn in every way. ------------------------------------------------------------------------------------ */

static void expect_drawn(const unsigned char* expected, int whole_objects, const char* what) {
  for (uint32_t s = 0; s < polygon_total; ++s)
    require(whole_objects ? drawn[s] >= expected[s] : drawn[s] == expected[s], what);
  memset(drawn, 0, polygon_total);
}

int main(int argc, char** argv) {
  require(argc == 3, "usage: readme_host_snippets FILE.pvs FILE_WITH_A_DOOR.pvs");
  require(sightcell_db_open_file(argv[1], NULL, &db) == SIGHTCELL_OK, "open");
  require(sightcell_view_create(db, &view) == SIGHTCELL_OK, "view");
  sightcell_info info = {.struct_size = sizeof info};
  require(sightcell_db_info(db, &info) == SIGHTCELL_OK, "info");
  polygon_total = info.polygon_count;
  range_bound = info.range_bound;
  draws = malloc((info.draw_count + 1) * sizeof *draws);
  sightcell_db_draws(db, draws, info.draw_count, &draw_total);
  drawn = calloc(polygon_total, 1);
  unsigned char* expected = calloc(polygon_total, 1);
  uint32_t* order = malloc(polygon_total * sizeof *order);
  source_indices = malloc(3 * sizeof(uint32_t) * polygon_total);
  stored_indices = malloc(3 * sizeof(uint32_t) * polygon_total);
  mapped = malloc(3 * sizeof(uint32_t) * polygon_total);
  size_t n;
  sightcell_db_order(db, order, polygon_total, &n);
  for (uint32_t s = 0; s < polygon_total; ++s)
    for (uint32_t k = 0; k < 3; ++k) source_indices[3 * (size_t)order[s] + k] = 3 * s + k;
  permute_index_buffers(order);

  sightcell_range* ranges = malloc((range_bound + 1) * sizeof *ranges);
  GLsizei* counts = malloc((range_bound + 1) * sizeof *counts);
  const void** offsets = malloc((range_bound + 1) * sizeof *offsets);
  VkDrawIndexedIndirectCommand* commands = malloc((range_bound + 1) * sizeof *commands);
  const size_t words = (draw_total + 63) / 64;
  uint64_t* bits = malloc((words + 1) * sizeof *bits);
  for (uint32_t cell = 0; cell < info.cell_count; ++cell) {
    float min[3], max[3];
    sightcell_db_cell_box(db, cell, min, max);
    const float eye[3] = {(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2};
    require(sightcell_view_move(view, eye, &frame) == SIGHTCELL_OK && frame.cell == cell, "move");
    sightcell_view_ranges(view, ranges, range_bound, &n);
    memset(expected, 0, polygon_total);
    for (size_t i = 0; i < n; ++i)
      memset(expected + draws[ranges[i].draw].first_stored + ranges[i].first, 1, ranges[i].count);
    multi_draw(ranges, counts, offsets);
    expect_drawn(expected, 0, "multi-draw");
    frame.flags |= SIGHTCELL_FRAME_CHANGED;
    index_buffer();
    expect_drawn(expected, 0, "index buffer");
    vulkan_indirect(1, commands);
    expect_drawn(expected, 0, "indirect");
    objects(bits, words);
    expect_drawn(expected, 1, "objects");
    if (cell > 0) continue;
    player players[2];
    for (int p = 0; p < 2; ++p) {
      memcpy(players[p].eye, eye, sizeof eye);
      memcpy(players[p].min, min, sizeof min);
      memcpy(players[p].max, max, sizeof max);
      require(sightcell_view_create(db, &players[p].view) == SIGHTCELL_OK, "player");
    }
    server(players, 2);
    require(sent == 2, "a file without volumes hides nobody");
    for (int p = 0; p < 2; ++p) sightcell_view_destroy(players[p].view);
    const float velocity[3] = {1, 0, 0};
    stream(argv[1], eye, velocity);
  }
  sightcell_view_destroy(view);
  sightcell_db_close(db);
  doors(argv[2]);
  free(draws);
  free(drawn);
  free(expected);
  free(order);
  free(source_indices);
  free(stored_indices);
  free(mapped);
  free(ranges);
  free(counts);
  free((void*)offsets);
  free(commands);
  free(bits);
  return 0;
}
