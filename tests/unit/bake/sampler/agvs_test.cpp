// Rays for all cells at once: whom one ray feeds, how the kinds of rays share the work, and whole bakes.
#include "sampler/agvs.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <set>

#include "sightcell/bake/shards.h"
#include "sightcell/bake/verify.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

namespace fs = std::filesystem;
using test::tiny_scene;
using walls = std::set<std::uint32_t>;

// One ray through cells that know nothing yet.
class one_ray : public testing::Test {
 protected:
  // What each of the cells got.
  std::vector<walls> cast(const tiny_scene& tiny, const global_ray& ray) {
    tiny_scene copy = tiny;
    const scene::world_geometry geometry = scene::flatten(copy.finished());
    const ray_scene rays(geometry, false);
    const segment_cells cells(boxes);
    std::vector<std::uint64_t> places(boxes.size());
    std::iota(places.begin(), places.end(), 1u);
    const std::vector<seen_pairs> known(boxes.size());
    const free_memory memory(boxes.size());
    ray_feed feed(rays, cells, places, known, memory, {.smallest_gap = 0.0f});  // or that rule would hide errors
    feed.cast(ray, 0);
    const feed_finds finds = feed.take();
    std::vector<walls> got(boxes.size());
    for (const found_pair& f : finds.found) {
      got[f.cell].insert(f.polygon);
      const box& of = boxes[f.cell];
      EXPECT_TRUE(f.eye.x >= of.min.x && f.eye.x <= of.max.x) << f.eye.x;
      EXPECT_FLOAT_EQ(f.eye.y, ray.origin.y);
    }
    blocked = finds.blocked;
    return got;
  }
  // A room whose walls at its two ends are polygons 0 and 1, 2 and 3.
  static tiny_scene room() {
    tiny_scene tiny;
    tiny.wall_x(-9, +1, 9);
    tiny.wall_x(9, -1, 9);
    return tiny;
  }
  // Of each quad only one triangle is hit.
  static walls quads(const walls& polygons) {
    walls numbers;
    for (const std::uint32_t polygon : polygons) numbers.insert(polygon / 2);
    return numbers;
  }

