// Files with lights: what a bake finds, and a polygon that is taken out of the set of a light.
#include "sightcell/bake/verify_lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <string>

#include "errors/error_id.h"
#include "file/light_sets.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/patch.h"
#include "sightcell/bake/recode.h"
#include "sightcell/base/error.h"
#include "sightcell/base/random.h"
#include "sightcell/format/light_writer.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using polygon_list = std::vector<std::uint32_t>;
using baked_bytes = std::vector<std::byte>;

constexpr float no_range = std::numeric_limits<float>::infinity();

// Two closed rooms side by side, and a row of 20 tiles of a meter on the floor of the first.
class lamps : public testing::Test {
 protected:
  lamps() {
    test::tiny_scene tiny;
    first_room_ = tiny.closed_box({-12, -0.5f, -3}, {-0.1f, 3, 3}, true);
    second_room_ = tiny.closed_box({0.1f, -0.5f, -3}, {12, 3, 3}, true);
    tiles_ = first_room_ + 24;
    for (int i = 0; i < 10; ++i) {
      const float x = -11.0f + static_cast<float>(i);
      tiny.quad({x, 0, 1}, {x + 1, 0, 1}, {x + 1, 0, 0}, {x, 0, 0});
    }
    shade_ = tiny.closed_box({5, 1, -1}, {5.4f, 1.4f, -0.6f});
    scene_ = tiny.finished();
  }

  void add(glm::vec3 at, float range = no_range, float cone = 0.0f) {
    scene_.lights.push_back({.node = static_cast<std::uint32_t>(7 + scene_.lights.size()),
                             .position = {at.x, at.y, at.z},
                             .direction = {0, -1, 0},
                             .range = range,
                             .cone = cone});
  }

  settings how() const {
    settings s;
    s.cells = {{"first", {-7, 1, -1}, {-6, 1.8f, 0}}, {"second", {7, 1, 0.5f}, {8, 1.8f, 1.5f}}};
    s.max_pixel_error = 1e-3;
    s.source = "cpu";
    s.file.profile = slack_profile::exact;
    s.lights = true;
    return s;
  }

  baked_bytes baked(const settings& s) {
    warnings_.clear();
    const summary result = bake(scene_, s, path(), true, {.on_message = [&](severity bad, const std::string& line) {
                                  if (bad == severity::warning) warnings_.push_back(line);
                                }});
    EXPECT_EQ(result.result, outcome::done);
    sum_ = result.lights.value_or(light_summary{});
    EXPECT_EQ(result.lights.has_value(), s.lights);
    return test::file_bytes(path());
  }
  baked_bytes baked() { return baked(how()); }

  // What each light reaches.
  static std::vector<polygon_list> sets_in(const baked_bytes& file) {
    format::reader opened;
    light_set_reader lights;
    EXPECT_EQ(format::reader::open(file, opened), format::status::ok);
    EXPECT_EQ(lights.open(opened), format::status::ok);
    std::vector<polygon_list> sets(lights.table().light_count());
    for (std::uint32_t i = 0; i < sets.size(); ++i) EXPECT_EQ(lights.source_ids(i, sets[i]), format::status::ok);
    return sets;
  }

  static bool touches(const baked_bytes& file, std::uint32_t cell, std::uint32_t light) {
    format::reader opened;
    format::light_table table;
    EXPECT_EQ(format::reader::open(file, opened), format::status::ok);
    EXPECT_EQ(format::light_table::open(opened, table), format::status::ok);
    return table.touches(cell, light);
  }

  // The cell of the file that is in the first room.
  static std::uint32_t first_cell(const baked_bytes& file) {
    format::reader opened;
    format::box box;
    EXPECT_EQ(format::reader::open(file, opened), format::status::ok);
    EXPECT_EQ(opened.cell_box(0, box), format::status::ok);
    return box.max[0] < 0.0f ? 0 : 1;
  }

  static bool all_between(const polygon_list& set, std::uint32_t first, std::uint32_t end) {
    return std::all_of(set.begin(), set.end(), [&](std::uint32_t p) { return p >= first && p < end; });
  }

  std::filesystem::path path(const char* name = "rooms.pvs") const { return folder_.path() / name; }

  test::fresh_folder folder_;
  std::uint32_t first_room_ = 0, second_room_ = 0, tiles_ = 0, shade_ = 0;
  scene::scene scene_;
  light_summary sum_;
  std::vector<std::string> warnings_;
};

