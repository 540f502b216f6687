#pragma once
// C++20 skin over sightcell.h, header only: db and view close themselves, lists take spans, failures come back as
// values. No exceptions, no allocation of its own. What the functions do, and when they fail, is said in sightcell.h.
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "sightcell/sightcell.h"

namespace sightcell {

// A value, or the status that says why there is none.
template <class T>
class [[nodiscard]] result {
 public:
  result(T value) noexcept : value_(std::move(value)) {}          // NOLINT(google-explicit-constructor)
  result(sightcell_status failure) noexcept : status_(failure) {  // NOLINT(google-explicit-constructor)
    assert(failure != SIGHTCELL_OK);
  }

  explicit operator bool() const noexcept { return status_ == SIGHTCELL_OK; }
  [[nodiscard]] sightcell_status status() const noexcept { return status_; }
  [[nodiscard]] const char* text() const noexcept { return sightcell_status_text(status_); }

  // Only after success.
  [[nodiscard]] T& operator*() noexcept { return value_; }
  [[nodiscard]] const T& operator*() const noexcept { return value_; }
  T* operator->() noexcept { return &value_; }
  const T* operator->() const noexcept { return &value_; }

 private:
  T value_{};
  sightcell_status status_ = SIGHTCELL_OK;
};

struct cell_bounds {
  std::array<float, 3> min{};
  std::array<float, 3> max{};
};

// How a list call ended: how many elements there are, and whether they fitted. After ERR_CAPACITY nothing was written
// and count says how much room to bring.
struct [[nodiscard]] list_result {
  sightcell_status status = SIGHTCELL_OK;
  std::size_t count = 0;
  explicit operator bool() const noexcept { return status == SIGHTCELL_OK; }
};

struct [[nodiscard]] changes_result {
  sightcell_status status = SIGHTCELL_OK;
  std::size_t added = 0;
  std::size_t removed = 0;
  explicit operator bool() const noexcept { return status == SIGHTCELL_OK; }
};

// One file. Move-only; a default-made one is closed and sees nothing. Const functions may run on any number of threads.
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

  // bytes stay the caller's and must outlive the db.
  static result<db> open(std::span<const std::byte> bytes, const sightcell_allocator* mem = nullptr) noexcept {
    db file;
    const sightcell_status s = sightcell_db_open(bytes.data(), bytes.size(), mem, &file.handle_);
    return s == SIGHTCELL_OK ? result<db>(std::move(file)) : result<db>(s);
  }
  static result<db> open_file(const char* path, const sightcell_allocator* mem = nullptr) noexcept {
    db file;
    const sightcell_status s = sightcell_db_open_file(path, mem, &file.handle_);
    return s == SIGHTCELL_OK ? result<db>(std::move(file)) : result<db>(s);
  }

