// The C functions of views and of the host's clusters: each checks its arguments and calls the implementation.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "cluster_map.h"
#include "commands.h"
#include "db.h"
#include "debug_lines.h"
#include "draw_importance.h"
#include "index_list.h"
#include "list_output.h"
#include "object_bits.h"
#include "ranges.h"
#include "sightcell/clusters.h"
#include "sightcell/sightcell.h"
#include "view.h"
#include "volume_index.h"

namespace format = sightcell::format;
namespace runtime = sightcell::runtime;

static_assert(sizeof(sightcell_frame) == 64 && sizeof(sightcell_range) == 12);
static_assert(sizeof(sightcell_command) == 20 && sizeof(sightcell_cluster_word) == 8);

sightcell_status sightcell_view_create(const sightcell_db* db, sightcell_view** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  return db->is_open() ? sightcell_view::create(*db, out) : SIGHTCELL_PENDING;
}

void sightcell_view_destroy(sightcell_view* view) {
  sightcell_view::destroy(view);
}

sightcell_status sightcell_view_move(sightcell_view* view, const float eye[3], sightcell_frame* frame) {
  if (view == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  sightcell_frame unread;
  if (frame != nullptr) return view->move(eye, *frame);
  // The host cannot read the flags, so the view shows everything.
  static_cast<void>(view->move(nullptr, unread));
  return SIGHTCELL_ERR_ARGUMENT;
}

sightcell_status sightcell_view_move_box(sightcell_view* view, const float min[3], const float max[3],
                                         sightcell_frame* frame) {
  if (view == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  sightcell_frame unread;
  if (frame != nullptr) return view->move_box(min, max, *frame);
  static_cast<void>(view->move(nullptr, unread));
  return SIGHTCELL_ERR_ARGUMENT;
}

sightcell_status sightcell_view_policy(sightcell_view* view, uint32_t outside, float max_distance) {
  return view == nullptr ? SIGHTCELL_ERR_ARGUMENT : view->set_policy(outside, max_distance);
}

sightcell_status sightcell_view_origin(sightcell_view* view, const double origin[3]) {
  return view == nullptr ? SIGHTCELL_ERR_ARGUMENT : view->set_origin(origin);
}

sightcell_status sightcell_view_show_named_group(sightcell_view* view, uint32_t group, uint32_t shown) {
  return view == nullptr ? SIGHTCELL_ERR_ARGUMENT : view->show_named_group(group, shown != 0);
}

sightcell_status sightcell_view_polygons(const sightcell_view* view, uint32_t* source_ids, size_t capacity,
                                         size_t* count) {
  if (view == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const sightcell_status room = runtime::check_room(source_ids, capacity, view->polygon_count(), count);
  if (room != SIGHTCELL_OK) return room;
  for (const sightcell_range& r : view->ranges()) {
    source_ids = runtime::write_sources(view->db(), r.draw, r.first, r.count, source_ids);
  }
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_ranges(const sightcell_view* view, sightcell_range* dst, size_t capacity,
                                       size_t* count) {
  if (view == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const sightcell_status room = runtime::check_room(dst, capacity, view->ranges().size(), count);
  if (room != SIGHTCELL_OK) return room;
  std::copy_n(view->ranges().data(), view->ranges().size(), dst);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_indices(const sightcell_view* view, const uint32_t* stored_indices, uint32_t* dst,
                                        size_t capacity, size_t* count) {
  if (view == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const sightcell_status room = runtime::check_room(dst, capacity, std::uint64_t{3} * view->polygon_count(), count);
  if (room != SIGHTCELL_OK || view->polygon_count() == 0) return room;
  if (stored_indices == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  runtime::copy_indices(view->runs(), stored_indices, dst);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_commands(const sightcell_view* view, uint32_t min_gap, void* dst, size_t stride,
                                         size_t capacity, size_t* count) {
  if (view == nullptr || stride < sizeof(sightcell_command)) return SIGHTCELL_ERR_ARGUMENT;
  // Indices are numbered in 32 bits.
  if (view->db().polygon_count() > std::numeric_limits<std::uint32_t>::max() / 3) return SIGHTCELL_ERR_LIMIT;
  const sightcell_status room = runtime::check_room(dst, capacity, runtime::count_commands(*view, min_gap), count);
  if (room != SIGHTCELL_OK) return room;
  runtime::write_commands(*view, min_gap, static_cast<std::byte*>(dst), stride);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_objects(const sightcell_view* view, uint64_t* bits_by_draw, size_t words) {
  if (view == nullptr || (bits_by_draw == nullptr && words > 0)) return SIGHTCELL_ERR_ARGUMENT;
  if (words < (std::size_t{view->db().file().draw_count()} + 63) / 64) return SIGHTCELL_ERR_CAPACITY;
  runtime::write_object_bits(*view, {bits_by_draw, words});
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_importance(const sightcell_view* view, float* dst, size_t capacity, size_t* count) {
  if (view == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const std::size_t need = view->db().range_borders().size() - 1;
  const sightcell_status room = runtime::check_room(dst, capacity, need, count);
  return room != SIGHTCELL_OK ? room : runtime::write_draw_importance(*view, {dst, need});
}

sightcell_status sightcell_view_box_visible(const sightcell_view* view, const float min[3], const float max[3],
                                            uint32_t* visible) {
  if (visible == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *visible = 1;
  if (view == nullptr || min == nullptr || max == nullptr || !runtime::volume_index::is_box(min, max)) {
    return SIGHTCELL_ERR_ARGUMENT;
  }
  *visible = view->box_visible(min, max) ? 1 : 0;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_changes(const sightcell_view* view, uint32_t since_revision, sightcell_range* added,
                                        size_t added_capacity, size_t* added_count, sightcell_range* removed,
                                        size_t removed_capacity, size_t* removed_count) {
  if (view == nullptr || added_count == nullptr || removed_count == nullptr ||
      (added == nullptr && added_capacity > 0) || (removed == nullptr && removed_capacity > 0)) {
    return SIGHTCELL_ERR_ARGUMENT;
  }
  *added_count = 0;
  *removed_count = 0;
  if (since_revision == view->revision()) return SIGHTCELL_OK;
  std::span<const format::run> before;
  if (since_revision != view->revision() - 1 || !view->previous_runs(before)) return SIGHTCELL_ERR_STALE;
  const runtime::range_borders borders = view->db().range_borders();
  const sightcell_status room_added =
      runtime::check_room(added, added_capacity, runtime::count_difference(view->runs(), before, borders), added_count);
  const sightcell_status room_removed = runtime::check_room(
      removed, removed_capacity, runtime::count_difference(before, view->runs(), borders), removed_count);
  if (room_added != SIGHTCELL_OK || room_removed != SIGHTCELL_OK) return SIGHTCELL_ERR_CAPACITY;
  runtime::write_difference(view->runs(), before, borders, added);
  runtime::write_difference(before, view->runs(), borders, removed);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_statistics(const sightcell_view* view, sightcell_view_stats* out) {
  if (view == nullptr || out == nullptr || out->struct_size < sizeof *out) return SIGHTCELL_ERR_ARGUMENT;
  *out = view->statistics();
  out->struct_size = sizeof *out;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_debug_lines(const sightcell_view* view, uint32_t kinds, sightcell_debug_line* dst,
                                            size_t capacity, size_t* count) {
  if (view == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  std::uint64_t need = 0;
  if (const sightcell_status s = runtime::count_debug_lines(*view, kinds, need); s != SIGHTCELL_OK) return s;
  const sightcell_status room = runtime::check_room(dst, capacity, need, count);
  return room == SIGHTCELL_OK ? runtime::write_debug_lines(*view, kinds, {dst, *count}) : room;
}

sightcell_status sightcell_cluster_map_create(const sightcell_db* db, const uint32_t* cluster_of_source,
                                              size_t polygon_count, uint32_t cluster_count,
                                              sightcell_cluster_map** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  if (db == nullptr || (cluster_of_source == nullptr && polygon_count > 0)) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  return sightcell_cluster_map::create(*db, {cluster_of_source, polygon_count}, cluster_count, out);
}

sightcell_status sightcell_cluster_map_of_file(const sightcell_db* db, sightcell_cluster_map** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  if (db->file().cluster_count() == 0) return SIGHTCELL_ERR_ABSENT;
  return sightcell_cluster_map::create_of_file(*db, out);
}

uint32_t sightcell_db_cluster_count(const sightcell_db* db) {
  return db == nullptr || !db->is_open() ? 0 : db->file().cluster_count();
}

sightcell_status sightcell_db_clusters(const sightcell_db* db, sightcell_range* dst, size_t capacity, size_t* count) {
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  const std::uint32_t clusters = db->file().cluster_count();
  const sightcell_status room = runtime::check_room(dst, capacity, clusters, count);
  if (room == SIGHTCELL_OK && clusters > 0) runtime::list_file_clusters(*db, dst);
  return room;
}

void sightcell_cluster_map_destroy(sightcell_cluster_map* map) {
  sightcell_cluster_map::destroy(map);
}

sightcell_status sightcell_view_clusters(const sightcell_view* view, const sightcell_cluster_map* map, uint32_t* bits,
                                         size_t words) {
  if (view == nullptr || map == nullptr || (bits == nullptr && words > 0) || &map->db() != &view->db()) {
    return SIGHTCELL_ERR_ARGUMENT;
  }
  if (words < map->words()) return SIGHTCELL_ERR_CAPACITY;
  std::fill_n(bits, words, 0u);
  map->mark(view->runs(), {bits, words});
  return SIGHTCELL_OK;
}

sightcell_status sightcell_cluster_list(const uint32_t* bits, size_t words, uint32_t* dst, size_t capacity,
                                        size_t* count) {
  if (bits == nullptr && words > 0) return SIGHTCELL_ERR_ARGUMENT;
  const std::span row(bits, words);
  const sightcell_status room = runtime::check_room(dst, capacity, runtime::list_clusters(row, {}), count);
  if (room == SIGHTCELL_OK) runtime::list_clusters(row, {dst, capacity});
  return room;
}

sightcell_status sightcell_cluster_changes(const uint32_t* before, const uint32_t* now, size_t words,
                                           sightcell_cluster_word* dst, size_t capacity, size_t* count) {
  if ((before == nullptr || now == nullptr) && words > 0) return SIGHTCELL_ERR_ARGUMENT;
  const std::span old_row(before, words);
  const std::span new_row(now, words);
  const sightcell_status room = runtime::check_room(dst, capacity, runtime::list_changes(old_row, new_row, {}), count);
  if (room == SIGHTCELL_OK) runtime::list_changes(old_row, new_row, {dst, capacity});
  return room;
}
