// What lies beside a set joins it: one ring, by edge or by vertex, of what does not face away; and nothing else
// changes.
#include "sightcell/bake/safety_ring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "job/cell_bake.h"
#include "search/dilation.h"
#include "sightcell/bake/bake.h"
#include "sightcell/format/reader.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

namespace fs = std::filesystem;
using polygons = std::vector<std::uint32_t>;
using test::tiny_scene;

// One triangle on the floor, and what lies around it. The cell is above, from x = 0 on.
class ring_on_the_floor : public testing::Test {
 protected:
  void SetUp() override {
    tiny_scene tiny;
    member = tiny.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    by_edge = tiny.triangle({1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    by_vertex = tiny.triangle({1, 0, 0}, {2, -1, 0}, {2, 0, 0});
    beside_the_ring = tiny.triangle({2, -1, 0}, {3, 0, 0}, {2, 0, 0});
    turned_away = tiny.triangle({0, 0, 0}, {1, 0, 0}, {0, -1, 0});
    both_sides = tiny.triangle({0, 0, 0}, {1, 0, 0}, {0, -1, -1}, {scene::alpha_mode::opaque, true});
    left_out = tiny.triangle({0, 0, 0}, {1, -1, 0}, {1, 0, 0});
    // In the plane x = 0, toward -x: only places with x < 0 are before it.
    on_the_border = tiny.triangle({0, 0, 0}, {0, 1, 0}, {0, 0, -1});
    // Along the box's diagonal: only one of its upright edges is before it.
    to_a_corner = tiny.triangle({1, 0, 0}, {1, 0, -1}, {0, 1, 0});
    tiny.tag(left_out, {.never = true});
    beside_what_is_by_hand = tiny.triangle({3, 0, 0}, {3, 1, 0}, {2.5f, 1, 0});
    coarser = tiny.triangle({1, 0, -0.1f}, {2, -1, -0.1f}, {2, 0, -0.1f});
    tiny.level(by_vertex, 1, 0);
    tiny.level(coarser, 1, 1);
    geometry_ = scene::flatten(tiny.finished());
  }

  polygons ring(safety_ring how, float margin = 0.25f, bool all_double_sided = false) const {
    const ray_scene rays(geometry_, all_double_sided);
    const vertex_neighbors sharing(geometry_);
    return ring_of(rays, sharing, how, above.grown(margin), polygons{member});
  }

  const box above{{0, 0, 4}, {1, 1, 5}};
  std::uint32_t member = 0, by_edge = 0, by_vertex = 0, beside_the_ring = 0, turned_away = 0, both_sides = 0,
                left_out = 0, on_the_border = 0, to_a_corner = 0, beside_what_is_by_hand = 0, coarser = 0;
  scene::world_geometry geometry_;
};

TEST_F(ring_on_the_floor, holds_what_shares_an_edge_or_a_vertex_and_does_not_face_away) {
  EXPECT_EQ(ring(safety_ring::none), polygons());
  EXPECT_EQ(ring(safety_ring::edge), (polygons{by_edge, both_sides, on_the_border, to_a_corner}));
  EXPECT_EQ(ring(safety_ring::vertex), (polygons{by_edge, by_vertex, both_sides, on_the_border, to_a_corner}));
}

TEST_F(ring_on_the_floor, asks_all_of_the_grown_box) {
  EXPECT_EQ(ring(safety_ring::edge, 0.0f), (polygons{by_edge, both_sides, to_a_corner}));
}

TEST_F(ring_on_the_floor, has_no_backs_where_everything_is_double_sided) {
  EXPECT_EQ(ring(safety_ring::edge, 0.25f, true),
            (polygons{by_edge, turned_away, both_sides, on_the_border, to_a_corner}));
}

// A sampler that is never asked.
struct no_sampler final : cell_sampler {
  sampling_effort sample(const sampled_cell&, cell_set&) const override { return {}; }
};

TEST_F(ring_on_the_floor, brings_levels_of_detail_with_it_and_grows_around_nothing_added_by_hand) {
  const ray_scene rays(geometry_, false);
  const near_polygons neighbors(rays);
  settings how;
  how.safety_ring = safety_ring::vertex;
  overrides given;
  given.add = {{{beside_the_ring, 1}}};
  const duplicate_classes duplicates(geometry_, false);
  const cell_baker baker(how, given, rays, &neighbors, duplicates, no_sampler());
  const view_cell cell{above.min, above.max, "", 7, 0};
  cell_record record;
  record.set = {member};
  record.upper_bound = 1e-4;
  const cell_record finished = baker.finished(cell, record);
  EXPECT_EQ(finished.set,
            (polygons{member, by_edge, by_vertex, beside_the_ring, both_sides, on_the_border, to_a_corner, coarser}));
  EXPECT_EQ(finished.unverified, 6u) << "all but the member and what was added by hand";
  EXPECT_EQ(finished.upper_bound, 1e-4);
  record.stored = false;
  record.set.clear();
  EXPECT_EQ(baker.finished(cell, record).set, polygons());
}

// Whole bakes of a room with pillars, of cells that share what they see.
class safety_ring_bake : public testing::Test {
 protected:
  void SetUp() override {
    tiny_scene tiny;
    tiny.room_with_pillars();
    scene_ = tiny.finished();
    how_.file.profile = slack_profile::exact;
    how_.cells_grid = {-4.0f, 0.0f, -4.0f, 4.0f, 1.0f, 4.0f};
    how_.cell_size = 2.0f;
    how_.source = "cpu";
    how_.resolution = 16;
    how_.samples = 6;
    how_.max_pixel_error = 0.05;
  }

  std::vector<std::byte> baked(safety_ring how, std::uint32_t threads = 1) {
    how_.safety_ring = how;
    how_.threads = threads;
    last_ = bake(scene_, how_, folder_ / "room.pvs", true, {});
    return test::file_bytes(folder_ / "room.pvs");
  }

  test::fresh_folder folder_;
  scene::scene scene_;
  settings how_;
  summary last_;
};

TEST_F(safety_ring_bake, adds_the_ring_to_every_set_and_changes_nothing_else) {
  const std::vector<std::byte> without = baked(safety_ring::none);
  EXPECT_EQ(last_.unseen_per_cell, 0.0);
  const scene::world_geometry geometry = scene::flatten(scene_);
  const ray_scene rays(geometry, false);
  const vertex_neighbors sharing(geometry);
  for (const safety_ring how : {safety_ring::edge, safety_ring::vertex}) {
    const std::vector<std::byte> with = baked(how);
    test::stored_file before(without), after(with);
    ASSERT_EQ(before.reader().cell_count(), after.reader().cell_count());
    double seen = 0.0, unseen = 0.0;
    for (std::uint32_t cell = 0; cell < before.reader().cell_count(); ++cell) {
      format::box where;
      ASSERT_EQ(before.reader().cell_box(cell, where), format::status::ok);
      const box own{{where.min[0], where.min[1], where.min[2]}, {where.max[0], where.max[1], where.max[2]}};
      polygons expected = before.set(cell);
      seen += static_cast<double>(expected.size());
      const polygons ring = ring_of(rays, sharing, how, own.grown(how_.margin), expected);
      unseen += static_cast<double>(ring.size());
      expected.insert(expected.end(), ring.begin(), ring.end());
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(after.set(cell), expected) << cell;
      format::certificate_record of_before, of_after;
      ASSERT_EQ(before.reader().certificate(cell, of_before), format::status::ok);
      ASSERT_EQ(after.reader().certificate(cell, of_after), format::status::ok);
      EXPECT_EQ(of_before.rays, of_after.rays);
      EXPECT_EQ(of_before.upper_bound, of_after.upper_bound);
    }
    EXPECT_GT(unseen, 0.0);
    EXPECT_DOUBLE_EQ(last_.unseen_per_cell, unseen / before.reader().cell_count());
    EXPECT_DOUBLE_EQ(last_.unseen_percent, 100.0 * unseen / seen);
  }
}

TEST_F(safety_ring_bake, gives_the_same_bytes_for_any_number_of_threads) {
  EXPECT_EQ(baked(safety_ring::vertex, 1), baked(safety_ring::vertex, 2));
}

TEST_F(safety_ring_bake, works_for_a_sampler_alone) {
  how_.sampler = "halton";
  how_.max_pixel_error = 0.0;
  const std::vector<std::byte> bytes = baked(safety_ring::edge);
  EXPECT_GT(last_.unseen_percent, 0.0);
}

}  // namespace
}  // namespace sightcell::bake
