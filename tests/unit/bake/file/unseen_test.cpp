// Which polygons no cell has, and what bounds say of them.
#include "sightcell/bake/unseen.h"

#include <gtest/gtest.h>

#include <functional>

#include "cells/overrides.h"
#include "errors/error_id.h"
#include "file/pvs_output.h"
#include "sightcell/bake/bake.h"
#include "sightcell/format/caster_writer.h"
#include "sightcell/format/light_writer.h"
#include "sightcell/scene/scene.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using ids = std::vector<std::uint32_t>;

// Six quads: polygons 2 n and 2 n + 1 are of node n.
scene::scene six_quads(const std::function<void(test::tiny_scene&)>& change = {}) {
  test::tiny_scene s;
  for (int n = 0; n < 6; ++n) s.wall_x(static_cast<float>(n), 1.0f, 1.0f);
  if (change) change(s);
  scene::scene out = s.finished();
  out.node_names = {"a", "b", "c", "d", "e", "f"};
  return out;
}

class unseen_test : public testing::Test {
 protected:
  // A file of cells with these sets; bounds: of each, above 1 for none.
  std::vector<std::byte> file_of(const scene::scene& s, const std::vector<ids>& sets, const std::vector<double>& bounds,
                                 settings how = {}, const overrides& given = {}) {
    std::vector<cell_record> records(sets.size());
    std::vector<view_cell> cells(sets.size());
    for (std::size_t cell = 0; cell < sets.size(); ++cell) {
      const float x = static_cast<float>(cell);
      cells[cell].min = {x, 0, 0}, cells[cell].max = {x + 1, 1, 1};
      records[cell].set = sets[cell];
      records[cell].valid_share = 1.0f;
      if (bounds[cell] >= 1.0) continue;
      records[cell].rays = 1000;
      records[cell].upper_bound = bounds[cell];
      records[cell].confidence = 0.975;
      records[cell].outside_share = 0.0009f;
      records[cell].region = {2 | 1 << 4};  // one half of the box
    }
    how.file.profile = slack_profile::exact;
    summary sum;
    const std::filesystem::path path = folder_ / "scene.pvs";
    write_pvs(
        frame_of(s, how, with_overrides(describe(how), given), cells),
        [&](std::uint32_t cell) { return records[cell]; }, path, {}, sum);
    return test::file_bytes(path);
  }

  test::fresh_folder folder_;
};

ids list_of(const std::vector<bool>& is_in) {
  ids out;
  for (std::uint32_t id = 0; id < is_in.size(); ++id)
    if (is_in[id]) out.push_back(id);
  return out;
}

TEST_F(unseen_test, are_in_no_set) {
  const scene::scene s = six_quads();
  const auto file = file_of(s, {{0, 1, 6, 11}, {0, 3, 6, 7}, {}}, {1e-3, 1e-4, 0.25});
  const unseen_polygons found = find_unseen(s, file, "scene.pvs");
  EXPECT_EQ(list_of(found.is_unseen), (ids{2, 4, 5, 8, 9, 10}));
  EXPECT_EQ(found.unseen, 6u);
  EXPECT_EQ(found.polygons, 12u);
  EXPECT_EQ(found.exempt, 0u);
  EXPECT_EQ(found.cells, 3u);
  EXPECT_TRUE(found.warnings.empty());
}

TEST_F(unseen_test, objects_with_the_most_come_first) {
  const scene::scene s = six_quads();
  const unseen_polygons found = find_unseen(s, file_of(s, {{0, 1, 3, 6, 7, 11}}, {1e-3}), "scene.pvs");
  std::string names;
  ids unseen;
  for (const unseen_object& o : found.objects) {
    names += o.name;
    unseen.push_back(o.unseen);
    EXPECT_EQ(o.polygons, 2u);
  }
  EXPECT_EQ(names, "cebfad");
  EXPECT_EQ(unseen, (ids{2, 2, 1, 1, 0, 0}));
}

