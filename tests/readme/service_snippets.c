/* The snippets of docs/hosting.md, docs/lights.md and docs/streaming.md that draw no cell: lights, players, doors, identity
 * and files that are read piece by piece.
 * usage: readme_service_snippets FILE_WITH_A_DOOR.pvs FILE_WITH_NAMES.pvs FILE.pvs ... */
#include <sightcell/identity.h>
#include <sightcell/lights.h>
#include <sightcell/sightcell.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static sightcell_db* db;
static sightcell_view* view;
static sightcell_frame frame;
static uint32_t polygon_total;

static void require(int good, const char* what) {
  if (good) return;
  fprintf(stderr, "%s\n", what);
  exit(1);
}

static unsigned char shaded[64]; /* by light */
static size_t in_shadow_maps;    /* polygons */
static void shade_with(uint32_t light) { shaded[light] = 1; }
static void draw_shadow_map(uint32_t light, const sightcell_range* of_light, size_t count) {
  require(light < 64, "light");
  for (size_t i = 0; i < count; ++i) in_shadow_maps += of_light[i].count;
}

/* In the last cell of a file with lights. */
static void light_scene(void) {
  sightcell_lights* lights;
  uint32_t here[64];
  size_t light_total;
  /* [open lights */
  if (sightcell_lights_create(db, &lights) != SIGHTCELL_OK) return; /* SIGHTCELL_ERR_ABSENT: baked without --lights */
  sightcell_lights_list(lights, NULL, 0, &light_total);
  for (uint32_t light = 0; light < light_total; ++light) {
    size_t count;
    sightcell_view_light_ranges(view, lights, light, NULL, 0, &count);
    sightcell_range* lit = malloc((count + 1) * sizeof *lit);
    sightcell_view_light_ranges(view, lights, light, lit, count, &count);
    draw_shadow_map(light, lit, count); /* once: the lights do not move */
    free(lit);
  }
  /* open lights] */
  size_t count;
  /* [lights here */
  sightcell_view_lights(view, lights, here, light_total, &count); /* where the frame has CHANGED */
  for (size_t i = 0; i < count; ++i) shade_with(here[i]);
  /* lights here] */
  require(light_total == 10 && count > 0 && count < 10 && shaded[here[0]], "lights");
  require(in_shadow_maps > polygon_total, "light 9 reaches everything, others a part");
  sightcell_lights_destroy(lights);
}

typedef struct {
  float eye[3], min[3], max[3];
  sightcell_view* view;
} player;
enum { most_players = 64 };
static player players[most_players];
static unsigned char told[most_players][most_players]; /* first whom, then of whom */
static void send_position(const player* to, const player* of) { told[to - players][of - players] = 1; }

