#pragma once
// C++20 wrapper over sightcell.h, casters.h, clusters.h, identity.h, lights.h, residency.h and viewpoints.h, header
// only. The conventions of sightcell.h (coordinates, units, polygon numbers, the draw table, fail-open frames, memory,
// threads) hold here too. Most members call the C function of the same name, where its parameters, failures and cost
// are documented. What the wrapper adds:
//   - db and view are move-only and release their handles.
//   - A function that makes something returns result<T>: the value, or the status of the failure.
//   - A function that fills a list takes a span and returns a list_result.
// It throws no exceptions and allocates nothing of its own. An object without a handle (default-constructed) returns
// SIGHTCELL_ERR_ARGUMENT, counts of 0, and true for box_visible.
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "sightcell/casters.h"
#include "sightcell/clusters.h"
#include "sightcell/identity.h"
#include "sightcell/lights.h"
#include "sightcell/residency.h"
#include "sightcell/sightcell.h"
#include "sightcell/viewpoints.h"

namespace sightcell {

// A value, or the status of the failure.
template <class T>
class [[nodiscard]] result {
 public:
  result(T value) noexcept : value_(std::move(value)) {}          // NOLINT(google-explicit-constructor)
  result(sightcell_status failure) noexcept : status_(failure) {  // NOLINT(google-explicit-constructor)
    assert(failure != SIGHTCELL_OK);
  }

  // True on success.
  explicit operator bool() const noexcept { return status_ == SIGHTCELL_OK; }

  [[nodiscard]] sightcell_status status() const noexcept { return status_; }

  // One English line for the status, never null.
  [[nodiscard]] const char* text() const noexcept { return sightcell_status_text(status_); }

  // The value. Valid only after success; after a failure it is default-constructed.
  [[nodiscard]] T& operator*() noexcept { return value_; }
  [[nodiscard]] const T& operator*() const noexcept { return value_; }
  T* operator->() noexcept { return &value_; }
  const T* operator->() const noexcept { return &value_; }

