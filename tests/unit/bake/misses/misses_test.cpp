// Polygons that a host found missing: read strictly, reproduced by rays alone, and joined where they are true.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "errors/error_id.h"
#include "file/pvs_output.h"
#include "job/cell_bake.h"
#include "misses/misses_file.h"
#include "misses/probe_polygon.h"
#include "misses/reported_misses.h"
#include "sightcell/bake/misses.h"
#include "sightcell/bake/shards.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

namespace fs = std::filesystem;
using test::error_id;
using test::tiny_scene;

// Twelve polygons.
scene::scene room() {
  tiny_scene tiny;
  tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  return tiny.finished();
}

std::string id_of(const std::string& text) {
  const scene::scene s = room();
  return error_id([&] { (void)parse_misses(text, "misses.json", s); });
}

std::string text_of(const std::vector<reported_miss>& misses) {
  std::string text;
  for (const reported_miss& m : misses)
    text += fmt::format(R"({}{{"eye":[{},{},{}],"polygon":{}}})", text.empty() ? "" : ",", m.eye.x, m.eye.y, m.eye.z,
                        m.polygon);
  return "{\"misses\":[" + text + "]}";
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(misses_file, holds_eyes_and_polygons_and_may_hold_more) {
  const scene::scene s = room();
  const std::string own = fmt::format("{:02X}", fmt::join(s.fingerprint, ""));
  const auto misses = parse_misses(R"({"frame":7,"scene_fingerprint":")" + own +
                                       R"(","misses":[{"eye":[1,-0.5,2e0],"polygon":11,"seen_by":"left eye"},
                                          {"polygon":0,"eye":[-0.0,0,0]}]})",
                                   "misses.json", s);
  EXPECT_EQ(misses, (std::vector<reported_miss>{{{1.0f, -0.5f, 2.0f}, 11}, {{0.0f, 0.0f, 0.0f}, 0}}));
  EXPECT_FALSE(std::signbit(misses[1].eye.x)) << "the same place has the same bits";
  EXPECT_TRUE(parse_misses(R"({"misses":[]})", "misses.json", s).empty());
}

TEST(misses_file, what_is_wrong_is_refused) {
  for (const char* text : {"", "{", R"({"misses":[{"eye":[1e999,0,0],"polygon":1}]})"})
    EXPECT_EQ(id_of(text), "misses.not-json") << text;
  for (const char* text : {"[]", "7", "{}", R"({"misses":7})", R"({"misses":{"eye":[0,0,0],"polygon":1}})"})
    EXPECT_EQ(id_of(text), "misses.no-list") << text;
  for (const char* text :
       {R"({"misses":[7]})", R"({"misses":[{"polygon":1}]})", R"({"misses":[{"eye":[0,0],"polygon":1}]})",
        R"({"misses":[{"eye":[0,0,0,0],"polygon":1}]})", R"({"misses":[{"eye":"0,0,0","polygon":1}]})",
        R"({"misses":[{"eye":[0,null,0],"polygon":1}]})", R"({"misses":[{"eye":[0,"0",0],"polygon":1}]})",
        R"({"misses":[{"eye":[0,1e39,0],"polygon":1}]})", R"({"misses":[{"eye":[0,0,0]}]})",
        R"({"misses":[{"eye":[0,0,0],"polygon":-1}]})", R"({"misses":[{"eye":[0,0,0],"polygon":1.0}]})",
        R"({"misses":[{"eye":[0,0,0],"polygon":"1"}]})", R"({"scene_fingerprint":7,"misses":[]})",
        R"({"scene_fingerprint":"00","misses":[]})",
        R"({"scene_fingerprint":"0000000000000000000000000000000g","misses":[]})"})
    EXPECT_EQ(id_of(text), "misses.bad-report") << text;
  for (const char* text :
       {R"({"misses":[{"eye":[0,0,0],"polygon":12}]})", R"({"misses":[{"eye":[0,0,0],"polygon":4294967297}]})"})
    EXPECT_EQ(id_of(text), "misses.no-such-polygon") << text;
  EXPECT_EQ(id_of(R"({"scene_fingerprint":"00000000000000000000000000000000","misses":[]})"), "misses.other-scene");
  const scene::scene s = room();
  try {
    (void)parse_misses(R"({"misses":[{"eye":[0,0,0],"polygon":1},{"eye":[0,0,0]}]})", "some/misses.json", s);
    FAIL();
  } catch (const error& e) {
    EXPECT_NE(std::string(e.what()).find("some/misses.json: miss 1 has no \"polygon\""), std::string::npos) << e.what();
  }
}