TEST_F(unseen_test, what_sets_state_nothing_about_counts_as_seen) {
  const scene::scene s = six_quads([](test::tiny_scene& t) {
    t.tag(0, {.dynamic = true});
    t.tag(2, {.never = true});
    t.tag(4, {.always = true});
    t.tag(6, {.occluder = false});  // not exempt
  });
  overrides given;
  given.never = {{9, 1}};
  given.always = {{10, 1}};
  const unseen_polygons found = find_unseen(s, file_of(s, {{4}}, {1e-3}, {}, given), "scene.pvs");
  EXPECT_EQ(list_of(found.is_unseen), (ids{6, 7, 8, 11}));
  EXPECT_EQ(found.exempt, 8u);
}

TEST_F(unseen_test, draws_that_move_count_as_seen) {
  scene::scene s = six_quads();
  s.draws[2].moves = true;
  const unseen_polygons found = find_unseen(s, file_of(s, {{0}}, {1e-3}), "scene.pvs");
  EXPECT_EQ(found.exempt, 2u);
  EXPECT_FALSE(found.is_unseen[4]);
  EXPECT_TRUE(found.is_unseen[3]);
}

// A file with shadow casters of two cells and suns, by 2 * cell + sun.
std::vector<std::byte> with_casters(const std::vector<std::byte>& file, const std::vector<ids>& casters) {
  format::caster_source source;
  source.suns = {{{0, 1, 0}, {0, 1, 0}}, {{1, 0, 0}, {1, 0, 0}}};
  source.get = [&](std::uint32_t cell, std::uint32_t sun, ids& out) {
    out = casters[2 * cell + sun];
    return format::status::ok;
  };
  const std::vector<format::certificate_record> certificate(4);
  source.certificate = certificate;
  std::vector<std::byte> out;
  EXPECT_EQ(format::put_casters(file, source, out), format::status::ok);
  return out;
}

// A file with lights that reach these polygons.
std::vector<std::byte> with_lights(const std::vector<std::byte>& file, const std::vector<ids>& reached) {
  format::light_source source;
  for (const ids& set : reached) source.lights.push_back({.direction = {0, -1, 0}, .range = static_cast<float>(set.size())});
  source.sets = format::sets_of(reached);
  source.touches = [](std::uint32_t, std::uint32_t) { return true; };
  const std::vector<format::certificate_record> certificate(reached.size());
  source.certificate = certificate;
  std::vector<std::byte> out;
  EXPECT_EQ(format::put_lights(file, source, out), format::status::ok);
  return out;
}

TEST_F(unseen_test, what_shadows_need_counts_as_seen) {
  const scene::scene s = six_quads([](test::tiny_scene& t) { t.tag(10, {.dynamic = true}); });
  const auto seen = file_of(s, {{0, 1, 6}, {0, 3, 6, 7}}, {1e-3, 1e-4});
  EXPECT_EQ(find_unseen(s, seen, "scene.pvs").only_in_shadows, 0u);
  const auto with_suns = with_casters(seen, {{}, {2, 8, 10}, {9}, {}});
  unseen_polygons found = find_unseen(s, with_suns, "scene.pvs");
  EXPECT_EQ(list_of(found.is_unseen), (ids{4, 5}));
  EXPECT_EQ(found.unseen, 2u);
  EXPECT_EQ(found.only_in_shadows, 3u) << "2, 8 and 9; 10 is exempt";
  EXPECT_EQ(found.exempt, 2u);
  found = find_unseen(s, with_lights(with_suns, {{0, 1}, {3, 5, 8}}), "scene.pvs");
  EXPECT_EQ(list_of(found.is_unseen), (ids{4}));
  EXPECT_EQ(found.only_in_shadows, 4u);
  found = find_unseen(s, with_lights(seen, {{4}}), "scene.pvs");
  EXPECT_EQ(list_of(found.is_unseen), (ids{2, 5, 8, 9}));
}

