#pragma once
// Contents of .pvs files of every kind that the format allows, from a seed: general properties are tested on these.
// Equal seeds give equal contents on every machine.
#include <cstdint>
#include <vector>

#include "unit/format/sample_contents.h"

namespace sightcell::test {

struct any_contents : sample_contents {
  // Whether the writer gets no orders, and then uses the source order.
  bool orders_left_out = false;
  // The slack that the writer may add to each set.
  double slack_to_add = 0.0;
  // The source id of every stored polygon, computed from draws and orders by SPEC.md.
  std::vector<std::uint32_t> source_of_stored;
  // Stored number of the first polygon of every draw, or draw group of the merged layout, then the end of the last one.
  std::vector<std::uint32_t> unit_begins;

  // For encode(). Valid as long as this object.
  [[nodiscard]] format::file_contents contents_to_write() const;
  // Fails the running test, and returns no bytes, if the writer fails.
  [[nodiscard]] std::vector<std::byte> write() const;
};

any_contents make_any_contents(std::uint32_t seed);

}  // namespace sightcell::test
