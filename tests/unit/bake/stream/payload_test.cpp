// The bytes of docs/streaming.md, "Numbers and columns".
#include "stream/payload.h"

#include <gtest/gtest.h>

namespace sightcell::bake {
namespace {

using bytes = std::vector<std::uint8_t>;

bytes of(const payload& p) {
  return {p.bytes().begin(), p.bytes().end()};
}

TEST(payload, varints_have_seven_bits_in_each_byte) {
  payload p;
  p.put_varints(std::vector<std::uint32_t>{0, 127, 128, 300, 0xFFFFFFFF});
  EXPECT_EQ(of(p), (bytes{0, 127, 0x80, 1, 0xAC, 2, 0xFF, 0xFF, 0xFF, 0xFF, 15}));
}

TEST(payload, deltas_have_the_sign_in_the_lowest_bit) {
  payload p;
  p.put_deltas(std::vector<std::uint32_t>{5, 7, 4, 4});
  EXPECT_EQ(of(p), (bytes{10, 4, 5, 0}));
}

TEST(payload, gaps_are_one_less_than_differences) {
  payload p;
  p.put_gaps(std::vector<std::uint32_t>{3, 4, 9});
  EXPECT_EQ(of(p), (bytes{3, 0, 4}));
}

TEST(payload, floats_are_planes) {
  payload p;
  p.put_floats(std::vector<float>{1.0f, -2.0f});  // 0x3F800000, 0xC0000000
  EXPECT_EQ(of(p), (bytes{0, 0, 0, 0, 0x80, 0, 0x3F, 0xC0}));
}

TEST(payload, names_are_the_begin_of_a_sha_256) {
  const std::string text = "abc";
  const content_name expected{0xba, 0x78, 0x16, 0xbf, 0x8f, 0x01, 0xcf, 0xea};
  EXPECT_EQ(name_of(std::as_bytes(std::span(text))), expected);
}

}  // namespace
}  // namespace sightcell::bake