TEST(misses_file, of_a_size_that_no_host_writes_is_refused_unread) {
  const test::fresh_folder folder;
  const scene::scene s = room();
  write_text(folder / "large.json", "{}");
  fs::resize_file(folder / "large.json", (16u << 20) + 1);
  EXPECT_EQ(error_id([&] { (void)read_misses(folder / "large.json", s); }), "misses.too-large");
  EXPECT_EQ(error_id([&] { (void)read_misses(folder / "none.json", s); }), "misses.unreadable");
  EXPECT_EQ(error_id([&] { (void)read_misses(folder.path(), s); }), "misses.unreadable");
  write_text(folder / "one.json", text_of({{{1, 1, 1}, 3}}));
  EXPECT_EQ(read_misses(folder / "one.json", s).size(), 1u);
}

TEST(reported_misses, belong_to_the_cells_that_the_runtime_may_be_in) {
  const reported_misses known(
      {{{1.25f, 0, 0}, 5}, {{1.2f, 0, 0}, 5}, {{-0.25f, 0, 0}, 5}, {{0, 0, 1.5f}, 5}, {{1.2f, 0, 0}, 5}});
  EXPECT_EQ(known.all().size(), 4u) << "one is there twice";
  const auto found = known.in({0, 0, 0}, {1, 1, 1}, 0.25f);
  std::vector<glm::vec3> eyes;
  for (const std::uint32_t place : found) eyes.push_back(known.all()[place].eye);
  EXPECT_EQ(eyes, (std::vector<glm::vec3>{{-0.25f, 0, 0}, {1.2f, 0, 0}})) << "half-open, as the runtime asks";
  EXPECT_TRUE(known.in({0, 0, 0}, {1, 1, 1}, 0.0f).empty());
}

TEST(reported_misses, tell_which_blocks_have_others) {
  std::vector<view_cell> cells;
  for (int i = 0; i < 4; ++i) {
    view_cell& cell = cells.emplace_back();
    cell.min = {2.0f * static_cast<float>(i), 0, 0}, cell.max = cell.min + 2.0f;
    cell.number = static_cast<std::uint32_t>(i);
  }
  const cell_blocks blocks(cells, 0.25f);
  ASSERT_EQ(blocks.count(), 4u);
  const auto key = [&](std::vector<reported_miss> misses, const char* words = "scene 00 settings ") {
    const reported_misses known(std::move(misses));
    return words + with_misses(R"({"seed":1})", known, '"' + known.key_of(blocks, cells, 0.25f) + '"');
  };
  const auto none = key({}), one = key({{{1, 1, 1}, 7}}), at_border = key({{{2.1f, 1, 1}, 7}});
  EXPECT_EQ(none, R"(scene 00 settings {"seed":1})");
  using numbers = std::vector<std::uint32_t>;
  EXPECT_EQ(blocks_with_other_misses(none, none), numbers{});
  EXPECT_EQ(blocks_with_other_misses(none, one), numbers{0});
  EXPECT_EQ(blocks_with_other_misses(one, none), numbers{0});
  EXPECT_EQ(blocks_with_other_misses(one, key({{{1, 1, 1}, 8}})), numbers{0});
  EXPECT_EQ(blocks_with_other_misses(one, at_border), (numbers{0, 1}));
  EXPECT_EQ(blocks_with_other_misses(at_border, key({{{2.1f, 1, 1}, 7}, {{7, 1, 1}, 7}})), numbers{3});
  EXPECT_EQ(blocks_with_other_misses(one, key({{{1, 1, 1}, 7}, {{99, 1, 1}, 7}})), numbers{}) << "in no cell";
  EXPECT_FALSE(blocks_with_other_misses(one, key({}, "scene 01 settings ")));
  EXPECT_FALSE(blocks_with_other_misses(one, R"(scene 00 settings {"seed":2})"));
  EXPECT_FALSE(blocks_with_other_misses(one, "scene 00"));

  const auto is_stale = stale_records({1}, blocks);
  EXPECT_TRUE(is_stale(1, cell_stage::sampled));
  EXPECT_TRUE(is_stale(1, cell_stage::bounded));
  EXPECT_FALSE(is_stale(0, cell_stage::bounded));
  EXPECT_TRUE(is_stale(0, cell_stage::finished)) << "it has read what its neighbor found";
  EXPECT_FALSE(is_stale(3, cell_stage::finished)) << "it has not";
  EXPECT_TRUE(is_stale(99, cell_stage::bounded)) << "there is no such cell";
}

