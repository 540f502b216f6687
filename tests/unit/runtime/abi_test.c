/* The ABI is frozen: names, values, sizes, offsets and signatures, as version 1 has them. Things may be added to this
 * file; a line of it never changes. That it compiles and links against the shared library is the test. */
#include <sightcell/sightcell.h>

#define IS(name, value) _Static_assert((name) == (value), #name)
#define SIZE(type, size) _Static_assert(sizeof(type) == (size), #type)
#define AT(type, member, offset) _Static_assert(offsetof(type, member) == (offset), #type "." #member)
/* An array counts as a pointer. */
#define OF(type, member, kind) _Static_assert(_Generic(((type*)0)->member, kind : 1, default : 0), #type "." #member)

/* Only a warning by itself: a function of another signature. */
#if defined(__GNUC__)
#pragma GCC diagnostic error "-Wincompatible-pointer-types"
#endif

IS(SIGHTCELL_API_VERSION, 1);
IS(SIGHTCELL_NO_CELL, 0xFFFFFFFFu);
IS(SIGHTCELL_NO_NAMED_GROUP, 0xFFFFFFFFu);
IS(SIGHTCELL_OK, 0);
IS(SIGHTCELL_ERR_ARGUMENT, 1);
IS(SIGHTCELL_ERR_MEMORY, 2);
IS(SIGHTCELL_ERR_CAPACITY, 3);
IS(SIGHTCELL_ERR_STALE, 4);
IS(SIGHTCELL_ERR_IO, 10);
IS(SIGHTCELL_ERR_NOT_OURS, 20);
IS(SIGHTCELL_ERR_VERSION, 21);
IS(SIGHTCELL_ERR_TRUNCATED, 22);
IS(SIGHTCELL_ERR_CHECKSUM, 23);
IS(SIGHTCELL_ERR_CORRUPT, 24);
IS(SIGHTCELL_ERR_LIMIT, 25);
IS(SIGHTCELL_ERR_OTHER_SCENE, 26);
IS(SIGHTCELL_FRAME_CHANGED, 1u);
IS(SIGHTCELL_FRAME_DRAW_ALL, 2u);
IS(SIGHTCELL_FRAME_OUTSIDE, 4u);
IS(SIGHTCELL_FRAME_PENDING, 8u);
IS(SIGHTCELL_FRAME_DAMAGED, 16u);
IS(SIGHTCELL_OUTSIDE_ALL, 0);
IS(SIGHTCELL_OUTSIDE_NEAREST, 1);
IS(SIGHTCELL_OUTSIDE_LAST, 2);
IS(SIGHTCELL_DEBUG_CELL, 1u);
IS(SIGHTCELL_DEBUG_KEPT, 2u);
IS(SIGHTCELL_DEBUG_NEIGHBORS, 4u);
IS(SIGHTCELL_DEBUG_VOLUMES, 8u);

SIZE(sightcell_status, 4);
SIZE(sightcell_frame, 64);
AT(sightcell_frame, cell, 0);
AT(sightcell_frame, flags, 4);
AT(sightcell_frame, polygon_count, 8);
AT(sightcell_frame, revision, 12);
SIZE(sightcell_range, 12);
AT(sightcell_range, draw, 0);
AT(sightcell_range, first, 4);
AT(sightcell_range, count, 8);
SIZE(sightcell_command, 20);
AT(sightcell_command, index_count, 0);
AT(sightcell_command, instance_count, 4);
AT(sightcell_command, first_index, 8);
AT(sightcell_command, base_vertex, 12);
AT(sightcell_command, first_instance, 16);
SIZE(sightcell_draw, 48);
AT(sightcell_draw, node, 0);
AT(sightcell_draw, mesh, 4);
AT(sightcell_draw, primitive, 8);
AT(sightcell_draw, instance, 12);
AT(sightcell_draw, material, 16);
AT(sightcell_draw, group, 20);
AT(sightcell_draw, first_source, 24);
AT(sightcell_draw, polygon_count, 28);
AT(sightcell_draw, first_stored, 32);
AT(sightcell_draw, base_vertex, 36);
AT(sightcell_draw, host_tag, 40);
SIZE(sightcell_info, 56);
AT(sightcell_info, struct_size, 0);
AT(sightcell_info, format_version, 4);
AT(sightcell_info, layout, 8);
AT(sightcell_info, polygon_count, 12);
AT(sightcell_info, cell_count, 16);
AT(sightcell_info, draw_count, 20);
AT(sightcell_info, range_bound, 24);
AT(sightcell_info, margin, 28);
AT(sightcell_info, max_pixel_error, 32);
AT(sightcell_info, confidence, 36);
AT(sightcell_info, scene_fingerprint, 40);
SIZE(sightcell_allocator, 3 * sizeof(void*));
AT(sightcell_allocator, alloc, 0);
AT(sightcell_allocator, release, sizeof(void*));
AT(sightcell_allocator, user, 2 * sizeof(void*));
AT(sightcell_source, user, 0);
AT(sightcell_source, size, 8);
AT(sightcell_source, request, 16);
SIZE(sightcell_miss, 32);
AT(sightcell_miss, eye, 0);
AT(sightcell_miss, polygon, 24);
SIZE(sightcell_view_stats, 64);
AT(sightcell_view_stats, moves, 8);
AT(sightcell_view_stats, rows_decoded, 16);
AT(sightcell_view_stats, changes, 24);
AT(sightcell_view_stats, moves_outside, 32);
AT(sightcell_view_stats, moves_pending, 40);
AT(sightcell_view_stats, moves_draw_all, 48);
AT(sightcell_view_stats, polygons, 56);
SIZE(sightcell_db_stats, 56);
AT(sightcell_db_stats, chunk_count, 4);
AT(sightcell_db_stats, memory_bytes, 8);
AT(sightcell_db_stats, resident_bytes, 16);
AT(sightcell_db_stats, requests, 24);
AT(sightcell_db_stats, delivered_bytes, 32);
AT(sightcell_db_stats, evictions, 40);
AT(sightcell_db_stats, refused_deliveries, 48);
SIZE(sightcell_debug_line, 32);
AT(sightcell_debug_line, from, 0);
AT(sightcell_debug_line, to, 12);
AT(sightcell_debug_line, kind, 24);
AT(sightcell_debug_line, number, 28);
AT(sightcell_frame, reserved, 16);
AT(sightcell_miss, reserved, 28);
AT(sightcell_view_stats, struct_size, 0);
AT(sightcell_view_stats, reserved, 4);
AT(sightcell_db_stats, struct_size, 0);

