#pragma once
// A .pvs file made from sample contents, opened through the C API, and the outputs of a view as plain sets.
#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/sightcell.h"
#include "unit/format/sample_contents.h"

namespace sightcell::test {

// Owns the bytes and the db.
class loaded_file {
 public:
  explicit loaded_file(std::vector<std::byte> bytes, const sightcell_allocator* mem = nullptr)
      : bytes_(std::move(bytes)) {
    EXPECT_EQ(sightcell_db_open(bytes_.data(), bytes_.size(), mem, &db_), SIGHTCELL_OK);
  }
  explicit loaded_file(const sample_contents& contents) : loaded_file(contents.encode()) {}
  ~loaded_file() { sightcell_db_close(db_); }
  loaded_file(const loaded_file&) = delete;
  loaded_file& operator=(const loaded_file&) = delete;

  [[nodiscard]] const sightcell_db* db() const { return db_; }
  [[nodiscard]] sightcell_info info() const {
    sightcell_info info{};
    info.struct_size = sizeof info;
    EXPECT_EQ(sightcell_db_info(db_, &info), SIGHTCELL_OK);
    return info;
  }

 private:
  std::vector<std::byte> bytes_;
  sightcell_db* db_ = nullptr;
};

// Owns a view; calls its list functions for the size first.
class test_view {
 public:
  explicit test_view(const sightcell_db* db) { EXPECT_EQ(sightcell_view_create(db, &view_), SIGHTCELL_OK); }
  ~test_view() { sightcell_view_destroy(view_); }
  test_view(const test_view&) = delete;
  test_view& operator=(const test_view&) = delete;

  sightcell_frame move(float x, float y, float z, sightcell_status expected = SIGHTCELL_OK) {
    const float eye[3] = {x, y, z};
    sightcell_frame frame;
    EXPECT_EQ(sightcell_view_move(view_, eye, &frame), expected);
    return frame;
  }
  [[nodiscard]] std::vector<std::uint32_t> polygons() const {
    std::size_t count = 0;
    static_cast<void>(sightcell_view_polygons(view_, nullptr, 0, &count));
    std::vector<std::uint32_t> ids(count);
    EXPECT_EQ(sightcell_view_polygons(view_, ids.data(), ids.size(), &count), SIGHTCELL_OK);
    EXPECT_EQ(count, ids.size());
    return ids;
  }
  [[nodiscard]] std::vector<sightcell_range> ranges() const {
    std::size_t count = 0;
    static_cast<void>(sightcell_view_ranges(view_, nullptr, 0, &count));
    std::vector<sightcell_range> ranges(count);
    EXPECT_EQ(sightcell_view_ranges(view_, ranges.data(), ranges.size(), &count), SIGHTCELL_OK);
    return ranges;
  }
  [[nodiscard]] std::vector<std::uint32_t> indices(const std::vector<std::uint32_t>& stored) const {
    std::size_t count = 0;
    static_cast<void>(sightcell_view_indices(view_, stored.data(), nullptr, 0, &count));
    std::vector<std::uint32_t> list(count);
    EXPECT_EQ(sightcell_view_indices(view_, stored.data(), list.data(), list.size(), &count), SIGHTCELL_OK);
    return list;
  }
  [[nodiscard]] sightcell_view* get() const { return view_; }

 private:
  sightcell_view* view_ = nullptr;
};

// The polygons of ranges, as stored numbers, in the order of the ranges.
inline std::vector<std::uint32_t> polygons_of(std::span<const sightcell_range> ranges,
                                              const sample_contents& contents) {
  const bool merged = contents.facts.layout == format::host_layout::merged;
  std::vector<std::uint32_t> begins;  // of draws, or draw groups
  for (const format::draw_record& d : contents.draws) {
    if (!merged || d.group == begins.size()) begins.push_back(d.first_stored);
  }
  begins.push_back(contents.facts.polygon_count);
  std::vector<std::uint32_t> polygons;
  for (const sightcell_range& r : ranges) {
    EXPECT_LT(r.draw + 1, begins.size());
    EXPECT_GE(r.count, 1u);
    EXPECT_LE(r.first + r.count, begins[r.draw + 1] - begins[r.draw]);
    for (std::uint32_t i = 0; i < r.count; ++i) polygons.push_back(begins[r.draw] + r.first + i);
  }
  return polygons;
}

// 0, 1, .. count - 1
inline std::vector<std::uint32_t> all_polygons(std::uint32_t count) {
  std::vector<std::uint32_t> all(count);
  for (std::uint32_t i = 0; i < count; ++i) all[i] = i;
  return all;
}

}  // namespace sightcell::test
