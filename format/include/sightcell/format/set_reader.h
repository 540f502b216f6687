#pragma once
// The sets of a file, with the memory for decoding them. For tools; a runtime that must not allocate uses the reader.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

class set_reader {
 public:
  set_reader() = default;
  set_reader(const set_reader&) = delete;
  set_reader& operator=(const set_reader&) = delete;
  set_reader(set_reader&&) = default;
  set_reader& operator=(set_reader&&) = default;

  // Makes the code tables of a file and the source id of every stored polygon. The bytes of the file must outlive this
  // object.
  // corrupt: invalid tables. Allocates 4 bytes per polygon, about 30 per run of the largest set, and the code tables.
  //   After open, only one thread at a time may use the object.
  status open(const reader& file);

  [[nodiscard]] const reader& file() const { return file_; }

  // The polygons of a set as runs in stored order, valid until the next call. Fails as reader::decode_row.
  status runs(std::uint32_t cell, std::span<const run>& out);

  // The same with its volumes.
  status parts(std::uint32_t cell, row_parts& out);

  // The polygons of a set as ascending source ids. out is replaced.
  status source_ids(std::uint32_t cell, std::vector<std::uint32_t>& out);

  // A set as encode() takes it: source ids, then polygon_count + v for each volume v. out is replaced.
  status item_ids(std::uint32_t cell, std::vector<std::uint32_t>& out);

  // The source id of every stored polygon.
  [[nodiscard]] std::span<const std::uint32_t> source_of_stored() const { return source_of_stored_; }

  // reader::check and reader::statistics.
  status check();
  status statistics(row_statistics& sums);

 private:
  void put_source_ids(std::span<const run> stored, std::vector<std::uint32_t>& out) const;

  reader file_;
  std::vector<std::byte> codes_memory_;
  const row_codes* codes_ = nullptr;
  std::vector<std::uint32_t> source_of_stored_;
  std::vector<run> row_;
  std::vector<std::byte> scratch_;
};

}  // namespace sightcell::format
