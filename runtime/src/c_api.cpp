// The C functions of files: each checks its arguments and calls the implementation. Statuses of format have the same
// numbers.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "db.h"
#include "draw_match.h"
#include "embedded_pvs.h"
#include "file_input.h"
#include "list_output.h"
#include "memory.h"
#include "misses_text.h"
#include "prefetch.h"
#include "ranges.h"
#include "sightcell/format/eye_table.h"
#include "sightcell/format/geometry_hash.h"
#include "sightcell/format/identity_table.h"
#include "sightcell/identity.h"
#include "sightcell/sightcell.h"
#include "sightcell/viewpoints.h"
#include "view.h"

namespace format = sightcell::format;
namespace runtime = sightcell::runtime;

static_assert(sizeof(sightcell_draw) == 48);
static_assert(sizeof(sightcell_info) == 60 && offsetof(sightcell_info, player_radius) == 56);
static_assert(static_cast<int>(format::status::limit) == SIGHTCELL_ERR_LIMIT &&
              static_cast<int>(format::status::other_scene) == SIGHTCELL_ERR_OTHER_SCENE &&
              static_cast<int>(format::status::stale) == SIGHTCELL_ERR_STALE &&
              static_cast<int>(format::status::absent) == SIGHTCELL_ERR_ABSENT &&
              static_cast<int>(format::status::pending) == SIGHTCELL_PENDING &&
              format::no_named_group == SIGHTCELL_NO_NAMED_GROUP);

namespace {

// The size of sightcell_info before player_radius was added.
constexpr std::uint32_t first_info_size = offsetof(sightcell_info, player_radius);

void write_box(const format::box& bounds, float min[3], float max[3]) noexcept {
  std::copy_n(bounds.min.data(), 3, min);
  std::copy_n(bounds.max.data(), 3, max);
}

bool take_allocator(const sightcell_allocator* given, sightcell_allocator& out) noexcept {
  out = given == nullptr ? runtime::default_allocator() : *given;
  return out.alloc != nullptr && out.release != nullptr;
}

// Of a .glb, keeps the .pvs file in it alone. On failure the block is as it was.
sightcell_status keep_embedded_pvs(const sightcell_allocator& mem, runtime::file_block& file) noexcept {
  std::span<const std::byte> part;
  const sightcell_status s = runtime::find_embedded_pvs(
      {static_cast<const std::byte*>(file.bytes), static_cast<std::size_t>(file.size)}, part);
  if (s != SIGHTCELL_OK || part.size() == file.size) return s;
  const runtime::file_block alone{runtime::allocate(mem, part.size()), part.size()};
  if (alone.bytes == nullptr) return SIGHTCELL_ERR_MEMORY;
  std::memcpy(alone.bytes, part.data(), part.size());
  runtime::release(mem, file.bytes, file.size);
  file = alone;
  return SIGHTCELL_OK;
}

// Opens the draw identity of a file.
sightcell_status open_identity(const sightcell_db& db, format::identity_table& out) noexcept {
  if (!db.is_open()) return SIGHTCELL_PENDING;
  return static_cast<sightcell_status>(format::identity_table::open(db.file(), out));
}

}  // namespace

std::uint32_t sightcell_version(void) {
  return SIGHTCELL_API_VERSION;
}

const char* sightcell_status_text(sightcell_status status) {
  return format::status_text(static_cast<format::status>(status));
}

sightcell_status sightcell_db_open(const void* bytes, size_t size, const sightcell_allocator* mem, sightcell_db** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  sightcell_allocator allocator;
  if ((bytes == nullptr && size > 0) || !take_allocator(mem, allocator)) return SIGHTCELL_ERR_ARGUMENT;
  std::span<const std::byte> file;
  if (const sightcell_status s = runtime::find_embedded_pvs({static_cast<const std::byte*>(bytes), size}, file);
      s != SIGHTCELL_OK)
    return s;
  return sightcell_db::open(file, allocator, nullptr, out);
}

