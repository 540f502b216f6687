// The order of polygons inside a cell by how much of them is seen: measured by a bake and by recode, and kept.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "errors/error_id.h"
#include "file/importance_meter.h"
#include "file/pvs_output.h"
#include "sightcell/bake/patch.h"
#include "sightcell/bake/recode.h"
#include "sightcell/bake/shards.h"
#include "sightcell/format/importance_classes.h"
#include "sightcell/format/set_reader.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/bake/tiny_scene.h"
#include "unit/format/importance_samples.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;
using ids = std::vector<std::uint32_t>;

constexpr std::uint8_t last = format::least_important;
const view_cell middle{{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}, "", 1};

class importance_test : public testing::Test {
 protected:
  // A file of one cell with this set, and the importance that recode measures in the scene.
  void measure(const scene::scene& s, ids set) {
    settings how;
    how.margin = 0.0f;
    how.file.profile = slack_profile::exact;
    cell_record record;
    record.set = std::move(set);
    summary sum;
    write_pvs(
        frame_of(s, how, describe(how), {middle}), [&](std::uint32_t) { return record; }, path_, {}, sum);
    const auto plain = test::file_bytes(path_);
    recode_settings with;
    with.importance_in = &s;
    (void)recode(plain, "in.pvs", with, path_);
    read();
  }
  void read() {
    bytes_ = test::file_bytes(path_);
    ASSERT_EQ(format::reader::open(bytes_, file_), format::status::ok);
    format::set_reader sets;
    ASSERT_EQ(sets.open(file_), format::status::ok);
    EXPECT_EQ(sets.check(), format::status::ok);
  }
  std::uint8_t class_of(std::uint32_t polygon, std::uint32_t cell = 0) {
    test::stored_file stored(bytes_);
    const ids set = stored.set(cell);
    const auto found = std::lower_bound(set.begin(), set.end(), polygon);
    EXPECT_TRUE(found != set.end() && *found == polygon) << polygon;
    return test::classes_of(stored.reader(), cell)[static_cast<std::size_t>(found - set.begin())];
  }

  test::fresh_folder folder_;
  std::filesystem::path path_ = folder_ / "out.pvs";
  std::vector<std::byte> bytes_;
  format::reader file_;
};

TEST(importance_class, is_of_factors_of_four) {
  const double half = 2.0 * std::numbers::pi;
  EXPECT_EQ(importance_class_of(half), 0);
  EXPECT_EQ(importance_class_of(0.25 * half), 0);
  EXPECT_EQ(importance_class_of(0.249 * half), 1);
  EXPECT_EQ(importance_class_of(half / 16), 1);
  EXPECT_EQ(importance_class_of(half / 17), 2);
  EXPECT_EQ(importance_class_of(half / 4e6), 10);
  EXPECT_EQ(importance_class_of(half / 4.2e6), last);
  EXPECT_EQ(importance_class_of(0.0), last);
  EXPECT_EQ(importance_class_of(-1.0), last);
  EXPECT_EQ(importance_class_of(std::nan("")), last);
}

TEST_F(importance_test, what_is_near_and_large_comes_first) {
  tiny_scene tiny;
  const std::uint32_t far = tiny.triangle({40, 20, -0.1f}, {40, 20, 0.1f}, {40, 20.2f, -0.1f});
  const std::uint32_t near = tiny.wall_x(-1, 1, 2);
  const std::uint32_t medium = tiny.wall_x(8, -1, 2);
  measure(tiny.finished(), {far, near, near + 1, medium, medium + 1});
  EXPECT_EQ(class_of(near), 0);
  EXPECT_EQ(class_of(near + 1), 0);
  EXPECT_LT(class_of(near), class_of(medium));
  EXPECT_LT(class_of(medium), class_of(far));
  EXPECT_LT(class_of(far), last);
}

