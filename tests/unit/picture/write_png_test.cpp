#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include "errors/error_id.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/picture.h"

namespace {

namespace fs = std::filesystem;
using sightcell::picture::image_rgba;
using sightcell::picture::write_png;

class write_png_test : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("sightcell_write_png_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
  const image_rgba picture_{5, 3, std::vector<std::uint8_t>(5 * 3 * 4, 200)};
};

TEST_F(write_png_test, writes_a_png_of_that_size_and_nothing_else) {
  const fs::path path = folder_ / "a.png";
  write_png(path, picture_);
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  ASSERT_GT(bytes.size(), 33u);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes.substr(12, 4), "IHDR");
  EXPECT_EQ(bytes.substr(16, 8), std::string("\0\0\0\5\0\0\0\3", 8));
  EXPECT_EQ(files(), 1u);
}

TEST_F(write_png_test, replaces_an_older_file) {
  const fs::path path = folder_ / "a.png";
  std::ofstream(path) << "old";
  write_png(path, picture_);
  EXPECT_GT(fs::file_size(path), 33u);
  EXPECT_EQ(files(), 1u);
}

TEST_F(write_png_test, a_missing_folder_is_an_error_in_one_line) {
  try {
    write_png(folder_ / "missing" / "a.png", picture_);
    FAIL();
  } catch (const sightcell::error& e) {
    EXPECT_EQ(e.id(), "picture.write");
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
  }
}

TEST_F(write_png_test, a_folder_in_its_place_leaves_nothing_behind) {
  fs::create_directories(folder_ / "a.png" / "inside");
  EXPECT_THROW(write_png(folder_ / "a.png", picture_), sightcell::error);
  EXPECT_EQ(files(), 1u);
}

TEST_F(write_png_test, an_empty_picture_is_refused) {
  EXPECT_EQ(sightcell::test::error_id([&] { write_png(folder_ / "a.png", image_rgba{}); }), "picture.empty");
  EXPECT_EQ(files(), 0u);
}

}  // namespace
