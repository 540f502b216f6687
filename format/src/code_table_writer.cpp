#include "code_table_writer.h"

#include "bit_sink.h"

namespace sightcell::format {

void put_code_lengths(const symbol_lengths& lengths, std::vector<std::byte>& out) {
  std::uint32_t count = symbol_count;
  while (count > 0 && lengths[count - 1] == 0) --count;
  bit_sink bits(out);
  bits.put(count, 8);
  for (std::uint32_t symbol = 0; symbol < count; ++symbol) bits.put(lengths[symbol], 4);
  bits.align();
}

}  // namespace sightcell::format