sightcell_status sightcell_db_open_file(const char* path, const sightcell_allocator* mem, sightcell_db** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  sightcell_allocator allocator;
  if (path == nullptr || !take_allocator(mem, allocator)) return SIGHTCELL_ERR_ARGUMENT;
  runtime::file_block file;
  sightcell_status s = runtime::read_file(path, allocator, file);
  if (s != SIGHTCELL_OK) return s;
  s = keep_embedded_pvs(allocator, file);
  const std::span bytes(static_cast<const std::byte*>(file.bytes), static_cast<std::size_t>(file.size));
  if (s == SIGHTCELL_OK) s = sightcell_db::open(bytes, allocator, file.bytes, out);
  if (s != SIGHTCELL_OK) runtime::release(allocator, file.bytes, file.size);
  return s;
}

sightcell_status sightcell_db_begin_source(const sightcell_source* source, const sightcell_allocator* mem,
                                           uint64_t resident_bytes, sightcell_db** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  sightcell_allocator allocator;
  if (source == nullptr || source->request == nullptr || !take_allocator(mem, allocator)) return SIGHTCELL_ERR_ARGUMENT;
  return sightcell_db::begin_source(*source, allocator, resident_bytes, out);
}

sightcell_status sightcell_db_open_source(const sightcell_source* source, const sightcell_allocator* mem,
                                          uint64_t resident_bytes, sightcell_db** out) {
  const sightcell_status s = sightcell_db_begin_source(source, mem, resident_bytes, out);
  if (s != SIGHTCELL_PENDING) return s;
  sightcell_db::close(*out);  // nothing was delivered before the host's request returned
  *out = nullptr;
  return SIGHTCELL_ERR_IO;
}

sightcell_status sightcell_db_opened(sightcell_db* db) {
  return db == nullptr ? SIGHTCELL_ERR_ARGUMENT : db->continue_opening();
}

sightcell_status sightcell_db_same_scene(const sightcell_db* db, const uint8_t scene_fingerprint[16]) {
  if (db == nullptr || scene_fingerprint == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const auto& own = db->file().facts().scene_fingerprint;
  return std::memcmp(own.data(), scene_fingerprint, own.size()) == 0 ? SIGHTCELL_OK : SIGHTCELL_ERR_OTHER_SCENE;
}

sightcell_status sightcell_db_deliver(sightcell_db* db, uint32_t ticket, const void* bytes, uint32_t size) {
  return db == nullptr ? SIGHTCELL_ERR_ARGUMENT : db->deliver(ticket, bytes, size);
}

sightcell_status sightcell_db_prefetch(sightcell_db* db, const float eye[3], const float velocity[3], float seconds) {
  if (db == nullptr || eye == nullptr || velocity == nullptr || !(seconds >= 0.0f) || !std::isfinite(seconds)) {
    return SIGHTCELL_ERR_ARGUMENT;
  }
  runtime::point position{};
  runtime::point speed{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(eye[axis]) || !std::isfinite(velocity[axis])) return SIGHTCELL_ERR_ARGUMENT;
    position[axis] = static_cast<double>(eye[axis]);
    speed[axis] = static_cast<double>(velocity[axis]);
  }
  if (db->is_paged()) runtime::prefetch(*db, position, speed, static_cast<double>(seconds));
  return SIGHTCELL_OK;
}

void sightcell_db_close(sightcell_db* db) {
  sightcell_db::close(db);
}

std::uint32_t sightcell_db_polygon_count(const sightcell_db* db) {
  return db == nullptr ? 0 : db->polygon_count();
}

std::uint32_t sightcell_db_cell_count(const sightcell_db* db) {
  return db == nullptr ? 0 : db->file().cell_count();
}

