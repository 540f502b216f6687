#include "checksum.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace {

using sightcell::format::crc32c;

std::uint32_t of_text(const char* text) {
  return crc32c(std::as_bytes(std::span(text, std::strlen(text))));
}

// One bit at a time, by the definition of the polynomial.
std::uint32_t slow(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::byte b : bytes) {
    crc ^= static_cast<std::uint32_t>(b);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0x82F63B78u & (0u - (crc & 1u)));
  }
  return ~crc;
}

// RFC 3720, appendix B.4, and the usual check value.
TEST(checksum, published_values) {
  EXPECT_EQ(of_text("123456789"), 0xE3069283u);
  EXPECT_EQ(crc32c({}), 0u);
  EXPECT_EQ(crc32c(std::vector<std::byte>(32, std::byte{0})), 0x8A9136AAu);
  EXPECT_EQ(crc32c(std::vector<std::byte>(32, std::byte{0xFF})), 0x62A8AB43u);
}

TEST(checksum, every_length_and_alignment) {
  std::vector<std::byte> bytes(120);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 37 + 11);
  for (std::size_t begin = 0; begin < 9; ++begin) {
    for (std::size_t size = 0; begin + size <= bytes.size(); ++size) {
      const auto part = std::span(bytes).subspan(begin, size);
      ASSERT_EQ(crc32c(part), slow(part)) << begin << " " << size;
    }
  }
}

}  // namespace
