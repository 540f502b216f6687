#include "job/disk_space.h"

#include <gtest/gtest.h>
#include <sys/statvfs.h>

#include <string>
#include <vector>

#include "errors/error_id.h"

namespace sightcell::bake {
namespace {

constexpr std::uint64_t mebibyte = 1u << 20;

class disk_space_test : public testing::Test {
 protected:
  disk_space_test() : folder_(testing::TempDir()) {
    struct statvfs about {};
    if (statvfs(folder_.c_str(), &about) == 0) free_ = std::uint64_t{about.f_bavail} * about.f_frsize;
    tell_.on_message = [this](severity how, const std::string& line) {
      EXPECT_EQ(how, severity::warning);
      warnings_.push_back(line);
    };
  }
  std::string outcome(const std::vector<disk_need>& needs) {
    warnings_.clear();
    return test::error_id([&] { check_disk_space(needs, tell_); });
  }

  std::filesystem::path folder_;
  std::uint64_t free_ = 0;
  callbacks tell_;
  std::vector<std::string> warnings_;
};

TEST_F(disk_space_test, a_quarter_of_the_guess_must_be_free) {
  ASSERT_GT(free_, 8 * mebibyte);
  EXPECT_EQ(outcome({{folder_, mebibyte}}), "");
  EXPECT_EQ(warnings_.size(), 0u);
  EXPECT_EQ(outcome({{folder_, free_}}), "") << "a guess is a guess";
  EXPECT_EQ(warnings_.size(), 1u);
  EXPECT_EQ(outcome({{folder_, 8 * free_}}), "bake.disk-space");
}

TEST_F(disk_space_test, needs_on_one_disk_are_added) {
  const std::uint64_t each = 3 * free_;
  EXPECT_EQ(outcome({{folder_, each}}), "");
  EXPECT_EQ(outcome({{folder_, each}, {folder_ / ".", each}}), "bake.disk-space");
}

TEST_F(disk_space_test, a_folder_that_is_not_there_is_somebody_elses_business) {
  EXPECT_EQ(outcome({{folder_ / "no such folder", ~std::uint64_t{0} / 2}}), "");
}

TEST(disk_space, cells_that_see_more_write_more) {
  EXPECT_GT(checkpoint_bytes_of_cell(1000.0), file_bytes_of_cell(1000.0));
  EXPECT_GT(file_bytes_of_cell(10'000.0), 5 * file_bytes_of_cell(1000.0));
  EXPECT_GT(file_bytes_of_cell(0.0), 0u);
}

}  // namespace
}  // namespace sightcell::bake
