#pragma once
// Sets as bytes: runs of consecutive ids, in numbers of variable length (LEB128). Records of cells consist of them.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::bake {

// Appends the lowest `bytes` bytes of value, the lowest first.
void put_bytes(std::vector<std::uint8_t>& out, std::uint64_t value, int bytes);

// Appends a number in seven bits per byte.
void put_varint(std::vector<std::uint8_t>& out, std::uint64_t value);

// Returns the end of the run that begins at first: values where each follows the one before it.
template <typename Follows>
std::size_t end_of_run(const std::vector<std::uint32_t>& values, std::size_t first, Follows follows) {
  std::size_t end = first + 1;
  while (end < values.size() && follows(values[end - 1], values[end])) ++end;
  return end;
}

// Appends a set: the number of its ids, then for each run the gap before it and its length - 1.
// set: strictly ascending.
void put_set(std::vector<std::uint8_t>& out, const std::vector<std::uint32_t>& set);

// Reads values from bytes and checks every read. After the first read past the end, all reads return 0 and good is
// false.
struct byte_reader {
  std::span<const std::uint8_t> bytes;
  bool good = true;

  std::uint64_t take(int count);
  std::uint64_t take_varint();
  double take_double();
  std::uint64_t fail();
};

// Appends a set. What damaged bytes may take: as many ids as they name, at most 2^32 per run.
void take_set(byte_reader& in, std::vector<std::uint32_t>& set);

}  // namespace sightcell::bake