class aimed_rays : public testing::Test {
 protected:
  polygon_sight look(tiny_scene& tiny, const glm::vec3& eye, std::uint32_t polygon, float gap = 0.0f,
                     const std::vector<std::uint32_t>& set = {}) {
    const scene::scene s = tiny.finished();
    const scene::world_geometry geometry = scene::flatten(s);
    const ray_scene rays(geometry, false);
    return probe_polygon(rays, gap, eye, polygon,
                         [&](std::uint32_t other) { return std::find(set.begin(), set.end(), other) != set.end(); });
  }
};

TEST_F(aimed_rays, find_a_polygon_through_a_hole_of_a_few_pixels) {
  // 9 x 9 m of a wall 4 m behind another one, which leaves a hole of 12 x 12 mm open: 3e-5 of 1.6 sr.
  tiny_scene tiny;
  constexpr float low = 0.7f, high = 0.712f, left = 0.3f, right = 0.312f;
  const tiny_scene::look sheet{scene::alpha_mode::opaque, true};
  tiny.quad({2, -9, 9}, {2, -9, right}, {2, 9, right}, {2, 9, 9}, sheet);
  tiny.quad({2, -9, left}, {2, -9, -9}, {2, 9, -9}, {2, 9, left}, sheet);
  tiny.quad({2, -9, right}, {2, -9, left}, {2, low, left}, {2, low, right}, sheet);
  tiny.quad({2, high, right}, {2, high, left}, {2, 9, left}, {2, 9, right}, sheet);
  const auto behind = tiny.wall_x(6, -1, 4.5f);
  const polygon_sight a = look(tiny, {0, 0, 0}, behind), b = look(tiny, {0, 0, 0}, behind + 1);
  EXPECT_NE(a.seen, b.seen) << "the line through the hole meets one of both";
  EXPECT_TRUE((a.seen ? a : b).counts);
  const polygon_sight& hidden = a.seen ? b : a;
  EXPECT_GT(hidden.rays, 10'000u);
  EXPECT_LE(hidden.rays, 1u << 18);
}

TEST_F(aimed_rays, know_the_rules_of_seeing) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(4, -1, 3), hidden = tiny.wall_x(5, -1, 1),
             glass = tiny.wall_x(3, -1, 1, {scene::alpha_mode::blend, false});
  const auto away = tiny.wall_x(-4, -1, 3), decal = tiny.wall_x(4.0001f, -1, 0.5f);
  EXPECT_TRUE(look(tiny, {0, 0, 0}, wall).counts);
  EXPECT_TRUE(look(tiny, {0, 0, 0}, glass).counts) << "it is passed on the way to the wall";
  EXPECT_FALSE(look(tiny, {0, 0, 0}, hidden).seen);
  EXPECT_EQ(look(tiny, {0, 0, 0}, away).rays, 0u) << "its back";
  EXPECT_TRUE(look(tiny, {0, 0, 0}, decal).counts) << "it lies in the wall";
  const polygon_sight excused = look(tiny, {0, 0, 0}, decal, 0.0f, {wall, wall + 1});
  EXPECT_TRUE(excused.seen);
  EXPECT_FALSE(excused.counts) << "the wall is in the set (rule 2)";
  EXPECT_TRUE(look(tiny, {0, 0, 0}, wall, 0.0f, {decal, decal + 1}).counts) << "the decal is not all over it";

  tiny_scene cracked;  // 1 mm wide
  cracked.quad({2, -9, 9}, {2, -9, 0.001f}, {2, 9, 0.001f}, {2, 9, 9}, {scene::alpha_mode::opaque, true});
  cracked.quad({2, -9, 0}, {2, -9, -9}, {2, 9, -9}, {2, 9, 0}, {scene::alpha_mode::opaque, true});
  const auto behind = cracked.wall_x(2.5f, -1, 0.5f);
  const auto seen = [&](float gap) {
    return look(cracked, {0, 0, 0}, behind, gap).seen || look(cracked, {0, 0, 0}, behind + 1, gap).seen;
  };
  EXPECT_TRUE(seen(0.0f));
  EXPECT_FALSE(seen(0.002f)) << "only through a crack (rule 3)";
}

