#include "packed_columns_writer.h"

#include <algorithm>
#include <bit>

#include "bit_sink.h"
#include "byte_sink.h"

namespace sightcell::format {

void put_columns(std::span<const std::vector<std::uint32_t>> columns, std::vector<std::byte>& out) {
  struct shape {
    std::uint32_t base = 0;
    unsigned bits = 0;
  };
  std::vector<shape> shapes;
  byte_sink bytes(out);
  for (const std::vector<std::uint32_t>& column : columns) {
    shape s;
    if (!column.empty()) {
      const auto [least, most] = std::minmax_element(column.begin(), column.end());
      s = {*least, static_cast<unsigned>(std::bit_width(*most - *least))};
    }
    bytes.put_u32(s.base);
    bytes.put_u32(s.bits);
    shapes.push_back(s);
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    bit_sink bits(out);
    for (const std::uint32_t value : columns[c]) bits.put(value - shapes[c].base, shapes[c].bits);
    bits.align();
  }
}

}  // namespace sightcell::format
