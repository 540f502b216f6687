// Bakes with --closed: doors that occlude.
#include <gtest/gtest.h>

#include <algorithm>

#include "errors/error_id.h"
#include "order/draw_table.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/recode.h"
#include "sightcell/bake/verify.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using ids = std::vector<std::uint32_t>;
using names = std::vector<std::string>;

// Two rooms of 4 x 3 x 6 m, one behind the other, with two doorways of 1 x 2 m in the wall between them. The doors are
// sheets in the doorways; behind each is a picture on the far wall.
struct rooms_with_doors {
  std::uint32_t left_door = 0, right_door = 0, far_wall = 0;
  scene::scene s;

  rooms_with_doors() {
    test::tiny_scene t;
    const test::tiny_scene::look sheet{scene::alpha_mode::opaque, true};
    const auto upright = [&](float x0, float x1, float y0, float y1, float z) {
      return t.quad({x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}, sheet);
    };
    t.closed_box({-4, 0, -3}, {4, 3, 3}, true);
    for (const auto& [from, to] : {std::pair(-4.0f, -2.5f), {-1.5f, 1.5f}, {2.5f, 4.0f}}) upright(from, to, 0, 3, 0);
    for (const float at : {-2.0f, 2.0f}) upright(at - 0.5f, at + 0.5f, 2, 3, 0);
    left_door = upright(-2.5f, -1.5f, 0, 2, 0);
    right_door = upright(1.5f, 2.5f, 0, 2, 0);
    far_wall = upright(-3.9f, 3.9f, 0.1f, 2.9f, -2.9f);
    t.group(left_door, "left");
    t.group(right_door, "right \"door\"");
    s = t.finished();
  }
};

class closed_groups : public testing::Test {
 protected:
  std::vector<std::byte> baked(const names& closed) {
    const settings how = settings_with(closed);
    EXPECT_EQ(bake(rooms_.s, how, path(), true, {}).result, outcome::done);
    return test::file_bytes(path());
  }

  static settings settings_with(const names& closed) {
    settings how;
    how.cells = {{"front", {-3.5f, 1.0f, 1.0f}, {3.5f, 1.8f, 2.5f}}};
    how.max_pixel_error = 1e-3;
    how.source = "cpu";
    how.file.profile = slack_profile::exact;
    how.closed = closed;
    return how;
  }

  static ids set_of(const std::vector<std::byte>& file) {
    format::reader opened;
    format::set_reader sets;
    ids out;
    EXPECT_EQ(format::reader::open(file, opened), format::status::ok);
    EXPECT_EQ(sets.open(opened), format::status::ok);
    EXPECT_EQ(sets.source_ids(0, out), format::status::ok);
    return out;
  }

  static names groups_of(const std::vector<std::byte>& file) {
    format::reader opened;
    names out;
    EXPECT_EQ(format::reader::open(file, opened), format::status::ok);
    for (std::uint32_t i = 0; i < opened.named_groups().count(); ++i) {
      std::string_view name;
      EXPECT_TRUE(opened.named_groups().name(i, name));
      out.emplace_back(name);
    }
    return out;
  }

  std::uint64_t misses_of(const std::vector<std::byte>& file) {
    return verify(rooms_.s, file, "rooms.pvs", {.rays = 50'000}, {}).misses;
  }

  std::filesystem::path path() const { return folder_.path() / "rooms.pvs"; }

  test::fresh_folder folder_;
  const rooms_with_doors rooms_;
};

bool has(const ids& set, std::uint32_t polygon) {
  return std::binary_search(set.begin(), set.end(), polygon);
}

TEST_F(closed_groups, hide_what_is_behind_them) {
  const auto open = baked({}), half = baked({"left"}), closed = baked({"left", "right \"door\""});
  for (const auto* file : {&open, &half, &closed}) {
    EXPECT_TRUE(has(set_of(*file), rooms_.left_door));
    EXPECT_TRUE(has(set_of(*file), rooms_.right_door));
    EXPECT_EQ(misses_of(*file), 0u) << "verify closes the same doors";
  }
  EXPECT_TRUE(has(set_of(open), rooms_.far_wall));
  EXPECT_TRUE(has(set_of(half), rooms_.far_wall)) << "through the other door";
  EXPECT_FALSE(has(set_of(closed), rooms_.far_wall));
}

TEST_F(closed_groups, are_no_named_groups_of_the_file) {
  EXPECT_EQ(groups_of(baked({})), (names{"left", "right \"door\""}));
  EXPECT_EQ(groups_of(baked({"left"})), (names{"right \"door\""}));
  EXPECT_TRUE(groups_of(baked({"right \"door\"", "left"})).empty());
}

TEST_F(closed_groups, stay_closed_when_names_come_from_the_scene_again) {
  const auto file = baked({"left"});
  recode_settings how;
  how.layout = host_layout::merged;
  how.layout_from = &rooms_.s;
  const std::filesystem::path out = folder_.path() / "merged.pvs";
  (void)recode(file, "rooms.pvs", how, out);
  EXPECT_EQ(groups_of(test::file_bytes(out)), (names{"right \"door\""}));
  EXPECT_EQ(misses_of(test::file_bytes(out)), 0u);
}

TEST_F(closed_groups, have_one_text_in_any_order) {
  const std::string text = describe(settings_with({"left", "right \"door\"", "left"}));
  EXPECT_EQ(text, describe(settings_with({"right \"door\"", "left"})));
  EXPECT_NE(text.find(R"(,"closed":["left","right \"door\""])"), std::string::npos) << text;
  EXPECT_EQ(describe(settings_with({})).find("closed"), std::string::npos);
}

TEST_F(closed_groups, that_the_scene_does_not_have_are_refused) {
  EXPECT_EQ(test::error_id([&] { (void)bake(rooms_.s, settings_with({"lefd"}), path(), true, {}); }),
            "settings.no-such-group");
}

TEST(remove_closed_groups, numbers_the_others_anew) {
  std::vector<format::draw_record> draws(5);
  for (std::uint32_t i = 0; i < 4; ++i) draws[i].named_group = 3 - i;
  names groups{"a", "b", "c", "d"};
  remove_closed_groups(names{"d", "b", "of another scene"}, groups, draws);
  EXPECT_EQ(groups, (names{"a", "c"}));
  const std::uint32_t none = format::no_named_group;
  EXPECT_EQ((ids{draws[0].named_group, draws[1].named_group, draws[2].named_group, draws[3].named_group,
                 draws[4].named_group}),
            (ids{none, 1, none, 0, none}));
}

}  // namespace
}  // namespace sightcell::bake