// Two like walls, of which one is seen through a slit alone.
TEST_F(importance_test, what_is_mostly_hidden_comes_behind_what_is_not) {
  tiny_scene tiny;
  const std::uint32_t open = tiny.wall_x(-4, 1, 3);
  const std::uint32_t hidden = tiny.wall_x(4, -1, 3);
  tiny.quad({2, -9, 9}, {2, -9, 0.1f}, {2, 9, 0.1f}, {2, 9, 9}, {.double_sided = true});
  tiny.quad({2, -9, -0.1f}, {2, -9, -9}, {2, 9, -9}, {2, 9, -0.1f}, {.double_sided = true});
  measure(tiny.finished(), {open, open + 1, hidden, hidden + 1});
  for (const std::uint32_t i : {0u, 1u}) {
    EXPECT_LT(class_of(open + i), class_of(hidden + i));
    EXPECT_LT(class_of(hidden + i), last) << "rays go on until they see something of what is large";
  }
}

TEST_F(importance_test, what_nobody_sees_comes_last) {
  tiny_scene tiny;
  const std::uint32_t front = tiny.wall_x(2, -1, 9);
  const std::uint32_t behind = tiny.wall_x(3, -1, 2);
  const std::uint32_t turned_away = tiny.wall_x(-2, -1, 2);
  measure(tiny.finished(), {front, front + 1, behind, behind + 1, turned_away, turned_away + 1});
  EXPECT_LT(class_of(front), 2);
  for (const std::uint32_t i : {0u, 1u}) {
    EXPECT_EQ(class_of(behind + i), last);
    EXPECT_EQ(class_of(turned_away + i), last);
  }
}

// Rule 1 and rule 2: what hides nothing is seen before what it does not hide, and what lies in one place is seen as
// one.
TEST_F(importance_test, is_of_what_the_rules_of_seeing_say) {
  tiny_scene tiny;
  const std::uint32_t glass = tiny.wall_x(1.5f, -1, 2, {.alpha = scene::alpha_mode::blend});
  const std::uint32_t front = tiny.wall_x(2, -1, 2);
  const std::uint32_t same = tiny.wall_x(2, -1, 2);
  measure(tiny.finished(), {glass, glass + 1, front, front + 1, same, same + 1});
  EXPECT_LT(class_of(glass), 3);
  EXPECT_LT(class_of(front), 3);
  EXPECT_EQ(class_of(front), class_of(same));
}

settings quick(slack_profile profile) {
  settings how;
  how.source = "cpu";
  how.resolution = 64;
  how.cells_grid = {-8.0f, -2.0f, -8.0f, 8.0f, 2.0f, 8.0f};
  how.cell_size = 8.0f;
  how.file.profile = profile;
  return how;
}

std::vector<std::byte> baked(const scene::scene& s, const settings& how, const std::filesystem::path& path) {
  (void)bake(s, how, path, true, {});
  return test::file_bytes(path);
}

TEST_F(importance_test, a_bake_on_any_number_of_threads_and_recode_write_the_same_bytes) {
  tiny_scene tiny;
  tiny.room_with_pillars();
  const scene::scene s = tiny.finished();
  settings how = quick(slack_profile::small);
  const auto without = baked(s, how, path_);
  how.file.importance = true;
  how.threads = 1;
  const auto alone = baked(s, how, path_);
  how.threads = 3;
  EXPECT_TRUE(baked(s, how, path_) == alone);
  recode_settings with;
  with.importance_in = &s;
  const recode_result result = recode(without, "in.pvs", with, path_);
  EXPECT_FALSE(result.cancelled);
  EXPECT_EQ(result.bytes, alone.size());
  EXPECT_TRUE(test::file_bytes(path_) == alone);
  // Measured again it is what it was.
  (void)recode(alone, "in.pvs", with, path_);
  EXPECT_TRUE(test::file_bytes(path_) == alone);
}

TEST_F(importance_test, a_file_without_it_has_no_byte_of_it) {
  tiny_scene tiny;
  tiny.room_with_pillars();
  const scene::scene s = tiny.finished();
  const auto without = baked(s, quick(slack_profile::exact), path_);
  (void)recode(without, "in.pvs", {}, path_);
  EXPECT_TRUE(test::file_bytes(path_) == without);
  read();
  EXPECT_FALSE(file_.has_importance());
}

