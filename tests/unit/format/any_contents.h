#pragma once
// Contents of .pvs files of every kind that the format has, drawn from a seed: what is true of all files is tried on
// these. Same seed, same contents, on every machine.
#include <cstdint>
#include <vector>

#include "unit/format/sample_contents.h"

namespace sightcell::test {

struct any_contents : sample_contents {
  // Of the orders: none are given to the writer, which then takes those of the source.
  bool orders_left_out = false;
  // That the writer may add to each set.
  double slack_to_add = 0.0;
  // The source id of every stored polygon, worked out from draws and orders as SPEC.md says.
  std::vector<std::uint32_t> source_of_stored;
  // Stored number of the first polygon of every draw, or draw group of the merged layout, and of none behind the last.
  std::vector<std::uint32_t> unit_begins;

  // For encode(). Valid as long as this is.
  [[nodiscard]] format::file_contents contents_to_write() const;
  // Fails the running test, and gives no bytes, when the writer refuses.
  [[nodiscard]] std::vector<std::byte> write() const;
};

any_contents make_any_contents(std::uint32_t seed);

}  // namespace sightcell::test