// What lies behind the deep slit is seen from above the cell alone, from its margin: a weak bake misses it.
class a_miss : public testing::Test {
 protected:
  a_miss() {
    tiny_scene tiny;
    behind_ = tiny.deep_slit();
    near_ = tiny.wall_x(-0.2f, 1, 0.3f);
    tiny.triangle({0.08f, 0.4f, 1.04f}, {0.12f, 0.4f, 1.04f}, {0.1f, 0.4f, 1.07f},
                  {scene::alpha_mode::opaque, true});  // too near to unfree_
    scene_ = tiny.finished();
    how_.cells = {{"", {0, -0.5f, 0}, {0.5f, 0.5f, 0.85f}}, {"", {-31, 0, 0}, {-30, 1, 1}}};
    how_.source = "cpu";
    how_.sampler = "halton";
    how_.resolution = 16;
    how_.samples = 6;
    how_.max_pixel_error = 0.0;
    how_.file.profile = slack_profile::exact;
  }

  fs::path baked(const char* name) {
    (void)bake(scene_, how_, folder_ / name, true, {});
    return folder_ / name;
  }
  fs::path reported(const std::vector<reported_miss>& misses) {
    write_text(folder_ / "misses.json", text_of(misses));
    return folder_ / "misses.json";
  }
  miss_check check(const fs::path& file, const fs::path& misses) {
    return check_misses(scene_, test::file_bytes(file), file.string(), misses, {.threads = 2}, {});
  }

  reported_miss true_one() const { return {{0.4f, 0, 1.09f}, behind_}; }
  static constexpr glm::vec3 unfree_{0.1f, 0.42f, 1.05f};  // sees what is behind, too

  test::fresh_folder folder_;
  scene::scene scene_;
  settings how_;
  std::uint32_t behind_ = 0, near_ = 0;
};

