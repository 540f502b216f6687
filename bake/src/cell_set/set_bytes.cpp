#include "cell_set/set_bytes.h"

#include <bit>
#include <limits>
#include <numeric>

namespace sightcell::bake {
namespace {

// Limit of the values that a decoded run may have, so that damaged bytes cannot request more memory. Ids have 32 bits.
constexpr std::uint64_t most_values = std::uint64_t{1} << 32;

}  // namespace

void put_bytes(std::vector<std::uint8_t>& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void put_varint(std::vector<std::uint8_t>& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
}

void put_set(std::vector<std::uint8_t>& out, const std::vector<std::uint32_t>& set) {
  put_varint(out, set.size());
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < set.size();) {
    const std::size_t end = end_of_run(set, i, [](std::uint32_t a, std::uint32_t b) { return b - a == 1; });
    put_varint(out, set[i] - next);
    put_varint(out, end - i - 1);
    next = std::uint64_t{set[end - 1]} + 1;
    i = end;
  }
}

std::uint64_t byte_reader::take(int count) {
  std::uint64_t value = 0;
  if (bytes.size() < static_cast<std::size_t>(count)) return fail();
  for (int i = 0; i < count; ++i) value |= std::uint64_t{bytes[static_cast<std::size_t>(i)]} << (8 * i);
  bytes = bytes.subspan(static_cast<std::size_t>(count));
  return value;
}

std::uint64_t byte_reader::take_varint() {
  std::uint64_t value = 0;
  std::size_t at = 0;
  for (int shift = 0; shift < 63 && at < bytes.size(); shift += 7) {
    const std::uint64_t part = bytes[at++];
    value |= (part & 0x7F) << shift;
    if (part >= 0x80) continue;
    bytes = bytes.subspan(at);
    return value;
  }
  return fail();
}

double byte_reader::take_double() {
  return std::bit_cast<double>(take(8));
}

std::uint64_t byte_reader::fail() {
  good = false;
  bytes = {};
  return 0;
}

void take_set(byte_reader& in, std::vector<std::uint32_t>& set) {
  const std::uint64_t count = in.take_varint();
  if (count > most_values) in.fail();
  std::uint64_t next = 0;
  while (in.good && set.size() < count) {
    next += in.take_varint();
    const std::uint64_t length = in.take_varint() + 1;
    if (next > std::numeric_limits<std::uint32_t>::max() || length > most_values - next || length > count - set.size())
      in.fail();
    if (!in.good) return;
    const std::size_t before = set.size();
    set.resize(before + length);
    std::iota(set.begin() + static_cast<std::ptrdiff_t>(before), set.end(), static_cast<std::uint32_t>(next));
    next += length;
  }
}

}  // namespace sightcell::bake
