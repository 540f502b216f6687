/* Writes what the runtime returns for files, function by function, in the format of Dump.cs. usage: dump FILE... */
#include <sightcell/casters.h>
#include <sightcell/clusters.h>
#include <sightcell/identity.h>
#include <sightcell/lights.h>
#include <sightcell/residency.h>
#include <sightcell/sightcell.h>
#include <sightcell/viewpoints.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static sightcell_db* db;
static sightcell_view* view;
static sightcell_info info;
static sightcell_range ranges[20000], more[20000];
static sightcell_command commands[20000];
static uint32_t words[60000], list[60000], stored[60000];

static uint32_t bits_of(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

/* A number for a list: FNV-1a over its 32-bit words. */
static uint32_t hash(const void* data, size_t count) {
  const uint32_t* each = data;
  uint32_t sum = 2166136261u;
  for (size_t i = 0; i < count; ++i) sum = (sum ^ each[i]) * 16777619u;
  return sum;
}

static void line(const char* name, sightcell_status s, size_t count, const void* data, size_t of_words) {
  printf("%s %d %zu %08x\n", name, (int)s, s == SIGHTCELL_OK ? count : 0,
         s == SIGHTCELL_OK ? (unsigned)hash(data, of_words) : 0u);
}

/* A list whose elements have so many words; `count` is a variable of the caller, which the call sets. */
#define LIST(name, call, data, words_of_element)                \
  do {                                                          \
    const sightcell_status of_call = (call);                    \
    line(name, of_call, count, data, count*(words_of_element)); \
  } while (0)

static void floats(const char* name, sightcell_status s, const float* values, int count) {
  printf("%s %d", name, (int)s);
  for (int i = 0; i < count && s == SIGHTCELL_OK; ++i) printf(" %08x", (unsigned)bits_of(values[i]));
  puts("");
}

static void write_scene(void) {
  size_t count = 0;
  sightcell_draw draws[64];
  const sightcell_status s = sightcell_db_draws(db, draws, 64, &count);
  line("draws", s, count, draws, count * sizeof *draws / 4);
  LIST("order", sightcell_db_order(db, words, 60000, &count), words, 1);
  LIST("groups", sightcell_db_named_groups_of_draws(db, words, 60000, &count), words, 1);
  for (uint32_t g = 0; g < sightcell_db_named_group_count(db); ++g) {
    char name[256] = {0};
    uint32_t found = 0;
    sightcell_db_named_group_name(db, g, name, 255, &count);
    sightcell_db_find_named_group(db, name, &found);
    printf("group %s %u\n", name, (unsigned)found);
  }
  for (uint32_t d = 0; d < info.draw_count; ++d) {
    uint64_t value = 0;
    char name[256] = {0};
    const sightcell_status of_hash = sightcell_db_draw_hash(db, d, &value);
    printf("draw %d %016llx", (int)of_hash, (unsigned long long)(of_hash == SIGHTCELL_OK ? value : 0));
    const sightcell_status of_name = sightcell_db_draw_name(db, d, SIGHTCELL_NAME_NODE, name, 255, &count);
    printf(" %d %s\n", (int)of_name, of_name == SIGHTCELL_OK ? name : "");
  }
  float box[6];
  for (uint32_t c = 0; c < info.cell_count; ++c) {
    float eye[3], shares[2];
    floats("cell", sightcell_db_cell_box(db, c, box, box + 3), box, 6);
    floats("eye", sightcell_db_cell_eye(db, c, 0, eye), eye, 3);
    floats("shares", sightcell_db_cell_viewpoints(db, c, shares, shares + 1), shares, 2);
  }
  const sightcell_status of_bounds = sightcell_db_error_bounds(db, (float*)words, 60000, &count);
  if (of_bounds != SIGHTCELL_OK) count = 0;
  line("bounds", of_bounds, count, words, count);
  for (uint32_t v = 0; v < sightcell_db_volume_count(db); ++v)
    floats("volume", sightcell_db_volume_box(db, v, box, box + 3), box, 6);
  sightcell_db_clusters(db, ranges, 20000, &count);
  if (sightcell_db_cluster_count(db) == 0) count = 0;
  line("clusters", SIGHTCELL_OK, count, ranges, 3 * count);
}

static void write_outputs(sightcell_frame frame, sightcell_cluster_map* own, sightcell_cluster_map* of_file,
                          sightcell_casters* casters, sightcell_lights* lights, sightcell_residency* residency) {
  size_t count = 0, removed = 0;
  uint64_t objects[4] = {0};
  const size_t object_words = (info.draw_count + 63) / 64;
  line("objects", sightcell_view_objects(view, objects, object_words), object_words, objects, 2 * object_words);
  LIST("ranges", sightcell_view_ranges(view, ranges, 20000, &count), ranges, 3);
  LIST("polygons", sightcell_view_polygons(view, words, 60000, &count), words, 1);
  LIST("indices", sightcell_view_indices(view, stored, words, 60000, &count), words, 1);
  LIST("commands", sightcell_view_commands(view, 4, commands, sizeof *commands, 20000, &count), commands, 5);
  sightcell_status s = sightcell_view_changes(view, frame.revision - 1, ranges, 20000, &count, more, 20000, &removed);
  line("added", s, count, ranges, 3 * count);
  line("removed", s, removed, more, 3 * removed);
  memset(words, 0, info.draw_count * sizeof *words);
  s = sightcell_view_importance(view, (float*)words, 60000, &count);
  line("importance", s, info.draw_count, words, s == SIGHTCELL_OK ? info.draw_count : 0);
  uint32_t row[64] = {0};
  size_t row_words = (info.polygon_count / 7 + 1 + 31) / 32;
  line("own clusters", sightcell_view_clusters(view, own, row, row_words), row_words, row, row_words);
  LIST("cluster list", sightcell_cluster_list(row, row_words, list, 60000, &count), list, 1);
  if (of_file != NULL) {
    row_words = (sightcell_db_cluster_count(db) + 31) / 32;
    line("file clusters", sightcell_view_clusters(view, of_file, row, row_words), row_words, row, row_words);
  }
  if (casters != NULL) {
    LIST("casters", sightcell_view_casters(view, casters, 0, ranges, 20000, &count), ranges, 3);
    LIST("caster indices", sightcell_view_caster_indices(view, casters, 0, stored, words, 60000, &count), words, 1);
  }
  if (lights != NULL) {
    LIST("lights", sightcell_view_lights(view, lights, words, 60000, &count), words, 1);
    LIST("light", sightcell_view_light_ranges(view, lights, 3, ranges, 20000, &count), ranges, 3);
    LIST("light indices", sightcell_view_light_indices(view, lights, 3, stored, words, 60000, &count), words, 1);
  }
  if (residency != NULL) {
    uint8_t levels[16];
    s = sightcell_view_texture_levels(view, residency, 700, levels, 16, &count);
    for (size_t i = 0; i < count; ++i) words[i] = levels[i];
    line("levels", s, count, words, count);
    s = sightcell_residency_cell_levels(residency, 0, 700, levels, 16, &count);
    for (size_t i = 0; i < count; ++i) words[i] = levels[i];
    line("cell levels", s, count, words, count);
  }
  sightcell_debug_line* lines = malloc(20000 * sizeof *lines);
  s = sightcell_view_debug_lines(view, 31, lines, 20000, &count);
  line("lines", s, count, lines, 8 * count);
  free(lines);
}

static void move(const float eye[3], sightcell_cluster_map* own, sightcell_cluster_map* of_file,
                 sightcell_casters* casters, sightcell_lights* lights, sightcell_residency* residency) {
  sightcell_frame frame;
  const float max[3] = {eye[0] + 0.5f, eye[1] + 0.5f, eye[2] + 0.5f};
  uint32_t visible = 0;
  sightcell_status s = sightcell_view_move(view, eye, &frame);
  printf("move %d %u %u %u %u\n", (int)s, (unsigned)frame.cell, (unsigned)frame.flags, (unsigned)frame.polygon_count,
         (unsigned)frame.revision);
  write_outputs(frame, own, of_file, casters, lights, residency);
  s = sightcell_view_box_visible(view, eye, max, &visible);
  printf("visible %d %u\n", (int)s, (unsigned)visible);
  s = sightcell_view_move_box(view, eye, max, &frame);
  printf("box %d %u %u %u %u\n", (int)s, (unsigned)frame.cell, (unsigned)frame.flags, (unsigned)frame.polygon_count,
         (unsigned)frame.revision);
}

static void walk(void) {
  sightcell_cluster_map *own = NULL, *of_file = NULL;
  sightcell_casters* casters = NULL;
  sightcell_lights* lights = NULL;
  sightcell_residency* residency = NULL;
  for (uint32_t i = 0; i < info.polygon_count; ++i) words[i] = i / 7;
  sightcell_cluster_map_create(db, words, info.polygon_count, info.polygon_count / 7 + 1, &own);
  printf("map %d\n", (int)sightcell_cluster_map_of_file(db, &of_file));
  printf("suns %d\n", (int)sightcell_casters_create(db, &casters));
  printf("lights %d\n", (int)sightcell_lights_create(db, &lights));
  if (lights != NULL) {
    sightcell_light all[16];
    size_t all_count = 0;
    const sightcell_status s = sightcell_lights_list(lights, all, 16, &all_count);
    line("list of lights", s, all_count, all, sizeof *all / 4 * all_count);
  }
  printf("residency %d\n", (int)sightcell_residency_create(db, &residency));
  if (residency != NULL) {
    sightcell_texture textures[16];
    size_t textures_count = 0;
    const sightcell_status s = sightcell_residency_textures(residency, textures, 16, &textures_count);
    line("textures", s, textures_count, textures, 3 * textures_count);
  }
  for (uint32_t i = 0; i < 3 * info.polygon_count; ++i) stored[i] = 10 * i;
  for (uint32_t c = 0; c < info.cell_count; ++c) {
    float min[3], max[3], eye[3];
    sightcell_db_cell_box(db, c, min, max);
    for (int i = 0; i < 3; ++i) eye[i] = 0.5f * (min[i] + max[i]);
    move(eye, own, of_file, casters, lights, residency);
  }
  const double origin[3] = {1e6, 0, -1e6};
  printf("origin %d\n", (int)sightcell_view_origin(view, origin));
  printf("policy %d\n", (int)sightcell_view_policy(view, SIGHTCELL_OUTSIDE_NEAREST | SIGHTCELL_PENDING_LAST, 3e6f));
  for (uint32_t g = 0; g < sightcell_db_named_group_count(db); ++g) sightcell_view_show_named_group(view, g, 0);
  move((const float[3]){-1e6f, 0.5f, 1e6f}, own, of_file, casters, lights, residency);
  sightcell_view_stats stats = {.struct_size = sizeof stats};
  sightcell_view_statistics(view, &stats);
  line("statistics", SIGHTCELL_OK, (size_t)stats.moves, &stats, sizeof stats / 4);
  const sightcell_miss misses[2] = {{{1.5, 2, 3}, 0, 0}, {{-1.5, 0.125, 3e5}, info.polygon_count - 1, 0}};
  char text[1000] = {0};
  size_t count = 0;
  sightcell_db_misses_text(db, misses, 2, text, sizeof text, &count);
  printf("%s\n", text);
  sightcell_residency_destroy(residency);
  sightcell_lights_destroy(lights);
  sightcell_casters_destroy(casters);
  sightcell_cluster_map_destroy(of_file);
  sightcell_cluster_map_destroy(own);
}

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    sightcell_status s = sightcell_db_open_file(argv[i], NULL, &db);
    printf("open %d %s\n", (int)s, sightcell_status_text(s));
    if (s != SIGHTCELL_OK) continue;
    info = (sightcell_info){.struct_size = sizeof info};
    sightcell_db_info(db, &info);
    line("info", SIGHTCELL_OK, info.cell_count, &info, sizeof info / 4);
    printf("check %d\n", (int)sightcell_db_check(db));
    write_scene();
    if (sightcell_view_create(db, &view) != SIGHTCELL_OK) return 1;
    walk();
    sightcell_view_destroy(view);
    sightcell_db_close(db);
  }
  return 0;
}