  // Reads the file piece by piece. The source delivers to the C handle that sightcell_db_open_source sets: keep is
  // where, before the first request, that is put for it.
  static result<db> open_source(const sightcell_source& source, std::uint64_t resident_bytes, sightcell_db*& keep,
                                const sightcell_allocator* mem = nullptr) noexcept {
    const sightcell_status s = sightcell_db_open_source(&source, mem, resident_bytes, &keep);
    if (s != SIGHTCELL_OK) return result<db>(s);
    db file;
    file.handle_ = keep;
    return result<db>(std::move(file));
  }
  sightcell_status deliver(std::uint32_t ticket, std::span<const std::byte> bytes) noexcept {
    return sightcell_db_deliver(handle_, ticket, bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  }
  sightcell_status prefetch(std::span<const float, 3> eye, std::span<const float, 3> velocity, float seconds) noexcept {
    return sightcell_db_prefetch(handle_, eye.data(), velocity.data(), seconds);
  }

  [[nodiscard]] std::uint32_t polygon_count() const noexcept { return sightcell_db_polygon_count(handle_); }
  [[nodiscard]] std::uint32_t volume_count() const noexcept { return sightcell_db_volume_count(handle_); }
  [[nodiscard]] std::uint32_t cell_count() const noexcept { return sightcell_db_cell_count(handle_); }
  [[nodiscard]] result<cell_bounds> cell_box(std::uint32_t cell) const noexcept {
    cell_bounds box;
    const sightcell_status s = sightcell_db_cell_box(handle_, cell, box.min.data(), box.max.data());
    return s == SIGHTCELL_OK ? result<cell_bounds>(box) : result<cell_bounds>(s);
  }
  [[nodiscard]] std::uint32_t named_group_count() const noexcept { return sightcell_db_named_group_count(handle_); }
  // name: with a zero at the end. SIGHTCELL_NO_NAMED_GROUP where there is none.
  [[nodiscard]] std::uint32_t find_named_group(const char* name) const noexcept {
    std::uint32_t group = SIGHTCELL_NO_NAMED_GROUP;
    static_cast<void>(sightcell_db_find_named_group(handle_, name, &group));
    return group;
  }
  list_result named_group_name(std::uint32_t group, std::span<char> dst) const noexcept {
    list_result out;
    out.status = sightcell_db_named_group_name(handle_, group, dst.data(), dst.size(), &out.count);
    return out;
  }
  list_result named_groups_of_draws(std::span<std::uint32_t> dst) const noexcept {
    list_result out;
    out.status = sightcell_db_named_groups_of_draws(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }
  [[nodiscard]] result<sightcell_info> info() const noexcept {
    sightcell_info info{};
    info.struct_size = sizeof(info);
    const sightcell_status s = sightcell_db_info(handle_, &info);
    return s == SIGHTCELL_OK ? result<sightcell_info>(info) : result<sightcell_info>(s);
  }
  [[nodiscard]] sightcell_db_stats statistics() const noexcept {
    sightcell_db_stats stats{};
    stats.struct_size = sizeof(stats);
    static_cast<void>(sightcell_db_statistics(handle_, &stats));
    return stats;
  }
  [[nodiscard]] sightcell_status check() const noexcept { return sightcell_db_check(handle_); }
  list_result draws(std::span<sightcell_draw> dst) const noexcept {
    list_result out;
    out.status = sightcell_db_draws(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }
  list_result order(std::span<std::uint32_t> source_id_of_stored) const noexcept {
    list_result out;
    out.status = sightcell_db_order(handle_, source_id_of_stored.data(), source_id_of_stored.size(), &out.count);
    return out;
  }

  [[nodiscard]] const sightcell_db* get() const noexcept { return handle_; }

 private:
  sightcell_db* handle_ = nullptr;
};

// One camera of one db. Move-only; the db must outlive it. One thread at a time.
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

  static result<view> create(const db& file) noexcept {
    view camera;
    const sightcell_status s = sightcell_view_create(file.get(), &camera.handle_);
    return s == SIGHTCELL_OK ? result<view>(std::move(camera)) : result<view>(s);
  }

  // frame is filled even when the status is ARGUMENT (a NaN): it says DRAW_ALL then.
  sightcell_status move(std::span<const float, 3> eye, sightcell_frame& frame) noexcept {
    return sightcell_view_move(handle_, eye.data(), &frame);
  }

  // Likewise.
  sightcell_status move_box(std::span<const float, 3> min, std::span<const float, 3> max,
                            sightcell_frame& frame) noexcept {
    return sightcell_view_move_box(handle_, min.data(), max.data(), &frame);
  }
  sightcell_status policy(std::uint32_t outside, float max_distance) noexcept {
    return sightcell_view_policy(handle_, outside, max_distance);
  }
  sightcell_status origin(std::span<const double, 3> origin) noexcept {
    return sightcell_view_origin(handle_, origin.data());
  }

  sightcell_status show_named_group(std::uint32_t group, bool shown) noexcept {
    return sightcell_view_show_named_group(handle_, group, shown ? 1 : 0);
  }

  // One bit per draw.
  sightcell_status objects(std::span<std::uint64_t> bits_by_draw) const noexcept {
    return sightcell_view_objects(handle_, bits_by_draw.data(), bits_by_draw.size());
  }
  // True also for what is no box.
  [[nodiscard]] bool box_visible(std::span<const float, 3> min, std::span<const float, 3> max) const noexcept {
    std::uint32_t visible = 1;
    static_cast<void>(sightcell_view_box_visible(handle_, min.data(), max.data(), &visible));
    return visible != 0;
  }
  [[nodiscard]] sightcell_view_stats statistics() const noexcept {
    sightcell_view_stats stats{};
    stats.struct_size = sizeof(stats);
    static_cast<void>(sightcell_view_statistics(handle_, &stats));
    return stats;
  }
  list_result polygons(std::span<std::uint32_t> source_ids) const noexcept {
    list_result out;
    out.status = sightcell_view_polygons(handle_, source_ids.data(), source_ids.size(), &out.count);
    return out;
  }
  list_result ranges(std::span<sightcell_range> dst) const noexcept {
    list_result out;
    out.status = sightcell_view_ranges(handle_, dst.data(), dst.size(), &out.count);
    return out;
  }
  // stored_indices: 3 per stored polygon of the db, all of them.
  list_result indices(std::span<const std::uint32_t> stored_indices, std::span<std::uint32_t> dst) const noexcept {
    list_result out;
    out.status = sightcell_view_indices(handle_, stored_indices.data(), dst.data(), dst.size(), &out.count);
    return out;
  }
  // One behind the other. min_gap: as sightcell_view_commands has it.
  list_result commands(std::uint32_t min_gap, std::span<sightcell_command> dst) const noexcept {
    list_result out;
    out.status =
        sightcell_view_commands(handle_, min_gap, dst.data(), sizeof(sightcell_command), dst.size(), &out.count);
    return out;
  }
  changes_result changes(std::uint32_t since_revision, std::span<sightcell_range> added,
                         std::span<sightcell_range> removed) const noexcept {
    changes_result out;
    out.status = sightcell_view_changes(handle_, since_revision, added.data(), added.size(), &out.added, removed.data(),
                                        removed.size(), &out.removed);
    return out;
  }

  [[nodiscard]] const sightcell_view* get() const noexcept { return handle_; }

 private:
  sightcell_view* handle_ = nullptr;
};

}  // namespace sightcell
