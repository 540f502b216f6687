#include "sightcell/bake/recode.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "errors/error_id.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/format/sample_contents.h"

namespace sightcell::bake {
namespace {

using test::sample_contents;

class recode_test : public testing::Test {
 protected:
  recode_result recoded(const std::vector<std::byte>& file, const recode_settings& how) {
    const recode_result result = recode(file, "in.pvs", how, path_);
    bytes_ = test::file_bytes(path_);
    EXPECT_EQ(result.bytes, bytes_.size());
    EXPECT_EQ(result.bytes_before, file.size());
    return result;
  }

  test::fresh_folder folder_;
  std::filesystem::path path_ = folder_ / "out.pvs";
  std::vector<std::byte> bytes_;
};

sample_contents some_contents() {
  sample_contents contents = test::random_contents(21, {.polygons = 3000, .draws = 12, .cells = 150, .visible = 0.2});
  contents.settings = R"({"cells":"file","cell_size":4,"profile":"exact"})";
  return contents;
}

bool is_superset(const std::vector<std::uint32_t>& all, const std::vector<std::uint32_t>& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

TEST_F(recode_test, a_profile_adds_what_it_allows_and_takes_nothing) {
  const sample_contents contents = some_contents();
  const auto exact = contents.encode();
  std::size_t bytes_before = exact.size();
  for (const auto& [profile, most] :
       {std::pair(slack_profile::balanced, 0.05), std::pair(slack_profile::small, 0.10)}) {
    const recode_result result = recoded(exact, {profile, {}});
    EXPECT_LT(result.bytes, bytes_before);
    bytes_before = result.bytes;
    EXPECT_GT(result.slack, 0.0);
    EXPECT_LE(result.slack, most);
    test::stored_file file(bytes_);
    EXPECT_EQ(static_cast<double>(file.reader().facts().slack), result.slack);
    EXPECT_EQ(file_settings_of(file.reader().settings()).profile, profile);
    std::size_t seen = 0, added = 0;
    for (std::uint32_t cell = 0; cell < 150; ++cell) {
      const auto set = file.set(cell);
      EXPECT_TRUE(is_superset(set, contents.sets[cell])) << cell;
      EXPECT_LE(static_cast<double>(set.size()), (1.0 + most) * static_cast<double>(contents.sets[cell].size()))
          << cell;
      seen += contents.sets[cell].size();
      added += set.size() - contents.sets[cell].size();
    }
    EXPECT_NEAR(result.slack, static_cast<double>(added) / static_cast<double>(seen), 1e-6);
  }
}

TEST_F(recode_test, slack_is_not_taken_back) {
  const auto exact = some_contents().encode();
  (void)recoded(exact, {slack_profile::small, {}});
  const auto small = bytes_;
  for (const slack_profile less : {slack_profile::exact, slack_profile::balanced})
    EXPECT_EQ(test::error_id([&] { (void)recode(small, "in.pvs", {less, {}}, path_); }), "recode.has-slack");
  EXPECT_EQ(test::file_bytes(path_), small) << "the file is what it was";
  // The same profile again has nothing left to add; a larger one has what is left.
  const recode_result again = recoded(small, {slack_profile::small, {}});
  EXPECT_LE(again.slack, 0.10 + 1e-6);
  (void)recoded(exact, {slack_profile::balanced, {}});
  const auto balanced = bytes_;
  const recode_result more = recoded(balanced, {slack_profile::small, {}});
  EXPECT_GT(more.slack, 0.05);
  EXPECT_LE(more.slack, 0.10 + 1e-6);
}

TEST_F(recode_test, without_settings_the_file_stays) {
  sample_contents contents = some_contents();
  test::put_in_order(contents, 3);
  const auto before = contents.encode();
  (void)recoded(before, {});
  EXPECT_TRUE(bytes_ == before);
}

TEST_F(recode_test, an_order_changes_no_set) {
  sample_contents contents = some_contents();
  test::put_in_order(contents, 9);  // at random, which is the worst
  const auto before = contents.encode();
  for (const polygon_order_kind kind : {polygon_order_kind::per_mesh, polygon_order_kind::per_instance}) {
    (void)recoded(before, {{}, kind});
    EXPECT_LT(bytes_.size(), before.size() * 2 / 3);
    test::stored_file file(bytes_);
    EXPECT_EQ(file_settings_of(file.reader().settings()).order, kind);
    for (std::uint32_t cell = 0; cell < 150; ++cell) EXPECT_EQ(file.set(cell), contents.sets[cell]) << cell;
  }
}

TEST_F(recode_test, boxes_of_whole_steps_are_on_a_grid_then) {
  sample_contents contents = some_contents();
  (void)recoded(contents.encode(), {});
  EXPECT_EQ(test::stored_file(bytes_).reader().grid(), nullptr) << "cells by hand";
  contents.settings = R"({"cells":"automatic","cell_size":1})";
  const auto boxes = contents.encode();
  (void)recoded(boxes, {});
  EXPECT_LT(bytes_.size() + 150 * 20, boxes.size());
  const auto made = bytes_;
  test::stored_file file(bytes_);
  EXPECT_NE(file.reader().grid(), nullptr);
  for (std::uint32_t cell = 0; cell < 150; ++cell) {
    format::box b;
    EXPECT_EQ(file.reader().cell_box(cell, b), format::status::ok);
    EXPECT_EQ(b.min, contents.cells[cell].min);
    EXPECT_EQ(b.max, contents.cells[cell].max);
    EXPECT_EQ(file.set(cell), contents.sets[cell]);
  }
  (void)recoded(made, {});
  EXPECT_TRUE(bytes_ == made);
}

TEST_F(recode_test, a_merged_file_stays_one) {
  sample_contents contents = some_contents();
  test::put_in_groups(contents, 9);
  const auto before = contents.encode();
  for (const bool ordered : {false, true}) {
    recode_settings how;
    if (ordered)
      how.order = polygon_order_kind::per_mesh;
    else
      how.profile = slack_profile::small;
    (void)recoded(before, how);
    EXPECT_LT(bytes_.size(), before.size());
    test::stored_file file(bytes_);
    EXPECT_EQ(file.reader().facts().layout, format::host_layout::merged);
    EXPECT_EQ(file.reader().range_unit_count(), contents.orders.size());
    for (std::uint32_t cell = 0; cell < 150; ++cell) {
      EXPECT_TRUE(is_superset(file.set(cell), contents.sets[cell])) << cell;
      EXPECT_TRUE(!ordered || file.set(cell).size() == contents.sets[cell].size()) << cell;
    }
  }
  const recode_settings per_instance{{}, polygon_order_kind::per_instance};
  EXPECT_EQ(test::error_id([&] { (void)recode(before, "in.pvs", per_instance, path_); }), "recode.merged");
}

TEST_F(recode_test, volumes_stay_what_they_are) {
  sample_contents contents = some_contents();
  test::add_volumes(contents, 90, 2);
  const auto before = contents.encode();
  for (const recode_settings& how :
       {recode_settings{{}, polygon_order_kind::per_instance}, recode_settings{slack_profile::small, {}}}) {
    (void)recoded(before, how);
    test::stored_file file(bytes_);
    ASSERT_EQ(file.reader().volumes().count(), 90u);
    for (std::uint32_t cell = 0; cell < 150; ++cell) {
      const auto volumes_of = [](const std::vector<std::uint32_t>& items) {
        return std::vector<std::uint32_t>(std::lower_bound(items.begin(), items.end(), 3000u), items.end());
      };
      EXPECT_EQ(volumes_of(file.items(cell)), volumes_of(contents.sets[cell])) << cell;
      EXPECT_TRUE(is_superset(file.items(cell), contents.sets[cell])) << cell;
    }
  }
}

TEST_F(recode_test, version_0_becomes_this_version) {
  const auto old = test::golden_file("v0_small");
  const sample_contents contents = test::small_contents();
  const recode_result result = recoded(old, {});
  EXPECT_EQ(result.version_before, 0u);
  EXPECT_EQ(result.slack, 0.0);
  test::stored_file file(bytes_);
  EXPECT_EQ(file.reader().format_version(), format::layout::version);
  EXPECT_EQ(file.reader().facts().scene_fingerprint, contents.facts.scene_fingerprint);
  ASSERT_EQ(file.reader().cell_count(), 67u);
  format::reader before;
  ASSERT_EQ(format::reader::open(old, before), format::status::ok);
  for (std::uint32_t cell = 0; cell < 67; ++cell) {
    EXPECT_EQ(file.set(cell), contents.sets[cell]) << cell;
    format::box now;
    ASSERT_EQ(file.reader().cell_box(cell, now), format::status::ok);
    EXPECT_EQ(now.min, contents.cells[cell].min);
    format::certificate_record a, b;
    ASSERT_EQ(before.certificate(cell, a), format::status::ok);
    ASSERT_EQ(file.reader().certificate(cell, b), format::status::ok);
    EXPECT_EQ(std::tie(a.rays, a.misses, a.seed), std::tie(b.rays, b.misses, b.seed));
    EXPECT_GE(b.upper_bound, a.upper_bound);
    EXPECT_LE(b.upper_bound, a.upper_bound * (1.0 + 1e-6));
    EXPECT_LE(b.confidence, a.confidence);
  }
}

TEST_F(recode_test, damaged_files_are_refused) {
  auto damaged = some_contents().encode();
  damaged[damaged.size() - 30] ^= std::byte{1};
  EXPECT_EQ(test::error_id([&] { (void)recode(damaged, "in.pvs", {}, path_); }), "pvs.broken");
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_EQ(test::error_id([&] { (void)recode(some_contents().encode(), "in.pvs", {}, folder_ / "no" / "out.pvs"); }),
            "recode.not-written");
}

}  // namespace
}  // namespace sightcell::bake