  std::vector<box> boxes{
      {{0, 0, 0}, {1, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}, {{4, 0, 0}, {5, 1, 1}}, {{4, 2, 0}, {5, 3, 1}}};
  const global_ray along_x{.origin = {0.5f, 0.4f, 0.6f}, .direction = {1, 0, 0}};
  std::vector<blocked_ray> blocked;
};

TEST_F(one_ray, feeds_every_cell_it_crosses) {
  const auto got = cast(room(), along_x);
  for (std::size_t cell = 0; cell < 3; ++cell) EXPECT_EQ(quads(got[cell]), (walls{0, 1})) << cell;
  EXPECT_TRUE(got[3].empty()) << "it lies beside the ray";
}

TEST_F(one_ray, ends_at_a_wall) {
  tiny_scene tiny = room();
  tiny.wall_x(1.5f, -1, 9, {scene::alpha_mode::opaque, true});
  const auto got = cast(tiny, along_x);
  EXPECT_EQ(quads(got[0]), (walls{0, 2}));
  EXPECT_TRUE(got[1].empty());
  EXPECT_TRUE(got[2].empty());
}

TEST_F(one_ray, goes_on_through_a_back_one_way_only) {
  tiny_scene tiny = room();
  // Turns its back to the first cell; small, or that would be in a solid.
  tiny.quad({1.5f, 0.35f, 0.65f}, {1.5f, 0.35f, 0.55f}, {1.5f, 0.45f, 0.55f}, {1.5f, 0.45f, 0.65f});
  const auto got = cast(tiny, along_x);
  EXPECT_EQ(quads(got[0]), (walls{0, 1}));
  EXPECT_EQ(quads(got[1]), walls{1}) << "what hides the first wall from there is not known to this ray";
  EXPECT_EQ(quads(got[2]), walls{1});
}

TEST_F(one_ray, passes_what_hides_nothing) {
  tiny_scene tiny = room();
  tiny.wall_x(1.5f, -1, 9, {scene::alpha_mode::blend, false});
  const auto got = cast(tiny, along_x);
  EXPECT_EQ(quads(got[0]), (walls{0, 1, 2}));
  EXPECT_EQ(quads(got[1]), (walls{0, 1})) << "its back";
}

TEST_F(one_ray, no_place_in_a_wall_counts) {
  tiny_scene tiny = room();
  tiny.closed_box({1.8f, -1, -1}, {3.2f, 2, 2});
  tiny.wall_x(2.9f, -1, 0.7f);  // in the box, so that a ray in it meets a front
  global_ray inside = along_x;
  inside.origin.x = 2.5f;
  const auto got = cast(tiny, inside);
  EXPECT_TRUE(got[1].empty()) << "a solid";
  EXPECT_EQ(quads(got[0]), walls{0}) << "what is behind the solid's back is free";
  tiny_scene narrow = room();
  narrow.quad({-9, 0.41f, -9}, {-9, 0.41f, 9}, {9, 0.41f, 9}, {9, 0.41f, -9}, {scene::alpha_mode::opaque, true});
  EXPECT_EQ(cast(narrow, along_x), std::vector<walls>(4)) << "a centimeter from a surface";
}

TEST_F(one_ray, tells_what_blocked_it) {
  tiny_scene tiny = room();
  const std::uint32_t wall = tiny.wall_x(1.5f, -1, 9);
  global_ray ray = along_x;
  ray.polygon = 0;
  ray.point = {-9, 0.4f, 0.6f};
  ray.aim = {1.51f, 0.4f, 0.6f};
  (void)cast(tiny, ray);
  EXPECT_TRUE(blocked.empty()) << "it came where it should";
  ray.aim.x = 8.0f;
  (void)cast(tiny, ray);
  ASSERT_EQ(blocked.size(), 1u);
  EXPECT_EQ(blocked[0].occluder / 2, wall / 2);
  EXPECT_FLOAT_EQ(blocked[0].hit.x, 1.5f);
}

TEST(segment_cells, finds_what_a_look_at_all_of_them_finds) {
  random_stream random(1, 2, purpose::verify);
  std::vector<box> boxes;
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 low = random.in_box({-40, -2, -40}, {40, 2, 40});
    boxes.push_back({low, low + random.in_box({0.1f, 0.1f, 0.1f}, {i % 50 == 0 ? 30.0f : 4.0f, 2, 4})});
  }
  const segment_cells cells(boxes);
  std::vector<crossing> got;
  std::size_t crossings = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 eye = random.in_box({-60, -4, -60}, {60, 4, 60});
    const glm::vec3 direction =
        i % 10 == 0 ? glm::vec3{1, 0, 0} : glm::normalize(random.on_sphere() * glm::vec3{1.0f, 0.03f, 1.0f});
    const float to = i % 3 == 0 ? std::numeric_limits<float>::infinity() : 30.0f * random.uniform();
    cells.find(eye, direction, i % 2 == 0 ? -to : 0.0f, to, got);
    std::vector<std::uint32_t> numbers, expected;
    for (const crossing& c : got) {
      numbers.push_back(c.cell);
      EXPECT_LT(c.from, c.to);
    }
    for (std::uint32_t cell = 0; cell < boxes.size(); ++cell) {
      std::vector<crossing> one;
      segment_cells({boxes[cell]}).find(eye, direction, i % 2 == 0 ? -to : 0.0f, to, one);
      if (!one.empty()) expected.push_back(cell);
    }
    EXPECT_EQ(numbers, expected) << i;
    crossings += numbers.size();
  }
  EXPECT_GT(crossings, 300u);
}

TEST(adaptive_shares, follow_what_each_kind_found_lately) {
  adaptive_shares shares;
  const std::array<std::uint64_t, ray_kinds> any{1000, 1000, 1000, 1000, 1000, 1000};
  const auto of = [&](ray_kind kind) { return shares.rays_of_round(1000, any)[static_cast<std::size_t>(kind)]; };
  const std::uint64_t before = of(ray_kind::silhouette);
  EXPECT_EQ(before, of(ray_kind::mutation)) << "all alike at first";
  for (int round = 0; round < 5; ++round) shares.found(ray_kind::silhouette, 100, 800);
  EXPECT_GT(of(ray_kind::silhouette), 2 * before);
  for (int round = 0; round < 20; ++round) shares.found(ray_kind::silhouette, 100, 0);
  EXPECT_LT(of(ray_kind::silhouette), before / 2);
  EXPECT_GE(of(ray_kind::silhouette), 20u) << "two percent stay";
  auto limited = any;
  limited[static_cast<std::size_t>(ray_kind::reverse)] = 3;
  const auto counts = shares.rays_of_round(1000, limited);
  EXPECT_EQ(counts[static_cast<std::size_t>(ray_kind::reverse)], 3u);
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}), 1000u);
}