TEST_F(lamps, reach_their_own_room_only_and_touch_the_cell_in_it) {
  add({-6, 2.5f, 0});
  add({6, 2.5f, 0});
  const baked_bytes file = baked();
  EXPECT_TRUE(warnings_.empty());
  EXPECT_EQ(sum_.lights, 2u);
  EXPECT_EQ(sum_.inside_solids, 0u);
  EXPECT_EQ(sum_.over_bound, 0u);
  EXPECT_LE(sum_.max_upper_bound, 1e-3);
  EXPECT_DOUBLE_EQ(sum_.lights_per_cell, 1.0);
  const auto sets = sets_in(file);
  ASSERT_EQ(sets.size(), 2u);
  for (std::uint32_t polygon = first_room_; polygon < second_room_; ++polygon)
    EXPECT_TRUE(std::binary_search(sets[0].begin(), sets[0].end(), polygon)) << polygon;
  for (std::uint32_t polygon = tiles_; polygon < shade_; ++polygon)
    EXPECT_TRUE(std::binary_search(sets[0].begin(), sets[0].end(), polygon)) << polygon;
  EXPECT_EQ(sets[0].size(), 12u + 20u);
  for (std::uint32_t polygon = second_room_; polygon < tiles_; ++polygon)
    EXPECT_TRUE(std::binary_search(sets[1].begin(), sets[1].end(), polygon)) << polygon;
  EXPECT_LT(sets[1].size(), 12u + 12u) << "the shade turns some sides away";
  const std::uint32_t cell = first_cell(file);
  EXPECT_TRUE(touches(file, cell, 0));
  EXPECT_FALSE(touches(file, cell, 1));
  EXPECT_FALSE(touches(file, 1 - cell, 0));
  EXPECT_TRUE(touches(file, 1 - cell, 1));
  const light_verification v = verify_lights(scene_, file, "rooms.pvs", {.rays = 20'000}, {});
  EXPECT_EQ(v.lights, 2u);
  EXPECT_EQ(v.rays, 20'000u);
  EXPECT_LE(v.upper_bound, 1e-3);
}

TEST_F(lamps, reach_as_far_as_their_range_and_cone) {
  add({-6, 2, 0.5f}, 2.5f);
  add({-6, 2, 0.5f}, no_range, 0.4f);
  const auto sets = sets_in(baked());
  // Tiles of the first one: within sqrt(2.5^2 - 2^2) = 1.5 m of the lamp, those from x = -7.5 to -4.5.
  const auto tiles_of = [&](const polygon_list& set) {
    return std::count_if(set.begin(), set.end(), [&](std::uint32_t p) { return p >= tiles_ && p < shade_; });
  };
  EXPECT_EQ(tiles_of(sets[0]), 2 * 4);
  // Of the second one within 2 tan(0.4) = 0.85 m, and a little more by the sphere around each triangle.
  EXPECT_GE(tiles_of(sets[1]), 2 * 2);
  EXPECT_LE(tiles_of(sets[1]), 2 * 4);
  const auto has = [](const polygon_list& set, std::uint32_t p) {
    return std::binary_search(set.begin(), set.end(), p);
  };
  EXPECT_TRUE(has(sets[1], tiles_ + 2 * 4));
  EXPECT_TRUE(has(sets[1], tiles_ + 2 * 5));
  EXPECT_FALSE(has(sets[1], tiles_));
}

TEST_F(lamps, inside_a_shade_need_it_to_be_a_non_occluder) {
  add({5.2f, 1.2f, -0.8f});
  const baked_bytes dark = baked();
  EXPECT_EQ(sum_.inside_solids, 1u);
  EXPECT_EQ(warnings_.size(), 1u);
  EXPECT_TRUE(sets_in(dark)[0].empty());
  EXPECT_FALSE(touches(dark, 0, 0) || touches(dark, 1, 0));
  EXPECT_EQ(verify_lights(scene_, dark, "rooms.pvs", {.rays = 1'000}, {}).inside_solids, 1u);
  scene_.draws.back().tags.occluder = false;
  scene::finish(scene_);
  const baked_bytes lit = baked();
  EXPECT_EQ(sum_.inside_solids, 0u);
  EXPECT_TRUE(warnings_.empty());
  EXPECT_GE(sets_in(lit)[0].size(), 12u);
  EXPECT_TRUE(touches(lit, 1 - first_cell(lit), 0));
}

TEST_F(lamps, that_move_or_do_not_exist_are_left_out) {
  const baked_bytes none = baked();
  EXPECT_EQ(warnings_.size(), 1u);
  EXPECT_EQ(sum_.lights, 0u);
  EXPECT_EQ(test::error_id([&] { verify_lights(scene_, none, "rooms.pvs", {}, {}); }), "pvs.no-lights");
  add({-6, 2.5f, 0});
  add({6, 2.5f, 0});
  scene_.lights[0].moves = true;
  const baked_bytes one = baked();
  EXPECT_EQ(warnings_.size(), 1u);
  EXPECT_EQ(sum_.lights, 1u);
  EXPECT_FALSE(touches(one, first_cell(one), 0));
}

TEST_F(lamps, change_nothing_else_in_the_file_and_do_not_depend_on_threads) {
  add({-6, 2.5f, 0});
  add({6, 2.5f, 0}, 4.0f, 0.7f);
  settings s = how();
  s.threads = 1;
  const baked_bytes with = baked(s);
  s.threads = 3;
  EXPECT_TRUE(baked(s) == with);
  // The set of a light depends on this light alone.
  std::swap(scene_.lights[0], scene_.lights[1]);
  const auto swapped = sets_in(baked(s)), sets = sets_in(with);
  EXPECT_EQ(swapped[0], sets[1]);
  EXPECT_EQ(swapped[1], sets[0]);
  baked_bytes without;
  ASSERT_EQ(format::remove_lights(with, without), format::status::ok);
  s.lights = false;
  EXPECT_EQ(without.size(), baked(s).size() + std::string(R"(,"lights":true)").size()) << "the settings name them";
}

TEST_F(lamps, that_lack_a_polygon_are_found_and_it_is_named) {
  add({-6, 2.5f, 0});
  add({6, 2.5f, 0});
  const baked_bytes file = baked();
  std::vector<polygon_list> sets = sets_in(file);
  std::erase(sets[1], second_room_ + 6);
  format::reader opened;
  format::light_table table;
  ASSERT_EQ(format::reader::open(file, opened), format::status::ok);
  ASSERT_EQ(format::light_table::open(opened, table), format::status::ok);
  format::light_source source;
  std::vector<format::certificate_record> proofs(2);
  for (std::uint32_t light = 0; light < 2; ++light) {
    ASSERT_EQ(table.light(light, source.lights.emplace_back()), format::status::ok);
    ASSERT_EQ(table.sets().certificate(light, light, proofs[light]), format::status::ok);
  }
  source.sets = format::sets_of(sets);
  source.certificate = proofs;
  source.touches = [&](std::uint32_t cell, std::uint32_t light) { return table.touches(cell, light); };
  baked_bytes faulty;
  ASSERT_EQ(format::put_lights(file, source, faulty), format::status::ok);
  const light_verification v = verify_lights(scene_, faulty, "rooms.pvs", {.rays = 10'000}, {});
  EXPECT_GT(v.upper_bound, 1e-3);
  ASSERT_EQ(v.missing.size(), 1u);
  EXPECT_EQ(v.missing[0].polygon, second_room_ + 6);
  EXPECT_EQ(v.missing[0].cell, 1u);
  EXPECT_EQ(v.missing[0].rays, v.misses);
}

TEST_F(lamps, stay_with_a_file_that_is_recoded_or_patched) {
  add({-6, 2.5f, 0});
  add({6, 2.5f, 0});
  const baked_bytes file = baked();
  const std::uint32_t cell = first_cell(file);
  recode(file, "rooms.pvs", {.profile = slack_profile::small, .order = polygon_order_kind::per_instance},
         path("recoded.pvs"));
  // The cell of the first room sees a polygon of the second one too.
  patch(file, "rooms.pvs", std::vector<added_polygons>{{.cell = cell, .first = second_room_, .count = 1}},
        path("patched.pvs"));
  for (const char* name : {"recoded.pvs", "patched.pvs"}) {
    const baked_bytes made = test::file_bytes(path(name));
    EXPECT_EQ(sets_in(made), sets_in(file)) << name;
    EXPECT_TRUE(touches(made, cell, 0)) << name;
    EXPECT_TRUE(touches(made, 1 - cell, 1)) << name;
    EXPECT_FALSE(touches(made, 1 - cell, 0)) << name;
  }
  EXPECT_TRUE(touches(test::file_bytes(path("patched.pvs")), cell, 1));
}

// A millionth to a hundred thousandth of all directions each: chance decides which crumbs a search finds. So its random
// numbers show in the sets.
class lamps_among_crumbs : public testing::Test {
 protected:
  // What a bake finds of a light.
  struct found {
    polygon_list set;
    std::uint64_t rays = 0, misses = 0;
    double upper_bound = 1.0;
    bool operator==(const found&) const = default;
  };
  using found_lights = std::map<std::uint32_t, found>;  // by node

  lamps_among_crumbs() {
    test::tiny_scene tiny;
    tiny.closed_box({-10, -1, -10}, {10, 5, 10}, true);
    random_stream random(1, 2, purpose::viewpoints);
    for (int i = 0; i < 3000; ++i) {
      const glm::vec3 at = random.in_box({-9, 0, -9}, {9, 4, 9});
      tiny.triangle(at, at + glm::vec3(0.03f, 0, 0), at + glm::vec3(0, 0.03f, 0), {.double_sided = true});
    }
    scene_ = tiny.finished();
    const glm::vec3 places[] = {{-6, 2.5f, 3}, {-2, 1.5f, -5}, {1, 3, 1}, {4, 2, -3}, {6, 1, 6}, {7, 3.5f, -7}};
    for (const glm::vec3& at : places)
      lights_.push_back({.node = static_cast<std::uint32_t>(lights_.size()),
                         .position = {at.x, at.y, at.z},
                         .direction = {0, -1, 0},
                         .range = no_range});
  }

  // order: numbers of lights, in the order of the scene.
  found_lights baked(const std::vector<std::uint32_t>& order, std::uint32_t threads, std::uint64_t seed = 1) {
    scene_.lights.clear();
    for (const std::uint32_t number : order) scene_.lights.push_back(lights_[number]);
    settings s;
    s.cells = {{"only", {-1, 1, -1}, {0, 1.8f, 0}}};
    s.max_pixel_error = 0.05;
    s.source = "cpu";
    s.resolution = 64;
    s.lights = true;
    s.threads = threads;
    s.seed = seed;
    const auto path = folder_.path() / "crumbs.pvs";
    EXPECT_NE(bake(scene_, s, path, true, {}).result, outcome::cancelled);
    const baked_bytes file = test::file_bytes(path);
    format::reader opened;
    light_set_reader reader;
    EXPECT_EQ(format::reader::open(file, opened), format::status::ok);
    EXPECT_EQ(reader.open(opened), format::status::ok);
    found_lights all;
    for (std::uint32_t i = 0; i < reader.table().light_count(); ++i) {
      format::light_record record;
      format::certificate_record proof;
      EXPECT_EQ(reader.table().light(i, record), format::status::ok);
      EXPECT_EQ(reader.table().sets().certificate(i, i, proof), format::status::ok);
      found& one = all[record.node];
      EXPECT_EQ(reader.source_ids(i, one.set), format::status::ok);
      one.rays = proof.rays, one.misses = proof.misses, one.upper_bound = proof.upper_bound;
    }
    return all;
  }

  test::fresh_folder folder_;
  scene::scene scene_;
  std::vector<scene::light> lights_;
};

TEST_F(lamps_among_crumbs, have_random_numbers_of_their_own_in_any_order_and_number_of_threads) {
  const found_lights all = baked({0, 1, 2, 3, 4, 5}, 1);
  ASSERT_EQ(all.size(), 6u);
  for (const auto& [node, other] : baked({0, 1, 2, 3, 4, 5}, 1, 2))
    EXPECT_NE(other.set, all.at(node).set) << "chance does not show: the test would prove nothing";
  EXPECT_TRUE(baked({0, 1, 2, 3, 4, 5}, 4) == all) << "depends on threads";
  EXPECT_TRUE(baked({4, 2, 5, 0, 3, 1}, 3) == all) << "depends on the order";
  for (const auto& [node, alone] : baked({3, 1}, 2))
    EXPECT_TRUE(alone == all.at(node)) << node << " depends on the others";
}

TEST_F(lamps, are_found_again_by_a_bake_that_was_interrupted_there) {
  add({-6, 2.5f, 0});
  add({6, 2.5f, 0}, 4.0f, 0.7f);
  settings s = how();
  s.suns = {{{150.0, 40.0}, {150.0, 40.0}}};
  const baked_bytes whole = baked(s);
  for (const bake_phase phase : {bake_phase::finding_casters, bake_phase::finding_lights}) {
    const auto broken = path("broken.pvs");
    callbacks events;
    events.on_progress = [phase](const progress& now) { return now.phase != phase; };
    EXPECT_EQ(bake(scene_, s, broken, false, events).result, outcome::cancelled);
    EXPECT_FALSE(std::filesystem::exists(broken));
    const summary resumed = bake(scene_, s, broken, false, {});
    EXPECT_EQ(resumed.cells_resumed, 2u);
    EXPECT_TRUE(test::file_bytes(broken) == whole);
    std::filesystem::remove(broken);
  }
}

TEST_F(lamps, settings_are_checked) {
  const auto id = [&](const auto& change) {
    settings s = how();
    change(s);
    return test::error_id([&] { validate(s); });
  };
  EXPECT_EQ(id([](settings&) {}), "");
  EXPECT_EQ(id([](settings& s) { s.max_pixel_error = 0.0; }), "settings.lights");
  EXPECT_EQ(id([](settings& s) { s.sampler = "halton"; }), "settings.lights");
  EXPECT_EQ(id([](settings& s) { s.time_budget = 60.0; }), "settings.lights");
}

}  // namespace
}  // namespace sightcell::bake
