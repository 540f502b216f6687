// Which copies there are. tests/stream decodes them.
#include "stream/encoded_copies.h"

#include <gtest/gtest.h>

#include <string>

namespace sightcell::bake {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

// Returns text without repetitions.
std::string random_text(std::size_t size) {
  std::string out;
  for (std::uint64_t state = 1; out.size() < size;) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    out.push_back(static_cast<char>(state >> 56));
  }
  return out;
}

TEST(encoded_copies, gzip_is_first_and_brotli_is_smaller) {
  const std::string text(1000, 'a');
  EXPECT_TRUE(encoded_copies(bytes_of(text), stream_copies::none).empty());
  EXPECT_EQ(encoded_copies(bytes_of(text), stream_copies::gzip).size(), 1u);
  const auto copies = encoded_copies(bytes_of(text), stream_copies::gzip_and_brotli);
  ASSERT_EQ(copies.size(), 2u);
  EXPECT_STREQ(copies[0].extension, ".gz");
  EXPECT_STREQ(copies[1].extension, ".br");
  EXPECT_LT(copies[1].bytes.size(), copies[0].bytes.size());
  const sent_bytes sent = sent_with(copies, text.size());
  EXPECT_EQ(sent.gzip, copies[0].bytes.size());
  EXPECT_EQ(sent.brotli, copies[1].bytes.size());
}

TEST(encoded_copies, gzip_has_no_time_and_no_system) {
  const std::string text(1000, 'a');
  const auto copies = encoded_copies(bytes_of(text), stream_copies::gzip);
  ASSERT_GE(copies.at(0).bytes.size(), 10u);
  const std::array<std::uint8_t, 10> header{0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 2, 255};
  for (std::size_t i = 0; i < header.size(); ++i) EXPECT_EQ(static_cast<std::uint8_t>(copies[0].bytes[i]), header[i]);
}

TEST(encoded_copies, none_that_saves_little) {
  for (const std::string& text :
       {random_text(5000), random_text(5000) + std::string(300, 'a'), std::string(70, 'a'), std::string()}) {
    const auto copies = encoded_copies(bytes_of(text), stream_copies::gzip_and_brotli);
    ASSERT_EQ(copies.size(), 2u);
    EXPECT_TRUE(copies[0].bytes.empty()) << text.size();
    EXPECT_TRUE(copies[1].bytes.empty()) << text.size();
    EXPECT_EQ(sent_with(copies, text.size()).gzip, text.size());
    EXPECT_EQ(sent_with(copies, text.size()).brotli, text.size());
  }
  const std::string more = random_text(5000) + std::string(600, 'a');
  EXPECT_FALSE(encoded_copies(bytes_of(more), stream_copies::gzip)[0].bytes.empty());
}

}  // namespace
}  // namespace sightcell::bake