TEST_F(unseen_test, bounds_are_those_of_cells_that_have_one) {
  const scene::scene s = six_quads();
  const unseen_bound bound = find_unseen(s, file_of(s, {{0}, {1}, {2}}, {1e-3, 3e-3, 2.0}), "scene.pvs").bound;
  EXPECT_EQ(bound.cells, 2u);
  EXPECT_EQ(bound.without, 1u);
  EXPECT_NEAR(bound.mean_upper_bound, 2e-3, 1e-8);
  EXPECT_NEAR(bound.largest_upper_bound, 3e-3, 1e-8);
  EXPECT_EQ(bound.confidence, 0.95);
  EXPECT_NEAR(bound.outside_share, 9e-4, 1e-4);
  EXPECT_EQ(bound.metric, "pixel");
}

TEST_F(unseen_test, a_file_without_bounds_states_none) {
  const scene::scene s = six_quads();
  const unseen_bound bound = find_unseen(s, file_of(s, {{0}}, {2.0}), "scene.pvs").bound;
  EXPECT_EQ(bound.cells, 0u);
  EXPECT_EQ(bound.without, 1u);
  EXPECT_EQ(bound.confidence, 0.0);
  EXPECT_EQ(bound.mean_upper_bound, 1.0);
  EXPECT_EQ(bound.largest_upper_bound, 1.0);
}

TEST_F(unseen_test, bounds_of_colors_bound_nothing_here) {
  const scene::scene s = six_quads();
  settings how;
  how.metric.kind = metric_kind::color;
  const unseen_bound bound = find_unseen(s, file_of(s, {{0}}, {1e-3}, how), "scene.pvs").bound;
  EXPECT_EQ(bound.metric, "color");
  EXPECT_EQ(bound.cells, 0u);
  EXPECT_EQ(bound.without, 1u);
}

// P(Bin(n, 0.05) <= k) >= 0.95 for these k and for no smaller one: from scipy.stats.binom.ppf(0.95, n, 0.05).
TEST_F(unseen_test, bounds_that_may_be_too_low_are_a_quantile_of_the_binomial_distribution) {
  const scene::scene s = six_quads();
  for (const auto& [cells, exceed] : {std::pair(1u, 0u), {2u, 1u}, {8u, 2u}, {100u, 9u}, {1000u, 62u}}) {
    const auto file = file_of(s, std::vector<ids>(cells, ids{0}), std::vector<double>(cells, 1e-3));
    EXPECT_EQ(find_unseen(s, file, "scene.pvs").bound.cells_that_may_exceed, exceed) << cells;
  }
}

TEST_F(unseen_test, parts_of_a_bake_are_warned_of) {
  const scene::scene s = six_quads();
  settings trial, timed;
  trial.cell_limit = 4;
  timed.time_budget = 60;
  EXPECT_EQ(find_unseen(s, file_of(s, {{0}}, {1e-3}, trial), "scene.pvs").warnings.size(), 1u);
  EXPECT_EQ(find_unseen(s, file_of(s, {{0}}, {1e-3}, timed), "scene.pvs").warnings.size(), 1u);
}

TEST_F(unseen_test, another_scene_and_damage_are_refused) {
  const scene::scene s = six_quads();
  std::vector<std::byte> file = file_of(s, {{0, 1, 6, 11}, {0, 3, 6, 7}}, {1e-3, 1e-4});
  const scene::scene other = six_quads([](test::tiny_scene& t) { t.wall_x(9, 1, 1); });
  EXPECT_EQ(test::error_id([&] { (void)find_unseen(other, file, "scene.pvs"); }), "pvs.other-scene");
  file.resize(file.size() - 1);
  EXPECT_EQ(test::error_id([&] { (void)find_unseen(s, file, "scene.pvs"); }), "pvs.broken");
}

}  // namespace
}  // namespace sightcell::bake