 private:
  T value_{};
  sightcell_status status_ = SIGHTCELL_OK;
};

// A box in meters of world space: min <= p < max on each axis.
struct cell_bounds {
  std::array<float, 3> min{};
  std::array<float, 3> max{};
};

// How much of a cell the bound of the file is about: see sightcell_db_cell_viewpoints.
struct cell_viewpoints {
  float valid_share = 1.0f;
  float outside_share = 0.0f;
};

// Result of a function that fills a list.
struct [[nodiscard]] list_result {
  sightcell_status status = SIGHTCELL_OK;
  std::size_t count = 0;  // elements that there are; after ERR_CAPACITY nothing was written
  explicit operator bool() const noexcept { return status == SIGHTCELL_OK; }
};

// Result of view::changes.
struct [[nodiscard]] changes_result {
  sightcell_status status = SIGHTCELL_OK;
  std::size_t added = 0;    // ranges, as list_result::count
  std::size_t removed = 0;  // ranges
  explicit operator bool() const noexcept { return status == SIGHTCELL_OK; }
};

// An open file. Any number of threads may use one db at a time.
class db {
 public:
  db() noexcept = default;
  ~db() { sightcell_db_close(handle_); }
  db(db&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  db& operator=(db&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  db(const db&) = delete;
  db& operator=(const db&) = delete;

  // Opens a file that is in memory. The db refers to bytes: the caller keeps them for as long as the db exists.
  static result<db> open(std::span<const std::byte> bytes, const sightcell_allocator* mem = nullptr) noexcept {
    db file;
    const sightcell_status s = sightcell_db_open(bytes.data(), bytes.size(), mem, &file.handle_);
    return s == SIGHTCELL_OK ? result<db>(std::move(file)) : result<db>(s);
  }

  // Opens a file on disk. path: UTF-8.
  static result<db> open_file(const char* path, const sightcell_allocator* mem = nullptr) noexcept {
    db file;
    const sightcell_status s = sightcell_db_open_file(path, mem, &file.handle_);
    return s == SIGHTCELL_OK ? result<db>(std::move(file)) : result<db>(s);
  }

  // Opens a paged file, of which at most resident_bytes of sets are in memory.
  // keep: receives the C handle before the first request, so that source.request can deliver to it.
  static result<db> open_source(const sightcell_source& source, std::uint64_t resident_bytes, sightcell_db*& keep,
                                const sightcell_allocator* mem = nullptr) noexcept {
    const sightcell_status s = sightcell_db_open_source(&source, mem, resident_bytes, &keep);
    if (s != SIGHTCELL_OK) return result<db>(s);
    db file;
    file.handle_ = keep;
    return result<db>(std::move(file));
  }

  // Begins to open a paged file; bytes may be delivered at any time. Then opened() continues: PENDING, OK or a failure.
  static result<db> begin_source(const sightcell_source& source, std::uint64_t resident_bytes, sightcell_db*& keep,
                                 const sightcell_allocator* mem = nullptr) noexcept {
    const sightcell_status s = sightcell_db_begin_source(&source, mem, resident_bytes, &keep);
    if (s != SIGHTCELL_OK && s != SIGHTCELL_PENDING) return result<db>(s);
    db file;
    file.handle_ = keep;
    return result<db>(std::move(file));
  }
  sightcell_status opened() noexcept { return sightcell_db_opened(handle_); }

  // OK, or OTHER_SCENE if the file was not baked from the scene with this fingerprint.
  [[nodiscard]] sightcell_status same_scene(std::span<const std::uint8_t, 16> scene_fingerprint) const noexcept {
    return sightcell_db_same_scene(handle_, scene_fingerprint.data());
  }

  // Delivers the bytes of a request. Any thread. An empty span without data reports that they could not be read.
  sightcell_status deliver(std::uint32_t ticket, std::span<const std::byte> bytes) noexcept {
    return sightcell_db_deliver(handle_, ticket, bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  }

  // Requests what a camera at eye (meters) with velocity (meters per second) may need within the seconds ahead.
  sightcell_status prefetch(std::span<const float, 3> eye, std::span<const float, 3> velocity, float seconds) noexcept {
    return sightcell_db_prefetch(handle_, eye.data(), velocity.data(), seconds);
  }

  // Counts of the file. Cells, volumes and named groups are numbered 0 .. count - 1.
  [[nodiscard]] std::uint32_t polygon_count() const noexcept { return sightcell_db_polygon_count(handle_); }
  [[nodiscard]] std::uint32_t volume_count() const noexcept { return sightcell_db_volume_count(handle_); }
  [[nodiscard]] std::uint32_t cell_count() const noexcept { return sightcell_db_cell_count(handle_); }
  [[nodiscard]] std::uint32_t named_group_count() const noexcept { return sightcell_db_named_group_count(handle_); }

  // The box of a cell, without the margin.
  [[nodiscard]] result<cell_bounds> cell_box(std::uint32_t cell) const noexcept {
    cell_bounds box;
    const sightcell_status s = sightcell_db_cell_box(handle_, cell, box.min.data(), box.max.data());
    return s == SIGHTCELL_OK ? result<cell_bounds>(box) : result<cell_bounds>(s);
  }

  // How much of a cell the bound of the file is about.
  [[nodiscard]] result<cell_viewpoints> viewpoints_of_cell(std::uint32_t cell) const noexcept {
    cell_viewpoints out;
    const sightcell_status s = sightcell_db_cell_viewpoints(handle_, cell, &out.valid_share, &out.outside_share);
    return s == SIGHTCELL_OK ? result<cell_viewpoints>(out) : result<cell_viewpoints>(s);
  }

  // A valid viewpoint of a cell, in meters. number: 0 for the first one.
  [[nodiscard]] result<std::array<float, 3>> cell_eye(std::uint32_t cell, std::uint32_t number = 0) const noexcept {
    std::array<float, 3> eye{};
    const sightcell_status s = sightcell_db_cell_eye(handle_, cell, number, eye.data());
    return s == SIGHTCELL_OK ? result<std::array<float, 3>>(eye) : result<std::array<float, 3>>(s);
  }

  // The upper bound of the miss probability of each cell.
  list_result error_bounds(std::span<float> dst) const noexcept {
    list_result out;
    out.status = sightcell_db_error_bounds(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }

  // The draw of the file for each draw of a host. hashes: geometry hashes. names: of their nodes, or none at all; NULL
  // for one without a name. draw_of_host: as many elements as hashes. The counts are complete with OK and OTHER_SCENE.
  sightcell_status match(std::span<const std::uint64_t> hashes, std::span<const char* const> names,
                         std::span<std::uint32_t> draw_of_host, sightcell_draw_match& counts) const noexcept {
    if (draw_of_host.size() != hashes.size() || (!names.empty() && names.size() != hashes.size())) {
      return SIGHTCELL_ERR_ARGUMENT;
    }
    counts.struct_size = sizeof(counts);
    return sightcell_db_match(handle_, hashes.data(), names.empty() ? nullptr : names.data(), hashes.size(),
                              draw_of_host.data(), &counts);
  }

  // The geometry hash of a draw.
  [[nodiscard]] result<std::uint64_t> draw_hash(std::uint32_t draw) const noexcept {
    std::uint64_t hash = 0;
    const sightcell_status s = sightcell_db_draw_hash(handle_, draw, &hash);
    return s == SIGHTCELL_OK ? result<std::uint64_t>(hash) : result<std::uint64_t>(s);
  }

  // A name of a draw. kind: SIGHTCELL_NAME_*. dst: UTF-8 bytes, without a zero at the end.
  list_result draw_name(std::uint32_t draw, std::uint32_t kind, std::span<char> dst) const noexcept {
    list_result out;
    out.status = sightcell_db_draw_name(handle_, draw, kind, dst.data(), dst.size(), &out.count);
    return out;
  }

  // The number of a named group, SIGHTCELL_NO_NAMED_GROUP if there is none. name: UTF-8, with a zero at the end.
  [[nodiscard]] std::uint32_t find_named_group(const char* name) const noexcept {
    std::uint32_t group = SIGHTCELL_NO_NAMED_GROUP;
    static_cast<void>(sightcell_db_find_named_group(handle_, name, &group));
    return group;
  }

  // The name of a named group. dst: UTF-8 bytes, without a zero at the end.
  list_result named_group_name(std::uint32_t group, std::span<char> dst) const noexcept {
    list_result out;
    out.status = sightcell_db_named_group_name(handle_, group, dst.data(), dst.size(), &out.count);
    return out;
  }

  // The named group of each draw, or SIGHTCELL_NO_NAMED_GROUP.
  list_result named_groups_of_draws(std::span<std::uint32_t> dst) const noexcept {
    list_result out;
    out.status = sightcell_db_named_groups_of_draws(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }

  // Facts about the file, such as range_bound and the largest error bound.
  [[nodiscard]] result<sightcell_info> info() const noexcept {
    sightcell_info info{};
    info.struct_size = sizeof(info);
    const sightcell_status s = sightcell_db_info(handle_, &info);
    return s == SIGHTCELL_OK ? result<sightcell_info>(info) : result<sightcell_info>(s);
  }

  // Memory and paging so far.
  [[nodiscard]] sightcell_db_stats statistics() const noexcept {
    sightcell_db_stats stats{};
    stats.struct_size = sizeof(stats);
    static_cast<void>(sightcell_db_statistics(handle_, &stats));
    return stats;
  }

  // Checks the whole file: for tools. Allocates while it runs.
  [[nodiscard]] sightcell_status check() const noexcept { return sightcell_db_check(handle_); }

  // The draw table, which is not in source order.
  list_result draws(std::span<sightcell_draw> dst) const noexcept {
    list_result out;
    out.status = sightcell_db_draws(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }

  // The source id of each stored polygon: index buffers are permuted by it once.
  list_result order(std::span<std::uint32_t> source_id_of_stored) const noexcept {
    list_result out;
    out.status = sightcell_db_order(handle_, source_id_of_stored.data(), source_id_of_stored.size(), &out.count);
    return out;
  }

  // The C handle, null without one.
  [[nodiscard]] const sightcell_db* get() const noexcept { return handle_; }

 private:
  sightcell_db* handle_ = nullptr;
};

// The shadow casters of a db, which must outlive them. Used by one thread at a time.
class casters {
 public:
  casters() noexcept = default;
  ~casters() { sightcell_casters_destroy(handle_); }
  casters(casters&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  casters& operator=(casters&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  casters(const casters&) = delete;
  casters& operator=(const casters&) = delete;

  static result<casters> create(const db& file) noexcept {
    casters made;
    const sightcell_status s = sightcell_casters_create(file.get(), &made.handle_);
    return s == SIGHTCELL_OK ? result<casters>(std::move(made)) : result<casters>(s);
  }

  // The suns of the file.
  list_result suns(std::span<sightcell_sun> dst) const noexcept {
    list_result out;
    out.status = sightcell_casters_suns(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }

  // The C handle, null without one.
  [[nodiscard]] sightcell_casters* get() noexcept { return handle_; }

 private:
  sightcell_casters* handle_ = nullptr;
};

// The lights of a db, which must outlive them. Used by one thread at a time.
class lights {
 public:
  lights() noexcept = default;
  ~lights() { sightcell_lights_destroy(handle_); }
  lights(lights&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  lights& operator=(lights&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  lights(const lights&) = delete;
  lights& operator=(const lights&) = delete;

  static result<lights> create(const db& file) noexcept {
    lights made;
    const sightcell_status s = sightcell_lights_create(file.get(), &made.handle_);
    return s == SIGHTCELL_OK ? result<lights>(std::move(made)) : result<lights>(s);
  }

  // The lights of the file.
  list_result list(std::span<sightcell_light> dst) const noexcept {
    list_result out;
    out.status = sightcell_lights_list(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }

  // The C handle, null without one.
  [[nodiscard]] sightcell_lights* get() noexcept { return handle_; }
  [[nodiscard]] const sightcell_lights* get() const noexcept { return handle_; }

 private:
  sightcell_lights* handle_ = nullptr;
};

// The texture residency of a db, which must outlive it. Used by one thread at a time.
class residency {
 public:
  residency() noexcept = default;
  ~residency() { sightcell_residency_destroy(handle_); }
  residency(residency&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  residency& operator=(residency&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  residency(const residency&) = delete;
  residency& operator=(const residency&) = delete;

  static result<residency> create(const db& file) noexcept {
    residency made;
    const sightcell_status s = sightcell_residency_create(file.get(), &made.handle_);
    return s == SIGHTCELL_OK ? result<residency>(std::move(made)) : result<residency>(s);
  }

  // The textures of the file.
  list_result textures(std::span<sightcell_texture> dst) const noexcept {
    list_result out;
    out.status = sightcell_residency_textures(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }

  // The finest level of each texture that a picture from a cell can need.
  list_result levels(std::uint32_t cell, float pixels_per_radian, std::span<std::uint8_t> by_texture) noexcept {
    list_result out;
    out.status = sightcell_residency_cell_levels(handle_, cell, pixels_per_radian, by_texture.data(), by_texture.size(),
                                                 &out.count);
    return out;
  }

  // The C handle, null without one.
  [[nodiscard]] sightcell_residency* get() noexcept { return handle_; }

 private:
  sightcell_residency* handle_ = nullptr;
};

// The host's clusters in the polygon order of a db, which must outlive it. Shared by threads.
class cluster_map {
 public:
  cluster_map() noexcept = default;
  ~cluster_map() { sightcell_cluster_map_destroy(handle_); }
  cluster_map(cluster_map&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  cluster_map& operator=(cluster_map&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  cluster_map(const cluster_map&) = delete;
  cluster_map& operator=(const cluster_map&) = delete;

  // cluster_of_source: the cluster of each polygon of the db by source id, or SIGHTCELL_NO_CLUSTER.
  static result<cluster_map> create(const db& file, std::span<const std::uint32_t> cluster_of_source,
                                    std::uint32_t cluster_count) noexcept {
    cluster_map map;
    const sightcell_status s = sightcell_cluster_map_create(file.get(), cluster_of_source.data(),
                                                            cluster_of_source.size(), cluster_count, &map.handle_);
    return s == SIGHTCELL_OK ? result<cluster_map>(std::move(map)) : result<cluster_map>(s);
  }

  // Bit c of a row is cluster c of the file. ABSENT: its sets are of polygons.
  static result<cluster_map> of_file(const db& file) noexcept {
    cluster_map map;
    const sightcell_status s = sightcell_cluster_map_of_file(file.get(), &map.handle_);
    return s == SIGHTCELL_OK ? result<cluster_map>(std::move(map)) : result<cluster_map>(s);
  }

  // The clusters of a row whose bits are 1, ascending.
  static list_result list(std::span<const std::uint32_t> row, std::span<std::uint32_t> dst) noexcept {
    list_result out;
    out.status = sightcell_cluster_list(row.data(), row.size(), dst.data(), dst.size(), &out.count);
    return out;
  }

  // The words in which two rows of equal size differ.
  static list_result changes(std::span<const std::uint32_t> before, std::span<const std::uint32_t> now,
                             std::span<sightcell_cluster_word> dst) noexcept {
    list_result out;
    if (before.size() != now.size()) return {SIGHTCELL_ERR_ARGUMENT, 0};
    out.status = sightcell_cluster_changes(before.data(), now.data(), now.size(), dst.data(), dst.size(), &out.count);
    return out;
  }

  // The C handle, null without one.
  [[nodiscard]] const sightcell_cluster_map* get() const noexcept { return handle_; }

 private:
  sightcell_cluster_map* handle_ = nullptr;
};

// A camera in the scene of a db, which must outlive it. One thread at a time.
class view {
 public:
  view() noexcept = default;
  ~view() { sightcell_view_destroy(handle_); }
  view(view&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  view& operator=(view&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  view(const view&) = delete;
  view& operator=(const view&) = delete;

  // Creates a view. All memory that it will ever need is allocated here.
  static result<view> create(const db& file) noexcept {
    view camera;
    const sightcell_status s = sightcell_view_create(file.get(), &camera.handle_);
    return s == SIGHTCELL_OK ? result<view>(std::move(camera)) : result<view>(s);
  }

  // Moves the camera. frame is filled also when the status is ARGUMENT (a NaN): it has DRAW_ALL then.
  sightcell_status move(std::span<const float, 3> eye, sightcell_frame& frame) noexcept {
    return sightcell_view_move(handle_, eye.data(), &frame);
  }

  // Moves the camera to an unknown position in a box, whose corners belong to it. frame: as move.
  sightcell_status move_box(std::span<const float, 3> min, std::span<const float, 3> max,
                            sightcell_frame& frame) noexcept {
    return sightcell_view_move_box(handle_, min.data(), max.data(), &frame);
  }

  // What later moves show outside all cells and while the data of a cell has not arrived: SIGHTCELL_OUTSIDE_*, plus
  // SIGHTCELL_PENDING_LAST or not; the set of another cell up to max_distance meters from its box.
  sightcell_status policy(std::uint32_t outside, float max_distance) noexcept {
    return sightcell_view_policy(handle_, outside, max_distance);
  }

  // The point that positions of later calls are relative to, in meters of world space.
  sightcell_status origin(std::span<const double, 3> origin) noexcept {
    return sightcell_view_origin(handle_, origin.data());
  }

  // Shows or hides a named group from the next move on.
  sightcell_status show_named_group(std::uint32_t group, bool shown) noexcept {
    return sightcell_view_show_named_group(handle_, group, shown ? 1 : 0);
  }

  // One bit per draw: 1 if it has a polygon to draw.
  sightcell_status objects(std::span<std::uint64_t> bits_by_draw) const noexcept {
    return sightcell_view_objects(handle_, bits_by_draw.data(), bits_by_draw.size());
  }

  // The polygons to draw into the shadow map of a sun, as ranges, and as indices in stored order.
  list_result shadow_ranges(casters& of, std::uint32_t sun, std::span<sightcell_range> dst) const noexcept {
    list_result out;
    out.status = sightcell_view_casters(handle_, of.get(), sun, dst.data(), dst.size(), &out.count);
    return out;
  }
  list_result shadow_indices(casters& of, std::uint32_t sun, std::span<const std::uint32_t> stored_indices,
                             std::span<std::uint32_t> dst) const noexcept {
    list_result out;
    out.status = sightcell_view_caster_indices(handle_, of.get(), sun, stored_indices.data(), dst.data(), dst.size(),
                                               &out.count);
    return out;
  }

  // The numbers of the lights that touch what is visible from here.
  list_result lights_here(const lights& of, std::span<std::uint32_t> dst) const noexcept {
    list_result out;
    out.status = sightcell_view_lights(handle_, of.get(), dst.data(), dst.size(), &out.count);
    return out;
  }
  // The polygons that a light reaches, as ranges, and as indices in stored order.
  list_result lit_ranges(lights& of, std::uint32_t light, std::span<sightcell_range> dst) const noexcept {
    list_result out;
    out.status = sightcell_view_light_ranges(handle_, of.get(), light, dst.data(), dst.size(), &out.count);
    return out;
  }
  list_result lit_indices(lights& of, std::uint32_t light, std::span<const std::uint32_t> stored_indices,
                          std::span<std::uint32_t> dst) const noexcept {
    list_result out;
    out.status = sightcell_view_light_indices(handle_, of.get(), light, stored_indices.data(), dst.data(), dst.size(),
                                              &out.count);
    return out;
  }

  // The finest level of each texture that a picture from here can need.
  list_result texture_levels(residency& of, float pixels_per_radian,
                             std::span<std::uint8_t> by_texture) const noexcept {
    list_result out;
    out.status = sightcell_view_texture_levels(handle_, of.get(), pixels_per_radian, by_texture.data(),
                                               by_texture.size(), &out.count);
    return out;
  }

  // One bit per cluster of the host: 1 if it has a polygon to draw. row: (clusters + 31) / 32 words or more.
  sightcell_status clusters(const cluster_map& map, std::span<std::uint32_t> row) const noexcept {
    return sightcell_view_clusters(handle_, map.get(), row.data(), row.size());
  }

  // Visible solid angle of each draw, or draw group of a merged file, in steradians.
  list_result importance(std::span<float> by_draw) const noexcept {
    list_result out;
    out.status = sightcell_view_importance(handle_, by_draw.data(), by_draw.size(), &out.count);
    return out;
  }

  // False if nothing in a box can be visible. True in all other cases, also for a NaN or if min is above max.
  [[nodiscard]] bool box_visible(std::span<const float, 3> min, std::span<const float, 3> max) const noexcept {
    std::uint32_t visible = 1;
    static_cast<void>(sightcell_view_box_visible(handle_, min.data(), max.data(), &visible));
    return visible != 0;
  }

  // Counts since the view was created.
  [[nodiscard]] sightcell_view_stats statistics() const noexcept {
    sightcell_view_stats stats{};
    stats.struct_size = sizeof(stats);
    static_cast<void>(sightcell_view_statistics(handle_, &stats));
    return stats;
  }

  // Source ids of the polygons to draw.
  list_result polygons(std::span<std::uint32_t> source_ids) const noexcept {
    list_result out;
    out.status = sightcell_view_polygons(handle_, source_ids.data(), source_ids.size(), &out.count);
    return out;
  }

  // The polygons to draw as draw ranges: at most sightcell_info.range_bound.
  list_result ranges(std::span<sightcell_range> dst) const noexcept {
    list_result out;
    out.status = sightcell_view_ranges(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }

  // The indices of the polygons to draw. stored_indices: 3 per stored polygon of the db, all of them.
  list_result indices(std::span<const std::uint32_t> stored_indices, std::span<std::uint32_t> dst) const noexcept {
    list_result out;
    out.status = sightcell_view_indices(handle_, stored_indices.data(), dst.data(), dst.size(), &out.count);
    return out;
  }

  // The polygons to draw as indirect draws, without space between them. min_gap: see sightcell_view_commands.
  list_result commands(std::uint32_t min_gap, std::span<sightcell_command> dst) const noexcept {
    list_result out;
    out.status =
        sightcell_view_commands(handle_, min_gap, dst.data(), sizeof(sightcell_command), dst.size(), &out.count);
    return out;
  }

  // The ranges that were added and removed since a revision: the current one or the one before.
  changes_result changes(std::uint32_t since_revision, std::span<sightcell_range> added,
                         std::span<sightcell_range> removed) const noexcept {
    changes_result out;
    out.status = sightcell_view_changes(handle_, since_revision, added.data(), added.size(), &out.added, removed.data(),
                                        removed.size(), &out.removed);
    return out;
  }

  // The C handle, null without one.
  [[nodiscard]] const sightcell_view* get() const noexcept { return handle_; }

 private:
  sightcell_view* handle_ = nullptr;
};

}  // namespace sightcell
