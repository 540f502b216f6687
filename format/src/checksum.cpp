#include "checksum.h"

#include <array>

namespace sightcell::format {
namespace {

// Slicing by eight: tables[k][b] is the checksum of byte b followed by k zero bytes, so that eight bytes are folded
// with eight independent lookups. About 2 GB/s, on any processor. The module for web pages slices by four: tables do
// not compress, and four more would be a fifteenth of the package.
#if defined(__wasm__)
constexpr std::size_t slices = 4;
#else
constexpr std::size_t slices = 8;
#endif
using slicing_tables = std::array<std::array<std::uint32_t, 256>, slices>;

constexpr slicing_tables make_tables() {
  slicing_tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0x82F63B78u : 0u);
    tables[0][byte] = crc;
  }
  for (std::size_t byte = 0; byte < 256; ++byte) {
    for (std::size_t k = 1; k < slices; ++k) {
      tables[k][byte] = (tables[k - 1][byte] >> 8) ^ tables[0][tables[k - 1][byte] & 0xFFu];
    }
  }
  return tables;
}

constexpr slicing_tables tables = make_tables();

std::uint32_t load_u32(const std::byte* place) noexcept {
  return static_cast<std::uint32_t>(place[0]) | static_cast<std::uint32_t>(place[1]) << 8 |
         static_cast<std::uint32_t>(place[2]) << 16 | static_cast<std::uint32_t>(place[3]) << 24;
}

// The checksum of four bytes, of which the first is followed by slice - 1 bytes.
std::uint32_t after(std::uint32_t word, std::size_t slice) noexcept {
  return tables[slice - 1][word & 0xFFu] ^ tables[slice - 2][(word >> 8) & 0xFFu] ^
         tables[slice - 3][(word >> 16) & 0xFFu] ^ tables[slice - 4][word >> 24];
}

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes) noexcept {
  std::uint32_t crc = 0xFFFFFFFFu;
  const std::byte* place = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= slices; left -= slices, place += slices) {
    const std::uint32_t first = after(crc ^ load_u32(place), slices);
    if constexpr (slices == 8) {
      crc = first ^ after(load_u32(place + 4), 4);
    } else {
      crc = first;
    }
  }
  for (; left > 0; --left, ++place) {
    crc = (crc >> 8) ^ tables[0][(crc ^ static_cast<std::uint32_t>(*place)) & 0xFFu];
  }
  return ~crc;
}

}  // namespace sightcell::format