// agvs asks no source of hemicubes.
class no_source final : public hemicube_source {
 public:
  void render(std::span<const pose>, std::span<hemicube_view>) override { FAIL(); }
  void render_image(const pose&, hemicube_image&) override { FAIL(); }
  std::uint32_t resolution() const override { return 16; }
  std::string device() const override { return "none"; }
};

// Two rooms with a wall between them, a narrow gap in it, and cells in both.
class two_rooms : public testing::Test {
 protected:
  void SetUp() override {
    tiny_scene tiny;
    tiny.closed_box({-9, -3, -9}, {9, 3, 9}, true);
    tiny.closed_box({-0.2f, -3, -9}, {0.2f, 3, 4});
    tiny.closed_box({-0.2f, -3, 4.1f}, {0.2f, 3, 9});
    for (int i = 0; i < 12; ++i) {
      const float x = -8.0f + 1.4f * static_cast<float>(i), z = static_cast<float>(i * 7 % 13) - 6.0f;
      tiny.closed_box({x, -3, z}, {x + 0.4f, 1, z + 0.5f});
    }
    scene_ = tiny.finished();
    how_.sampler = "agvs";
    how_.cells_grid = {-8.0f, 0.0f, -8.0f, 8.0f, 1.0f, 8.0f};
    how_.cell_size = 4.0f;
    how_.source = "cpu";
    how_.resolution = 16;
    how_.sampling_rays = 4'000;
    how_.rays_per_round = 1'024;
    how_.max_pixel_error = 0.0;
  }

  std::vector<std::byte> baked(const char* name, bool fresh = true) {
    EXPECT_EQ(bake(scene_, how_, folder_ / name, fresh, {}).result, outcome::done);
    return test::file_bytes(folder_ / name);
  }
  double error_of(const char* name) {
    verify_settings how;
    how.rays = 100'000;
    return verify(scene_, test::file_bytes(folder_ / name), name, how, {}).pixel_error;
  }

  const tbb::global_control allowed_{tbb::global_control::max_allowed_parallelism, 8};
  test::fresh_folder folder_;
  scene::scene scene_;
  settings how_;
};

TEST_F(two_rooms, more_rays_leave_less_unseen) {
  how_.sampling_rays = 1'000;
  (void)baked("few.pvs");
  const double few = error_of("few.pvs");
  how_.sampling_rays = 15'000;
  (void)baked("many.pvs");
  EXPECT_LT(error_of("many.pvs"), few / 3);
  EXPECT_LT(error_of("many.pvs"), 2e-4);
  // With rays of the finish it is met as with any sampler.
  how_.max_pixel_error = 1e-3;
  (void)baked("bound.pvs");
  EXPECT_LT(error_of("bound.pvs"), 2e-4);
}

TEST_F(two_rooms, threads_and_shards_change_no_byte) {
  std::vector<std::byte> first;
  for (const std::uint32_t threads : {1u, 2u, 8u}) {
    how_.threads = threads;
    const auto bytes = baked("t.pvs");
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes, first) << threads;
  }
  for (const std::uint32_t phase : {1u, 2u})
    for (const std::uint32_t index : {1u, 0u})
      EXPECT_EQ(bake_shard(scene_, how_, folder_ / "s.pvs", {index, 2, phase}, true, {}).result, outcome::done);
  (void)merge(find_shard_files(folder_ / "s.pvs"), folder_ / "s.pvs", {});
  EXPECT_EQ(test::file_bytes(folder_ / "s.pvs"), first);
}