sightcell_status sightcell_db_cell_box(const sightcell_db* db, uint32_t cell, float min[3], float max[3]) {
  if (db == nullptr || min == nullptr || max == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  format::box bounds;
  const format::status s = db->file().cell_box(cell, bounds);
  if (s != format::status::ok) return static_cast<sightcell_status>(s);
  write_box(bounds, min, max);
  return SIGHTCELL_OK;
}

uint32_t sightcell_db_volume_count(const sightcell_db* db) {
  return db == nullptr ? 0 : db->file().volumes().count();
}

sightcell_status sightcell_db_volume_box(const sightcell_db* db, uint32_t volume, float min[3], float max[3]) {
  if (db == nullptr || min == nullptr || max == nullptr || volume >= db->file().volumes().count()) {
    return SIGHTCELL_ERR_ARGUMENT;
  }
  format::box bounds;
  if (!db->file().volumes().volume_box(volume, bounds)) return SIGHTCELL_ERR_CORRUPT;
  write_box(bounds, min, max);
  return SIGHTCELL_OK;
}

uint32_t sightcell_db_named_group_count(const sightcell_db* db) {
  return db == nullptr ? 0 : db->file().named_groups().count();
}

sightcell_status sightcell_db_named_group_name(const sightcell_db* db, uint32_t group, char* dst, size_t capacity,
                                               size_t* count) {
  if (db == nullptr || group >= db->file().named_groups().count()) return SIGHTCELL_ERR_ARGUMENT;
  std::string_view name;
  if (!db->file().named_groups().name(group, name)) return SIGHTCELL_ERR_CORRUPT;
  const sightcell_status room = runtime::check_room(dst, capacity, name.size(), count);
  if (room == SIGHTCELL_OK) std::copy_n(name.data(), name.size(), dst);
  return room;
}

sightcell_status sightcell_db_find_named_group(const sightcell_db* db, const char* name, uint32_t* group) {
  if (db == nullptr || name == nullptr || group == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *group = SIGHTCELL_NO_NAMED_GROUP;
  const std::string_view wanted(name);
  std::string_view found;
  for (std::uint32_t i = 0; i < db->file().named_groups().count(); ++i) {
    if (!db->file().named_groups().name(i, found)) return SIGHTCELL_ERR_CORRUPT;
    if (found != wanted) continue;
    *group = i;
    break;
  }
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db_named_groups_of_draws(const sightcell_db* db, uint32_t* dst, size_t capacity,
                                                    size_t* count) {
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const sightcell_status room = runtime::check_room(dst, capacity, db->file().draw_count(), count);
  if (room != SIGHTCELL_OK) return room;
  for (std::uint32_t draw = 0; draw < db->file().draw_count(); ++draw) {
    std::uint32_t group = 0;
    if (!db->file().named_groups().of_draw(draw, group)) return SIGHTCELL_ERR_CORRUPT;
    dst[draw] = group;
  }
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db_info(const sightcell_db* db, sightcell_info* out) {
  if (db == nullptr || out == nullptr || out->struct_size < first_info_size) return SIGHTCELL_ERR_ARGUMENT;
  const format::file_facts& facts = db->file().facts();
  sightcell_info info{};
  info.struct_size = out->struct_size < sizeof info ? first_info_size : sizeof info;
  info.format_version = db->file().format_version();
  info.layout = static_cast<std::uint32_t>(facts.layout);
  info.polygon_count = facts.polygon_count;
  info.cell_count = db->file().cell_count();
  info.draw_count = db->file().draw_count();
  info.range_bound = db->range_bound();
  info.margin = facts.margin;
  info.max_pixel_error = facts.max_pixel_error;
  info.confidence = facts.confidence;
  std::memcpy(info.scene_fingerprint, facts.scene_fingerprint.data(), facts.scene_fingerprint.size());
  info.player_radius = db->file().viewpoints().player_radius();
  std::memcpy(out, &info, info.struct_size);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db_cell_viewpoints(const sightcell_db* db, uint32_t cell, float* valid_share,
                                              float* outside_share) {
  if (db == nullptr || valid_share == nullptr || outside_share == nullptr || cell >= db->file().cell_count()) {
    return SIGHTCELL_ERR_ARGUMENT;
  }
  const float valid = db->file().viewpoints().valid_share(cell);
  const float outside = db->file().viewpoints().outside_share(cell);
  // Checked again: the bytes may have changed since open.
  if (!(valid > 0.0f && valid <= 1.0f && outside >= 0.0f && outside <= 1.0f)) return SIGHTCELL_ERR_CORRUPT;
  *valid_share = valid;
  *outside_share = outside;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db_cell_eye(const sightcell_db* db, uint32_t cell, uint32_t number, float eye[3]) {
  if (db == nullptr || eye == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  if (cell >= db->file().cell_count()) return SIGHTCELL_ERR_ARGUMENT;
  format::eye_table eyes;
  format::status s = format::eye_table::open(db->file(), eyes);
  if (s != format::status::ok) return static_cast<sightcell_status>(s);
  if (number >= eyes.count(cell)) return SIGHTCELL_ERR_ABSENT;
  format::eye_steps steps;
  s = eyes.eye(cell, number, steps);
  format::box bounds;
  if (s == format::status::ok) s = db->file().cell_box(cell, bounds);
  if (s != format::status::ok) return SIGHTCELL_ERR_CORRUPT;  // the bytes have changed
  std::copy_n(format::eye_position(bounds, steps).data(), 3, eye);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db_error_bounds(const sightcell_db* db, float* dst, size_t capacity, size_t* count) {
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  const format::reader& file = db->file();
  const sightcell_status room = runtime::check_room(dst, capacity, file.cell_count(), count);
  if (room == SIGHTCELL_ERR_ARGUMENT) return room;
  if (file.certificate_count() == 0 && file.cell_count() > 0) return SIGHTCELL_ERR_ABSENT;
  if (room != SIGHTCELL_OK) return room;
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    format::certificate_record proof;
    if (file.certificate(cell, proof) != format::status::ok) return SIGHTCELL_ERR_CORRUPT;
    auto bound = static_cast<float>(proof.upper_bound);
    // Of version 0 it is a double. The result is never below it. Hosts in C link no library with nextafter.
    if (bound < proof.upper_bound) bound = std::bit_cast<float>(std::bit_cast<std::uint32_t>(bound) + 1);
    dst[cell] = proof.rays == 0 ? 1.0f : bound;
  }
  return SIGHTCELL_OK;
}

sightcell_status sightcell_geometry_hash(const void* positions, size_t stride, size_t vertex_count,
                                         const uint32_t* indices, size_t index_count, uint64_t* hash) {
  if (hash == nullptr || (positions == nullptr && vertex_count > 0) || (indices == nullptr && index_count > 0) ||
      stride < 3 * sizeof(float) || index_count % 3 != 0) {
    return SIGHTCELL_ERR_ARGUMENT;
  }
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < index_count; i += 3) {
    std::array<std::array<float, 3>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      if (indices[i + k] >= vertex_count) return SIGHTCELL_ERR_ARGUMENT;
      std::memcpy(corners[k].data(), static_cast<const std::byte*>(positions) + indices[i + k] * stride,
                  3 * sizeof(float));
    }
    sum += format::triangle_hash(corners);
  }
  *hash = sum;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db_match(const sightcell_db* db, const uint64_t* hashes, const char* const* names,
                                    size_t count, uint32_t* draw_of_host, sightcell_draw_match* match) {
  if (db == nullptr || ((hashes == nullptr || draw_of_host == nullptr) && count > 0) || match == nullptr ||
      match->struct_size < sizeof *match || count >= SIGHTCELL_NO_DRAW) {
    return SIGHTCELL_ERR_ARGUMENT;
  }
  match->struct_size = sizeof *match;
  format::identity_table table;
  if (const sightcell_status s = open_identity(*db, table); s != SIGHTCELL_OK) return s;
  return runtime::match_draws(*db, table, {hashes, count}, names, {draw_of_host, count}, *match);
}

sightcell_status sightcell_db_draw_hash(const sightcell_db* db, uint32_t draw, uint64_t* hash) {
  if (db == nullptr || hash == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  if (draw >= db->file().draw_count()) return SIGHTCELL_ERR_ARGUMENT;
  format::identity_table table;
  if (const sightcell_status s = open_identity(*db, table); s != SIGHTCELL_OK) return s;
  format::draw_record d;
  std::uint32_t place = 0;
  if (db->file().draw(draw, d) != format::status::ok) return SIGHTCELL_ERR_CORRUPT;
  if (const sightcell_status s = runtime::place_in_source(*db, d, place); s != SIGHTCELL_OK) return s;
  *hash = d.polygon_count == 0 ? 0 : table.hash(place);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db_draw_name(const sightcell_db* db, uint32_t draw, uint32_t kind, char* dst,
                                        size_t capacity, size_t* count) {
  if (db == nullptr || kind > SIGHTCELL_NAME_MESH) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  if (draw >= db->file().draw_count()) return SIGHTCELL_ERR_ARGUMENT;
  format::identity_table table;
  if (const sightcell_status s = open_identity(*db, table); s != SIGHTCELL_OK) return s;
  format::draw_record d;
  if (db->file().draw(draw, d) != format::status::ok) return SIGHTCELL_ERR_CORRUPT;
  std::uint32_t left = kind == SIGHTCELL_NAME_NODE ? table.name_of_node(d.node) : table.name_of_mesh(d.mesh);
  format::name_walk walk = table.names();
  std::string_view name;
  for (; left > 0; --left) {
    if (!walk.next()) return SIGHTCELL_ERR_CORRUPT;
    name = walk.name();
  }
  const sightcell_status room = runtime::check_room(dst, capacity, name.size(), count);
  if (room == SIGHTCELL_OK) std::copy_n(name.data(), name.size(), dst);
  return room;
}

sightcell_status sightcell_db_check(const sightcell_db* db) {
  return db == nullptr ? SIGHTCELL_ERR_ARGUMENT : db->check();
}

sightcell_status sightcell_db_draws(const sightcell_db* db, sightcell_draw* dst, size_t capacity, size_t* count) {
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const sightcell_status room = runtime::check_room(dst, capacity, db->file().draw_count(), count);
  if (room != SIGHTCELL_OK) return room;
  const bool merged = db->file().facts().layout == format::host_layout::merged;
  const runtime::range_borders borders = db->range_borders();
  for (std::uint32_t number = 0; number < db->file().draw_count(); ++number) {
    format::draw_record d;
    if (const format::status s = db->file().draw(number, d); s != format::status::ok) {
      return static_cast<sightcell_status>(s);
    }
    const std::size_t unit = merged ? d.group : number;  // read again: the bytes may have changed
    if (unit >= borders.size()) return SIGHTCELL_ERR_CORRUPT;
    dst[number] = {d.node,         d.mesh,          d.primitive,   d.instance,    d.material, d.group,
                   d.first_source, d.polygon_count, borders[unit], d.base_vertex, d.host_tag};
  }
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db_order(const sightcell_db* db, uint32_t* source_id_of_stored, size_t capacity,
                                    size_t* count) {
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const sightcell_status room = runtime::check_room(source_id_of_stored, capacity, db->polygon_count(), count);
  if (room != SIGHTCELL_OK) return room;
  const runtime::range_borders borders = db->range_borders();
  for (std::uint32_t draw = 0; draw + 1 < borders.size(); ++draw) {
    source_id_of_stored = runtime::write_sources(*db, draw, 0, borders[draw + 1] - borders[draw], source_id_of_stored);
  }
  return room;
}

sightcell_status sightcell_db_statistics(const sightcell_db* db, sightcell_db_stats* out) {
  if (db == nullptr || out == nullptr || out->struct_size < sizeof *out) return SIGHTCELL_ERR_ARGUMENT;
  const runtime::cache_counts counts = db->is_paged() ? db->cache().counts() : runtime::cache_counts{};
  *out = {sizeof *out,     db->file().chunk_count(), db->memory_bytes(), counts.resident_bytes,
          counts.requests, counts.delivered_bytes,   counts.evictions,   counts.refused_deliveries};
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db_misses_text(const sightcell_db* db, const sightcell_miss* misses, size_t miss_count,
                                          char* dst, size_t capacity, size_t* count) {
  if (db == nullptr || (misses == nullptr && miss_count > 0)) return SIGHTCELL_ERR_ARGUMENT;
  const std::span all(misses, miss_count);
  for (const sightcell_miss& miss : all) {
    if (!runtime::can_be_written(miss, db->polygon_count())) return SIGHTCELL_ERR_ARGUMENT;
  }
  const auto& scene = db->file().facts().scene_fingerprint;
  const sightcell_status room = runtime::check_room(dst, capacity, runtime::write_misses(scene, all, {}), count);
  if (room != SIGHTCELL_OK) return room;
  static_cast<void>(runtime::write_misses(scene, all, {dst, capacity}));
  return SIGHTCELL_OK;
}