static void server(size_t player_count) {
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

static void add_player(size_t number, const float min[3], const float max[3], const float box_min[3],
                       const float box_max[3]) {
  player* p = &players[number];
  for (int k = 0; k < 3; ++k) {
    p->eye[k] = (min[k] + max[k]) / 2;
    p->min[k] = 0.75f * box_min[k] + 0.25f * box_max[k];
    p->max[k] = 0.25f * box_min[k] + 0.75f * box_max[k];
  }
  require(sightcell_view_create(db, &p->view) == SIGHTCELL_OK, "player");
}

/* Player i looks from cell i and is to be found in volume i: it is told of those whose volumes its cell sees. In a file
 * without volumes, of all. */
static void play(void) {
  const uint32_t volumes = sightcell_db_volume_count(db);
  size_t count = sightcell_db_cell_count(db);
  if (volumes > 0 && count > volumes) count = volumes;
  if (count > most_players) count = most_players;
  float min[3], max[3], box_min[3] = {0, 0, 0}, box_max[3] = {1, 1, 1};
  for (size_t i = 0; i < count; ++i) {
    sightcell_db_cell_box(db, (uint32_t)i, min, max);
    if (volumes > 0) sightcell_db_volume_box(db, (uint32_t)i, box_min, box_max);
    add_player(i, min, max, box_min, box_max);
  }
  memset(told, 0, sizeof told);
  server(count);
  sightcell_debug_line* lines = malloc(12 * (volumes + (size_t)1) * sizeof *lines);
  size_t hidden = 0;
  for (size_t i = 0; i < count; ++i) {
    unsigned char expected[most_players];
    memset(expected, volumes == 0, sizeof expected);
    size_t n;
    sightcell_view_move(view, players[i].eye, &frame);
    sightcell_view_debug_lines(view, SIGHTCELL_DEBUG_VOLUMES, lines, 12 * (size_t)volumes, &n);
    for (size_t at = 0; at < n; at += 12)
      if (lines[at].number < most_players) expected[lines[at].number] = 1;
    require(memcmp(told[i], expected, count) == 0, "who is told of whom");
    for (size_t j = 0; j < count; ++j) hidden += !expected[j];
    sightcell_view_destroy(players[i].view);
  }
  require((hidden > 0) == (volumes > 0), "somebody is hidden where there are volumes");
  free(lines);
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

/* Objects of a host: triangles of a size of their own, one of which may be moved. */
typedef struct {
  float positions[9];
  uint32_t indices[3];
  size_t stride, vertex_count, index_count;
} mesh;
typedef struct {
  const mesh* mesh;
  const char* node_name;
} object;
enum { object_count = 3 };
static object scene[object_count];
static uint64_t hashes[object_count];
static const char* names[object_count];
static uint32_t draw_of_object[object_count];
static int differences, everything;
static void draw_everything(void) { ++everything; }
static void report_difference(const sightcell_draw_match* match) {
  require(match->extra > 0 && match->first_extra == 0, "the first object is of no scene");
  ++differences;
}

static void find_by_geometry(void) {
  /* [match */
  sightcell_draw_match match = {.struct_size = sizeof match};
  for (uint32_t i = 0; i < object_count; ++i) { /* positions in the space of the mesh; instances have the same hash */
    const mesh* m = scene[i].mesh;
    sightcell_geometry_hash(m->positions, m->stride, m->vertex_count, m->indices, m->index_count, &hashes[i]);
    names[i] = scene[i].node_name;
  }
  const sightcell_status s = sightcell_db_match(db, hashes, names, object_count, draw_of_object, &match);
  if (s == SIGHTCELL_ERR_OTHER_SCENE) report_difference(&match);
  if (s != SIGHTCELL_OK) draw_everything(); /* SIGHTCELL_ERR_ABSENT: baked without --names */
  /* match] */
}

/* A file without identity, then one of another scene. tests/unit/runtime/identity_test.cpp has those that match. */
static void identity(const char* without, const char* other) {
  mesh triangle = {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, 12, 3, 3};
  for (uint32_t i = 0; i < object_count; ++i) scene[i] = (object){&triangle, "Cube"};
  for (int file = 0; file < 2; ++file) {
    require(sightcell_db_open_file(file == 0 ? without : other, NULL, &db) == SIGHTCELL_OK, "open");
    find_by_geometry();
    require(everything == file + 1 && differences == file, "both files draw everything");
    sightcell_db_close(db);
  }
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
  sightcell_db_stats stats = {.struct_size = sizeof stats};
  require(sightcell_db_statistics(paged, &stats) == SIGHTCELL_OK && stats.resident_bytes > 0, "what lies ahead is there");
  sightcell_view* of_stream;
  sightcell_frame there;
  require(sightcell_view_create(paged, &of_stream) == SIGHTCELL_OK, "view");
  require(sightcell_view_move(of_stream, eye, &there) == SIGHTCELL_OK, "move");
  require(there.flags == frame.flags && there.polygon_count == frame.polygon_count, "the same, piece by piece");
  sightcell_view_destroy(of_stream);
  sightcell_db_close(paged);
  fclose(file);
}

static void center_of_cell(uint32_t cell, float center[3]) {
  float min[3], max[3];
  require(sightcell_db_cell_box(db, cell, min, max) == SIGHTCELL_OK, "box");
  for (int k = 0; k < 3; ++k) center[k] = (min[k] + max[k]) / 2;
}

int main(int argc, char** argv) {
  require(argc > 3, "usage: readme_service_snippets FILE_WITH_A_DOOR.pvs FILE_WITH_NAMES.pvs FILE.pvs ...");
  doors(argv[1]);
  identity(argv[1], argv[2]);
  for (int file = 3; file < argc; ++file) {
    require(sightcell_db_open_file(argv[file], NULL, &db) == SIGHTCELL_OK, "open");
    require(sightcell_view_create(db, &view) == SIGHTCELL_OK, "view");
    sightcell_info info = {.struct_size = sizeof info};
    require(sightcell_db_info(db, &info) == SIGHTCELL_OK, "info");
    polygon_total = info.polygon_count;
    float eye[3];
    const float velocity[3] = {1, 0, 0};
    center_of_cell(0, eye);
    require(sightcell_view_move(view, eye, &frame) == SIGHTCELL_OK && frame.cell == 0, "move");
    stream(argv[file], eye, velocity);
    center_of_cell(info.cell_count - 1, eye); /* lights are those that touch the last cell */
    require(sightcell_view_move(view, eye, &frame) == SIGHTCELL_OK, "move");
    light_scene();
    play();
    sightcell_view_destroy(view);
    sightcell_db_close(db);
  }
  require(in_shadow_maps > 0, "no file has lights");
  return 0;
}
