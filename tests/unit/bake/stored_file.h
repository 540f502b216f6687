#pragma once
// A .pvs file as tests look at it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"

namespace sightcell::test {

// Fails the running test where the bytes are no file.
class stored_file {
 public:
  explicit stored_file(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {
    format::reader file;
    EXPECT_EQ(format::reader::open(bytes_, file), format::status::ok);
    EXPECT_EQ(sets_.open(file), format::status::ok);
  }
  stored_file(const stored_file&) = delete;
  stored_file& operator=(const stored_file&) = delete;

  const format::reader& reader() const { return sets_.file(); }
  // Ascending source ids.
  std::vector<std::uint32_t> set(std::uint32_t cell) {
    std::vector<std::uint32_t> ids;
    EXPECT_EQ(sets_.source_ids(cell, ids), format::status::ok);
    return ids;
  }
  // And volumes behind them.
  std::vector<std::uint32_t> items(std::uint32_t cell) {
    std::vector<std::uint32_t> ids;
    EXPECT_EQ(sets_.item_ids(cell, ids), format::status::ok);
    return ids;
  }
  bool has(std::uint32_t cell, std::uint32_t polygon) {
    const std::vector<std::uint32_t> ids = set(cell);
    return std::binary_search(ids.begin(), ids.end(), polygon);
  }

 private:
  std::vector<std::byte> bytes_;
  format::set_reader sets_;
};

}  // namespace sightcell::test