TEST_F(a_miss, is_reproduced_by_rays_alone) {
  const fs::path file = baked("weak.pvs");
  const miss_check found = check(file, reported({true_one(),
                                                 true_one(),
                                                 {{0.25f, 0, 0.4f}, behind_},  // hidden from there
                                                 {unfree_, behind_ + 1},
                                                 {{0.25f, 0, 0.4f}, near_},       // in the set
                                                 {{0.4f, 0, 1.11f}, behind_}}));  // above the grown box
  EXPECT_EQ(found.reports, 5u) << "one came twice";
  EXPECT_EQ(found.reproduced, 1u);
  EXPECT_EQ(found.not_visible, 1u);
  EXPECT_EQ(found.not_free, 1u);
  EXPECT_EQ(found.not_missing, 1u);
  EXPECT_EQ(found.outside, 1u);
  ASSERT_EQ(found.list.size(), 1u);
  EXPECT_EQ(found.list[0].cell, 0u);
  EXPECT_EQ(found.list[0].polygon, behind_);
  EXPECT_EQ(found.list[0].eye, (std::array<float, 3>{0.4f, 0.0f, 1.09f}));
}

TEST_F(a_miss, is_repaired_by_a_bake_that_knows_it) {
  const fs::path weak = baked("weak.pvs");
  const fs::path misses =
      reported({true_one(), {{0.25f, 0, 0.4f}, behind_}, {{0.25f, 0, 0.4f}, behind_ + 1}, {unfree_, behind_ + 1}});
  ASSERT_EQ(check(weak, misses).reproduced, 1u);
  how_.misses_file = misses;
  const fs::path repaired = baked("repaired.pvs");
  const miss_check now = check(repaired, misses);
  EXPECT_EQ(now.reproduced, 0u);
  EXPECT_EQ(now.not_missing, 2u) << "one of them is not seen from its eye, and in the set";
  test::stored_file before(test::file_bytes(weak)), after(test::file_bytes(repaired));
  std::vector<std::uint32_t> expected = before.set(0);
  expected.push_back(behind_);
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(after.set(0), expected) << "what is not seen from where it was reported does not join";
  EXPECT_EQ(after.set(1), before.set(1));
  const std::string settings(after.reader().settings());
  EXPECT_NE(settings.find(R"("misses":4)"), std::string::npos) << settings;
  EXPECT_EQ(settings.find("misses.json"), std::string::npos) << settings;
  EXPECT_EQ(std::string(before.reader().settings()).find("misses"), std::string::npos);
}

TEST_F(a_miss, is_looked_beside_before_the_bound) {
  // Few rays are asked for, and they find nothing behind the slit; the hint shows the other half of it as well.
  how_.sampler = "guided";
  how_.max_pixel_error = 0.2;
  test::stored_file before(test::file_bytes(baked("weak.pvs")));
  ASSERT_FALSE(before.has(0, behind_) || before.has(0, behind_ + 1)) << "this scene shows nothing";
  how_.misses_file = reported({true_one()});
  test::stored_file after(test::file_bytes(baked("repaired.pvs")));
  EXPECT_TRUE(after.has(0, behind_));
  EXPECT_TRUE(after.has(0, behind_ + 1)) << "verified dilation did not begin at the eye";
}

TEST_F(a_miss, joins_where_cells_share_too) {
  how_.cells.clear();
  how_.cells_grid = {0, 0, 0, 0.4f, 0.2f, 0.8f};
  how_.cell_size = 0.4f;
  how_.margin = 0.2f;
  how_.sampler = "guided";
  how_.max_pixel_error = 0.2;
  const auto has = [&](const char* name) {
    test::stored_file file(test::file_bytes(baked(name)));
    EXPECT_EQ(file.reader().cell_count(), 2u);
    return file.has(0, behind_) || file.has(1, behind_);
  };
  ASSERT_FALSE(has("weak.pvs")) << "this scene shows nothing";
  how_.misses_file = reported({{{0, 0.1f, 0.97f}, behind_}});
  EXPECT_TRUE(has("repaired.pvs"));
}

TEST_F(a_miss, joins_in_the_first_turn_of_a_time_budget) {
  how_.sampler = "guided";
  how_.max_pixel_error = 0.2;
  how_.time_budget = 1e6;
  how_.misses_file = reported({true_one()});
  EXPECT_TRUE(test::stored_file(test::file_bytes(baked("timed.pvs"))).has(0, behind_));
}