// All classes by source id, and the last one of what was not in the set before.
TEST_F(importance_test, recode_and_patch_keep_what_is_known) {
  tiny_scene tiny;
  tiny.room_with_pillars();
  const scene::scene s = tiny.finished();
  settings how = quick(slack_profile::exact);
  how.file.importance = true;
  const auto before = baked(s, how, path_);
  test::stored_file old(before);
  const auto expect_kept = [&](const char* what) {
    read();
    ASSERT_TRUE(file_.has_importance()) << what;
    test::stored_file now(bytes_);
    std::size_t added = 0;
    for (std::uint32_t cell = 0; cell < file_.cell_count(); ++cell) {
      const ids known = old.set(cell), set = now.set(cell);
      const auto classes_before = test::classes_of(old.reader(), cell), classes = test::classes_of(file_, cell);
      for (std::size_t i = 0; i < set.size(); ++i) {
        const auto found = std::lower_bound(known.begin(), known.end(), set[i]);
        const bool there = found != known.end() && *found == set[i];
        added += there ? 0 : 1;
        EXPECT_EQ(classes[i], there ? classes_before[static_cast<std::size_t>(found - known.begin())] : last) << what;
      }
    }
    EXPECT_EQ(added > 0, what != std::string("order")) << what;
  };
  (void)recode(before, "in.pvs", {{}, polygon_order_kind::per_instance}, path_);
  expect_kept("order");
  (void)recode(before, "in.pvs", {slack_profile::small, {}}, path_);
  expect_kept("profile");
  const std::vector<added_polygons> more{{0, 0, s.polygon_count}};
  (void)patch(before, "in.pvs", more, path_);
  expect_kept("patch");
}

TEST_F(importance_test, is_not_measured_in_another_scene) {
  tiny_scene tiny, other;
  tiny.wall_x(2, -1, 2);
  other.wall_x(3, -1, 2);
  measure(tiny.finished(), {0, 1});
  const scene::scene wrong = other.finished();
  recode_settings with;
  with.importance_in = &wrong;
  const auto before = bytes_;
  EXPECT_EQ(test::error_id([&] { (void)recode(before, "in.pvs", with, path_); }), "pvs.other-scene");
  EXPECT_TRUE(test::file_bytes(path_) == before);
}

TEST_F(importance_test, is_cancelled_and_gone_on_with) {
  tiny_scene tiny;
  tiny.room_with_pillars();
  const scene::scene s = tiny.finished();
  settings how = quick(slack_profile::exact);
  const auto without = baked(s, how, path_);
  recode_settings with;
  with.importance_in = &s;
  with.on_progress = [](std::uint32_t, std::uint32_t) { return false; };
  const auto other = folder_ / "other.pvs";
  EXPECT_TRUE(recode(without, "in.pvs", with, other).cancelled);
  EXPECT_FALSE(std::filesystem::exists(other));
  how.file.importance = true;
  const auto whole = baked(s, how, path_);
  const callbacks impatient{.on_progress = [](const progress& now) { return now.importance == 0.0; }, .on_message = {}};
  EXPECT_EQ(bake(s, how, other, false, impatient).result, outcome::cancelled);
  EXPECT_FALSE(std::filesystem::exists(other));
  const summary sum = bake(s, how, other, false, {});
  EXPECT_EQ(sum.cells_resumed, sum.cells);
  EXPECT_TRUE(test::file_bytes(other) == whole);
}

TEST_F(importance_test, shards_are_refused) {
  tiny_scene tiny;
  tiny.room_with_pillars();
  settings how = quick(slack_profile::exact);
  how.file.importance = true;
  EXPECT_EQ(test::error_id([&] {
              (void)bake_shard(tiny.finished(), how, path_, {0, 2, 1}, true, {});
            }),
            "shard.importance");
}

}  // namespace
}  // namespace sightcell::bake