OF(sightcell_frame, cell, uint32_t);
OF(sightcell_frame, flags, uint32_t);
OF(sightcell_frame, polygon_count, uint32_t);
OF(sightcell_frame, revision, uint32_t);
OF(sightcell_frame, reserved, uint32_t*);
OF(sightcell_range, draw, uint32_t);
OF(sightcell_range, first, uint32_t);
OF(sightcell_range, count, uint32_t);
OF(sightcell_command, index_count, uint32_t);
OF(sightcell_command, instance_count, uint32_t);
OF(sightcell_command, first_index, uint32_t);
OF(sightcell_command, base_vertex, uint32_t);
OF(sightcell_command, first_instance, uint32_t);
OF(sightcell_draw, node, uint32_t);
OF(sightcell_draw, mesh, uint32_t);
OF(sightcell_draw, primitive, uint32_t);
OF(sightcell_draw, instance, uint32_t);
OF(sightcell_draw, material, uint32_t);
OF(sightcell_draw, group, uint32_t);
OF(sightcell_draw, first_source, uint32_t);
OF(sightcell_draw, polygon_count, uint32_t);
OF(sightcell_draw, first_stored, uint32_t);
OF(sightcell_draw, base_vertex, uint32_t);
OF(sightcell_draw, host_tag, uint64_t);
OF(sightcell_info, struct_size, uint32_t);
OF(sightcell_info, format_version, uint32_t);
OF(sightcell_info, layout, uint32_t);
OF(sightcell_info, polygon_count, uint32_t);
OF(sightcell_info, cell_count, uint32_t);
OF(sightcell_info, draw_count, uint32_t);
OF(sightcell_info, range_bound, uint32_t);
OF(sightcell_info, margin, float);
OF(sightcell_info, max_pixel_error, float);
OF(sightcell_info, confidence, float);
OF(sightcell_info, scene_fingerprint, uint8_t*);
OF(sightcell_miss, eye, double*);
OF(sightcell_miss, polygon, uint32_t);
OF(sightcell_miss, reserved, uint32_t);
OF(sightcell_view_stats, struct_size, uint32_t);
OF(sightcell_view_stats, reserved, uint32_t);
OF(sightcell_view_stats, moves, uint64_t);
OF(sightcell_view_stats, rows_decoded, uint64_t);
OF(sightcell_view_stats, changes, uint64_t);
OF(sightcell_view_stats, moves_outside, uint64_t);
OF(sightcell_view_stats, moves_pending, uint64_t);
OF(sightcell_view_stats, moves_draw_all, uint64_t);
OF(sightcell_view_stats, polygons, uint64_t);
OF(sightcell_db_stats, struct_size, uint32_t);
OF(sightcell_db_stats, chunk_count, uint32_t);
OF(sightcell_db_stats, memory_bytes, uint64_t);
OF(sightcell_db_stats, resident_bytes, uint64_t);
OF(sightcell_db_stats, requests, uint64_t);
OF(sightcell_db_stats, delivered_bytes, uint64_t);
OF(sightcell_db_stats, evictions, uint64_t);
OF(sightcell_db_stats, refused_deliveries, uint64_t);
OF(sightcell_debug_line, from, float*);
OF(sightcell_debug_line, to, float*);
OF(sightcell_debug_line, kind, uint32_t);
OF(sightcell_debug_line, number, uint32_t);
OF(sightcell_allocator, alloc, void* (*)(void*, size_t, size_t));
OF(sightcell_allocator, release, void (*)(void*, void*, size_t));
OF(sightcell_allocator, user, void*);
OF(sightcell_source, user, void*);
OF(sightcell_source, size, uint64_t);
OF(sightcell_source, request, sightcell_status (*)(void*, uint64_t, uint32_t, uint32_t));

