#include "stream/smaller_images.h"

#include <gtest/gtest.h>

#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace sightcell::bake {
namespace {

using scene::image_type;
using scene::streamed_image;

void put_big_endian(std::vector<std::uint8_t>& out, std::size_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

void put_chunk(std::vector<std::uint8_t>& out, std::string_view kind, const std::vector<std::uint8_t>& data) {
  put_big_endian(out, data.size());
  out.insert(out.end(), kind.begin(), kind.end());
  out.insert(out.end(), data.begin(), data.end());
  put_big_endian(out, 0);  // no checksum: the decoder does not look at it
}

// A gray PNG without compression.
streamed_image png_of(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint8_t> out{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'}, head, data{0x78, 0x01};
  put_big_endian(head, width);
  put_big_endian(head, height);
  head.insert(head.end(), {8, 0, 0, 0, 0});
  put_chunk(out, "IHDR", head);
  for (std::uint32_t y = 0; y < height; ++y) {  // a block of deflate per row
    const std::uint32_t size = width + 1;
    data.push_back(y + 1 == height ? 1 : 0);
    for (const std::uint32_t part : {size, ~size})
      data.push_back(static_cast<std::uint8_t>(part)), data.push_back(static_cast<std::uint8_t>(part >> 8));
    data.push_back(0);
    for (std::uint32_t x = 0; x < width; ++x) data.push_back(static_cast<std::uint8_t>((x * 7) ^ (y * 3)));
  }
  data.insert(data.end(), {0, 0, 0, 0});
  put_chunk(out, "IDAT", data);
  put_chunk(out, "IEND", {});
  streamed_image image;
  image.width = width, image.height = height, image.type = image_type::png, image.bytes = std::move(out);
  return image;
}

bool is_webp(const smaller_image& version) {
  const std::string_view text(reinterpret_cast<const char*>(version.bytes.data()), 16);
  return text.starts_with("RIFF") && text.substr(8).starts_with("WEBP");
}

TEST(smaller_images, versions_ascend_and_each_saves_half) {
  const streamed_image image = png_of(1200, 301);
  const smaller_images made = smaller_images_of(image);
  ASSERT_EQ(made.versions.size(), 3u);
  const std::array<std::array<std::uint32_t, 2>, 3> sizes = {{{64, 16}, {256, 64}, {1024, 257}}};
  for (std::size_t i = 0; i < 3; ++i) {
    const smaller_image& version = made.versions[i];
    EXPECT_EQ((std::array{version.width, version.height}), sizes[i]);
    EXPECT_TRUE(is_webp(version));
    const std::size_t next = i < 2 ? made.versions[i + 1].bytes.size() : image.bytes.size();
    EXPECT_LE(2 * version.bytes.size(), next);
  }
  EXPECT_EQ(smaller_images_of(image).versions[1].bytes, made.versions[1].bytes);
}

TEST(smaller_images, thin_images_keep_a_pixel) {
  const smaller_images made = smaller_images_of(png_of(2000, 2));
  ASSERT_FALSE(made.versions.empty());
  EXPECT_EQ(made.versions.front().height, 1u);
}

TEST(smaller_images, small_ones_have_no_versions) {
  EXPECT_TRUE(smaller_images_of(png_of(64, 64)).versions.empty());  // no pixels to save
  EXPECT_TRUE(smaller_images_of(png_of(100, 8)).versions.empty());  // no bytes to save
}

TEST(smaller_images, versions_of_a_version) {
  smaller_images made = smaller_images_of(png_of(1200, 301));
  streamed_image image;  // as of a file whose size in pixels is unknown
  image.type = image_type::webp;
  image.bytes = made.versions.back().bytes;
  made = smaller_images_of(image);
  EXPECT_EQ((std::array{made.width, made.height}), (std::array{1024u, 257u}));
  ASSERT_FALSE(made.versions.empty());
  EXPECT_EQ((std::array{made.versions[0].width, made.versions[0].height}), (std::array{64u, 16u}));
  image.bytes.resize(image.bytes.size() / 2);
  EXPECT_TRUE(smaller_images_of(image).is_unreadable);
}

TEST(smaller_images, damaged_and_huge_ones_are_unreadable) {
  streamed_image image = png_of(1200, 301);
  image.bytes.resize(image.bytes.size() / 2);
  EXPECT_TRUE(smaller_images_of(image).is_unreadable);
  image = png_of(9000, 2);
  EXPECT_TRUE(smaller_images_of(image).is_unreadable);
  EXPECT_TRUE(smaller_images_of(image).versions.empty());
  for (const image_type type : {image_type::ktx2, image_type::unknown}) {
    image.type = type;
    EXPECT_FALSE(smaller_images_of(image).is_unreadable);
    EXPECT_TRUE(smaller_images_of(image).versions.empty());
  }
}

}  // namespace
}  // namespace sightcell::bake