TEST_F(two_rooms, ends_when_told_before_the_first_cell) {
  how_.sampling_rays = 100'000'000'000;  // nobody waits for them
  int told = 0;
  callbacks tell;
  tell.on_progress = [&](const progress& now) {
    EXPECT_EQ(now.cells_done, 0u);
    if (now.prepared == 1.0) return true;
    EXPECT_LT(now.prepared, 0.1);
    return ++told < 2;
  };
  EXPECT_EQ(bake(scene_, how_, folder_ / "c.pvs", true, tell).result, outcome::cancelled);
  EXPECT_EQ(told, 2);
  EXPECT_FALSE(fs::exists(folder_ / "c.pvs"));
  tell.on_progress = [](const progress&) { return false; };
  EXPECT_EQ(bake(scene_, how_, folder_ / "c.pvs", false, tell).cells_resumed, 0u) << "no cell of half the rays";
}

TEST_F(two_rooms, a_resume_prepares_again_and_gives_the_same_bytes) {
  const auto whole = baked("w.pvs");
  how_.threads = 1;
  callbacks tell;
  tell.on_progress = [](const progress& now) { return now.cells_done < 3; };
  EXPECT_EQ(bake(scene_, how_, folder_ / "r.pvs", true, tell).result, outcome::cancelled);
  EXPECT_EQ(baked("r.pvs", false), whole);
}

TEST_F(two_rooms, a_limit_of_time_ends_it) {
  how_.sampling_rays = 100'000'000'000;
  how_.seconds_per_cell = 1e-4;
  EXPECT_FALSE(baked("l.pvs").empty());
}

// The sampler by itself.
class agvs_alone : public two_rooms {
 protected:
  // Sets of the cells, after all rays.
  std::vector<std::vector<std::uint32_t>> sets() {
    const scene::world_geometry geometry = scene::flatten(scene_);
    const ray_scene rays(geometry, false);
    const cell_list list = make_cells(geometry, how_);
    no_source none;
    agvs sampler(how_, {rays, none, nullptr, list.cells});
    sampler.prepare([](double) { return true; });
    results = sampler.results();
    std::vector<std::vector<std::uint32_t>> all;
    const std::array<glm::vec3, 1> free{glm::vec3{0.5f}};
    for (const view_cell& cell : list.cells) {
      cell_set set(static_cast<std::uint32_t>(geometry.kinds.size()));
      (void)sampler.sample({.grown = {}, .place = cell.place, .free = free}, set);
      all.push_back(set.sorted());
    }
    return all;
  }
  std::array<agvs::kind_result, ray_kinds> results{};
};

TEST_F(agvs_alone, every_kind_of_ray_is_cast_and_the_better_ones_more) {
  how_.sampling_rays = 20'000;
  (void)sets();
  std::uint64_t rays = 0, pairs = 0;
  for (const agvs::kind_result& kind : results) {
    EXPECT_GT(kind.rays, 0u);
    EXPECT_GT(kind.pairs, 0u) << "each finds something that no other had found";
    rays += kind.rays, pairs += kind.pairs;
  }
  EXPECT_EQ(rays, 16u * 20'000u);
  EXPECT_GT(pairs, 16u * 50u);
}

TEST_F(agvs_alone, ends_when_rounds_find_too_little) {
  how_.sampling_rays = 1'000'000;
  how_.fewest_new = 1;
  (void)sets();
  std::uint64_t rays = 0;
  for (const agvs::kind_result& kind : results) rays += kind.rays;
  EXPECT_LT(rays, 16u * 100'000u);
  EXPECT_GT(rays, 16u * 100u);
}

TEST_F(agvs_alone, the_filter_joins_what_cells_near_by_see) {
  const auto without = sets();
  how_.filter = 1.0;  // lattice cells touch each other
  const auto with = sets();
  ASSERT_EQ(without.size(), 16u);
  // On the lattice of 4 by 4, in the order z, x.
  for (std::size_t cell = 0; cell < 16; ++cell) {
    std::set<std::uint32_t> expected;
    for (std::size_t other = 0; other < 16; ++other) {
      const auto apart = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
      if (apart(cell % 4, other % 4) > 1 || apart(cell / 4, other / 4) > 1) continue;
      expected.insert(without[other].begin(), without[other].end());
    }
    EXPECT_EQ(std::set<std::uint32_t>(with[cell].begin(), with[cell].end()), expected) << cell;
    EXPECT_GT(with[cell].size(), without[cell].size()) << cell;
  }
}

}  // namespace
}  // namespace sightcell::bake