TEST_F(a_miss, changes_no_byte_by_its_place_in_the_file_or_by_threads) {
  how_.sampler = "guided";
  how_.max_pixel_error = 0.05;
  const std::vector<reported_miss> misses{true_one(), {{0.3f, 0.1f, 1.08f}, behind_}, {{0.2f, 0, 1.05f}, behind_ + 1}};
  how_.misses_file = reported(misses);
  how_.threads = 1;
  const auto one = test::file_bytes(baked("a.pvs"));
  how_.misses_file = reported({misses[2], misses[0], misses[2], misses[1]});
  how_.threads = 3;
  EXPECT_EQ(test::file_bytes(baked("b.pvs")), one);
}

// A lattice of cells over four blocks of 8 x 8, in a room with pillars.
class misses_of_blocks : public testing::Test {
 protected:
  misses_of_blocks() {
    tiny_scene tiny;
    tiny.room_with_pillars();
    scene_ = tiny.finished();
    how_.cells_grid = {-8.0f, 0.0f, -8.0f, 8.0f, 0.5f, 8.0f};
    how_.cell_size = 1.0f;
    how_.source = "cpu";
    how_.resolution = 16;
    how_.samples = 6;
    how_.max_pixel_error = 0.1;
    how_.threads = 2;
    write_text(folder_ / "misses.json", text_of({{{-7.5f, 0.5f, -7.6f}, 0}, {{-6.4f, 0.2f, -7.6f}, 60}}));
  }
  std::vector<std::byte> baked(const char* name, bool fresh = true) {
    last_ = bake(scene_, how_, folder_ / name, fresh, {});
    return test::file_bytes(folder_ / name);
  }
  void begin(const char* name, std::uint32_t cells) {
    callbacks stop;
    stop.on_progress = [cells](const progress& now) { return now.cells_checked < cells; };
    ASSERT_EQ(bake(scene_, how_, folder_ / name, true, stop).result, outcome::cancelled);
  }

  test::fresh_folder folder_;
  scene::scene scene_;
  settings how_;
  summary last_;
};

TEST_F(misses_of_blocks, are_baked_anew_and_the_rest_of_an_unfinished_bake_is_kept) {
  const auto without = baked("without.pvs");
  how_.misses_file = folder_ / "misses.json";
  const auto with = baked("with.pvs");
  EXPECT_NE(with, without);
  const std::uint32_t cells = last_.cells;

  how_.misses_file.reset();
  begin("half.pvs", 40);
  how_.misses_file = folder_ / "misses.json";
  EXPECT_EQ(baked("half.pvs", false), with);
  EXPECT_GE(last_.cells_resumed, cells / 2) << "three of four blocks were through phase 1";
  EXPECT_LT(last_.cells_resumed, cells) << "the block of the misses was not";

  begin("half.pvs", 40);
  how_.misses_file.reset();
  EXPECT_EQ(baked("half.pvs", false), without);
  EXPECT_GE(last_.cells_resumed, cells / 2);
}

TEST_F(misses_of_blocks, are_those_of_all_shards) {
  how_.misses_file = folder_ / "misses.json";
  const auto whole = baked("whole.pvs");
  for (const std::uint32_t phase : {1u, 2u})
    for (const std::uint32_t i : {0u, 1u, 2u})
      EXPECT_EQ(bake_shard(scene_, how_, folder_ / "m.pvs", {i, 3, phase}, false, {}).result, outcome::done);
  (void)merge(find_shard_files(folder_ / "m.pvs"), folder_ / "m.pvs", {});
  EXPECT_EQ(test::file_bytes(folder_ / "m.pvs"), whole);
  how_.misses_file.reset();
  EXPECT_EQ(error_id([&] {
              (void)bake_shard(scene_, how_, folder_ / "m.pvs", {0, 3, 2}, false, {});
            }),
            "shard.other-bake");
}

}  // namespace
}  // namespace sightcell::bake