typedef sightcell_status st;
typedef const sightcell_db* db;
typedef const sightcell_view* view;

/* Every function, with its whole signature. */
static uint32_t (*const version)(void) = sightcell_version;
static const char* (*const status_text)(st) = sightcell_status_text;
static st (*const open_bytes)(const void*, size_t, const sightcell_allocator*, sightcell_db**) = sightcell_db_open;
static st (*const open_file)(const char*, const sightcell_allocator*, sightcell_db**) = sightcell_db_open_file;
static st (*const open_source)(const sightcell_source*, const sightcell_allocator*, uint64_t,
                               sightcell_db**) = sightcell_db_open_source;
static st (*const deliver)(sightcell_db*, uint32_t, const void*, uint32_t) = sightcell_db_deliver;
static st (*const prefetch)(sightcell_db*, const float[3], const float[3], float) = sightcell_db_prefetch;
static void (*const close_db)(sightcell_db*) = sightcell_db_close;
static uint32_t (*const polygon_count)(db) = sightcell_db_polygon_count;
static uint32_t (*const cell_count)(db) = sightcell_db_cell_count;
static st (*const cell_box)(db, uint32_t, float[3], float[3]) = sightcell_db_cell_box;
static uint32_t (*const volume_count)(db) = sightcell_db_volume_count;
static st (*const volume_box)(db, uint32_t, float[3], float[3]) = sightcell_db_volume_box;
static uint32_t (*const named_group_count)(db) = sightcell_db_named_group_count;
static st (*const named_group_name)(db, uint32_t, char*, size_t, size_t*) = sightcell_db_named_group_name;
static st (*const find_named_group)(db, const char*, uint32_t*) = sightcell_db_find_named_group;
static st (*const groups_of_draws)(db, uint32_t*, size_t, size_t*) = sightcell_db_named_groups_of_draws;
static st (*const show_group)(sightcell_view*, uint32_t, uint32_t) = sightcell_view_show_named_group;
static st (*const info)(db, sightcell_info*) = sightcell_db_info;
static st (*const check)(db) = sightcell_db_check;
static st (*const draws)(db, sightcell_draw*, size_t, size_t*) = sightcell_db_draws;
static st (*const order)(db, uint32_t*, size_t, size_t*) = sightcell_db_order;
static st (*const create)(db, sightcell_view**) = sightcell_view_create;
static void (*const destroy)(sightcell_view*) = sightcell_view_destroy;
static st (*const move)(sightcell_view*, const float[3], sightcell_frame*) = sightcell_view_move;
static st (*const move_box)(sightcell_view*, const float[3], const float[3],
                            sightcell_frame*) = sightcell_view_move_box;
static st (*const policy)(sightcell_view*, uint32_t, float) = sightcell_view_policy;
static st (*const origin)(sightcell_view*, const double[3]) = sightcell_view_origin;
static st (*const polygons)(view, uint32_t*, size_t, size_t*) = sightcell_view_polygons;
static st (*const ranges)(view, sightcell_range*, size_t, size_t*) = sightcell_view_ranges;
static st (*const indices)(view, const uint32_t*, uint32_t*, size_t, size_t*) = sightcell_view_indices;
static st (*const commands)(view, uint32_t, void*, size_t, size_t, size_t*) = sightcell_view_commands;
static st (*const objects)(view, uint64_t*, size_t) = sightcell_view_objects;
static st (*const changes)(view, uint32_t, sightcell_range*, size_t, size_t*, sightcell_range*, size_t,
                           size_t*) = sightcell_view_changes;
static st (*const box_visible)(view, const float[3], const float[3], uint32_t*) = sightcell_view_box_visible;
static st (*const view_statistics)(view, sightcell_view_stats*) = sightcell_view_statistics;
static st (*const db_statistics)(db, sightcell_db_stats*) = sightcell_db_statistics;
static st (*const debug_lines)(view, uint32_t, sightcell_debug_line*, size_t, size_t*) = sightcell_view_debug_lines;
static st (*const misses_text)(db, const sightcell_miss*, size_t, char*, size_t, size_t*) = sightcell_db_misses_text;

int main(void) {
  const int missing = !open_bytes || !open_file || !open_source || !deliver || !prefetch || !close_db ||
                      !polygon_count || !cell_count || !cell_box || !volume_count || !volume_box || !info || !check ||
                      !draws || !order || !create || !destroy || !move || !move_box || !policy || !origin ||
                      !polygons || !ranges || !indices || !commands || !objects || !changes || !box_visible ||
                      !view_statistics || !db_statistics || !debug_lines || !misses_text ||
                      !named_group_count || !named_group_name || !find_named_group || !groups_of_draws || !show_group;
  return missing || version() != SIGHTCELL_API_VERSION || status_text(SIGHTCELL_OK) == NULL;
}
