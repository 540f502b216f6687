#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "bench/samplers/growth.h"
#include "bench/samplers/jobs.h"
#include "bench/samplers/judge.h"
#include "bench/samplers/kept_files.h"
#include "bench/samplers/measure.h"
#include "bench/samplers/pictures.h"
#include "bench/samplers/truth.h"
#include "bound/verification_rays.h"
#include "hemicube/choice/choose_source.h"
#include "sightcell/base/error.h"
#include "unit/bake/tiny_scene.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using namespace sightcell::bench;
using sightcell::test::tiny_scene;

constexpr tiny_scene::look pane{scene::alpha_mode::blend, true};

bake::view_cell cell_at(glm::vec3 min, glm::vec3 max, std::uint64_t place = 7) {
  bake::view_cell cell;
  cell.min = min, cell.max = max, cell.place = place;
  return cell;
}

// A scene of its own folder of kept files, removed at the end.
class folder {
 public:
  folder() : path(std::filesystem::temp_directory_path() / ("samplers_test." + std::to_string(getpid()))) {
    std::filesystem::remove_all(path);
  }
  ~folder() { std::filesystem::remove_all(path); }
  const std::filesystem::path path;
};

std::vector<std::uint32_t> all_but(const ground& g, const std::vector<std::uint32_t>& quads) {
  std::vector<std::uint32_t> set;
  for (std::uint32_t id = 0; id < g.polygons(); ++id)
    if (std::none_of(quads.begin(), quads.end(), [&](std::uint32_t q) { return id == q || id == q + 1; }))
      set.push_back(id);
  return set;
}

// A room with all that excuses a miss, or makes it count once: panes before a wall, a wall in the same place as
// another, a wall behind a crack.
struct room {
  tiny_scene tiny;
  std::vector<std::uint32_t> missing, excused;  // what a set lacks: wrong, and not wrong
  room() {
    tiny.closed_box({-10, -10, -10}, {10, 10, 10}, true);
    missing.push_back(tiny.wall_x(5, -1, 3));
    missing.push_back(tiny.wall_x(4, -1, 2, pane));
    missing.push_back(tiny.wall_x(4.5f, -1, 2, pane));
    const tiny_scene::look sheet{scene::alpha_mode::opaque, true};
    tiny.quad({-4, 0.0008f, 6}, {4, 0.0008f, 6}, {4, 4, 6}, {-4, 4, 6}, sheet);
    tiny.quad({-4, -4, 6}, {4, -4, 6}, {4, -0.0008f, 6}, {-4, -0.0008f, 6}, sheet);
    excused.push_back(tiny.quad({-4, -3, 8}, {-4, 3, 8}, {4, 3, 8}, {4, -3, 8}, sheet));
    excused.push_back(tiny.wall_x(-6, 1, 2));
    tiny.wall_x(-6, 1, 2.5f);
  }
};

TEST(bench_truth, agrees_with_fresh_rays) {
  room made;
  const ground g(made.tiny.finished(), {cell_at({-1, -1, -1}, {1, 1, 1})}, {}, "room");
  cell_truth truth(g, 0);
  truth.extend(400'000);
  cell_judge judge(truth);
  std::vector<std::vector<std::uint32_t>> cases{made.missing, {}};
  for (const std::uint32_t one : made.missing) cases.push_back({one});
  for (const std::uint32_t one : made.excused) cases.push_back({one});
  for (const auto& missing : cases) {
    const auto set = all_but(g, missing);
    std::vector<bool> marks(g.polygons());
    for (const std::uint32_t id : set) marks[id] = true;
    constexpr std::uint64_t count = 60'000;
    const bake::verification_batch fresh =
        bake::cast_verification_rays(g.rays, g.grown(0), {g.rules.player_radius, g.rules.smallest_gap}, count, {1, 7},
                                     [&](std::uint32_t id) { return marks[id]; });
    const judgement found = judge.judge(set, false);
    const double error = static_cast<double>(fresh.misses) / count;
    // Shares are of four kept rays of few large polygons here, which the spread knows.
    const double sigma = std::sqrt(found.spread) / static_cast<double>(found.rays) + std::sqrt(error / count);
    EXPECT_NEAR(found.pixel_error(), error, 4.0 * sigma) << (missing.empty() ? 0 : missing.front());
    EXPECT_EQ(found.misses > 0.0, !missing.empty() && missing.front() < made.excused.front());
  }
}

TEST(bench_truth, steps_and_threads_change_nothing) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 2);
  room made;
  const ground g(made.tiny.finished(), {cell_at({-1, -1, -1}, {1, 1, 1})}, {}, "room");
  const folder where;
  const kept_files kept(where.path);
  cell_truth once(g, 0), steps(g, 0), loaded(g, 0);
  tbb::task_arena(1).execute([&] { once.extend(60'000); });
  tbb::task_arena(2).execute([&] {
    steps.extend(5'000);
    EXPECT_LT(steps.rays(), 10'000u);
    steps.extend(20'000);
    steps.save(kept);
    ASSERT_TRUE(loaded.load(kept));
    loaded.extend(60'000);
  });
  ASSERT_EQ(loaded.polygons().size(), once.polygons().size());
  EXPECT_EQ(loaded.rays(), once.rays());
  EXPECT_EQ(loaded.valid_share(), once.valid_share());
  std::uint64_t most = 0;
  for (std::size_t i = 0; i < once.polygons().size(); ++i) {
    const truth_polygon &a = once.polygons()[i], &b = loaded.polygons()[i];
    EXPECT_EQ(a.polygon, b.polygon);
    EXPECT_EQ(a.rays, b.rays);
    most = std::max<std::uint64_t>(most, a.rays);
    EXPECT_EQ(a.places, b.places);
    EXPECT_EQ(a.squares, b.squares);
    for (std::uint32_t k = 0; k < a.kept(); ++k) {
      EXPECT_EQ(a.kept_places[k].number, b.kept_places[k].number);
      EXPECT_EQ(a.kept_places[k].direction, b.kept_places[k].direction);
      EXPECT_EQ(a.kept_places[k].rays, b.kept_places[k].rays);
    }
  }
  EXPECT_GT(most, 1000u);
}

TEST(bench_truth, a_damaged_file_is_none) {
  room made;
  const ground g(made.tiny.finished(), {cell_at({-1, -1, -1}, {1, 1, 1})}, {}, "room");
  const folder where;
  const kept_files kept(where.path);
  cell_truth truth(g, 0);
  EXPECT_FALSE(truth.load(kept));
  truth.extend(5'000);
  truth.save(kept);
  const auto file = where.path / truth.key().substr(0, 2) / (truth.key() + ".truth");
  const auto size = std::filesystem::file_size(file);
  for (const std::uintmax_t at : {std::uintmax_t{3}, size / 2, size - 1}) {
    {
      std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
      bytes.seekg(static_cast<std::streamoff>(at));
      const auto byte = static_cast<char>(bytes.get() ^ 4);
      bytes.seekp(static_cast<std::streamoff>(at));
      bytes.put(byte);
    }
    EXPECT_FALSE(truth.load(kept)) << at;
    truth.save(kept);
    EXPECT_TRUE(truth.load(kept));
  }
  std::filesystem::resize_file(file, size / 2);
  EXPECT_FALSE(truth.load(kept));
}

// Colors each draw by its first polygon.
scene::scene colored(tiny_scene tiny, const std::vector<std::pair<std::uint32_t, glm::vec4>>& colors) {
  scene::scene s = tiny.finished();
  for (const auto& [polygon, color] : colors)
    s.materials[s.draws[scene::draw_of(s, polygon)].material].base_color = color;
  return s;
}

TEST(bench_judge, color_error_is_that_of_what_stands_behind) {
  constexpr glm::vec4 red{1, 0, 0, 1}, green{0, 1, 0, 1}, blue{0, 0, 1, 0.25f};
  tiny_scene tiny;
  const auto near = tiny.wall_x(4, -1, 2), far = tiny.wall_x(6, -1, 40), glass = tiny.wall_x(3, -1, 1, pane);
  const ground g(colored(tiny, {{near, red}, {far, green}, {glass, blue}}), {cell_at({-1, -1, -1}, {1, 1, 1})}, {},
                 "walls");
  cell_truth truth(g, 0);
  truth.extend(100'000);
  cell_judge judge(truth);
  const auto error = [&](const std::vector<std::uint32_t>& missing) { return judge.judge(all_but(g, missing), true); };
  const double of_near = error({near}).pixel_error();
  EXPECT_GT(of_near, 0.02);
  EXPECT_EQ(error({}).color_error(), 0.0);
  // Red instead of green: two of three channels are as wrong as can be.
  EXPECT_NEAR(error({near}).color_error(), of_near * 2.0 / 3.0, 1e-9);
  // The sky is (162, 196, 234).
  const double red_sky = (255 - 162 + 196 + 234) / 765.0, green_sky = (162 + 255 - 196 + 234) / 765.0;
  const judgement both = error({near, far});
  EXPECT_NEAR(both.color_error(), of_near * red_sky + (both.pixel_error() - of_near) * green_sky, 1e-9);
  EXPECT_GT(both.pixel_error(), 2.0 * of_near);
  // A quarter of blue instead of red, or of green where a side view passes the near wall.
  const judgement through = error({glass});
  EXPECT_NEAR(through.color_error(), through.pixel_error() * 0.25 * 2.0 / 3.0, 1e-9);
  // What misses the glass and the wall behind it is one wrong ray: those of the wall, and a few that pass it by.
  EXPECT_LT(error({near, glass}).pixel_error(), of_near + 0.5 * through.pixel_error());
}

// Truths of as many cells in the same place, with other random numbers each: do they differ as much as each of them
// thinks? hidden: what the set lacks.
void expect_spread(tiny_scene tiny, const std::vector<std::uint32_t>& hidden, std::uint64_t rays) {
  constexpr std::size_t trials = 120;
  std::vector<bake::view_cell> cells;
  for (std::size_t i = 0; i < trials; ++i) cells.push_back(cell_at({-1, -1, -1}, {1, 1, 1}, 100 + i));
  const ground g(tiny.finished(), std::move(cells), {}, "many");
  const auto set = all_but(g, hidden);
  std::vector<judgement> found;
  double spread = 0.0, mean = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < trials; ++i) {
    cell_truth truth(g, i);
    truth.extend(rays);
    found.push_back(cell_judge(truth).judge(set, false));
    mean += found.back().misses / trials;
    spread += found.back().spread / trials;
  }
  std::size_t too_sure = 0;
  for (const judgement& one : found) variance += (one.misses - mean) * (one.misses - mean) / (trials - 1);
  for (const judgement& one : found) too_sure += one.spread < 0.3 * variance ? 1 : 0;
  EXPECT_GT(mean, 10.0);
  EXPECT_GT(variance, 1.3 * mean) << "there is something to tell";
  EXPECT_NEAR(spread / variance, 1.0, 0.35) << spread << ' ' << variance << ' ' << mean;
  EXPECT_LT(too_sure, trials / 10) << "not only on average";
}

constexpr tiny_scene::look sheet{scene::alpha_mode::opaque, true};

TEST(bench_judge, spread_is_the_variance_of_misses_through_a_slit) {
  // It shows what is behind it to a small part of the cell: rays of one place are wrong together.
  tiny_scene tiny;
  tiny.closed_box({-30, -30, -30}, {30, 30, 30}, true);
  tiny.quad({3, -9, -9}, {3, -9, 1.0f}, {3, 9, 1.0f}, {3, 9, -9}, sheet);
  tiny.quad({3, -9, 1.3f}, {3, -9, 9}, {3, 9, 9}, {3, 9, 1.3f}, sheet);
  tiny.quad({1.5f, -9, 1.0f}, {3, -9, 1.0f}, {3, 9, 1.0f}, {1.5f, 9, 1.0f}, sheet);
  tiny.quad({1.5f, -9, 1.3f}, {3, -9, 1.3f}, {3, 9, 1.3f}, {1.5f, 9, 1.3f}, sheet);
  const auto hidden = tiny.quad({3.5f, -9, -1}, {3.5f, -9, 3}, {3.5f, 9, 3}, {3.5f, 9, -1}, sheet);
  expect_spread(tiny, {hidden}, 8'000);
}

// A bench whose underside few places see, but there it is everything: side x side quads, of which four places each are
// kept.
std::vector<std::uint32_t> add_bench(tiny_scene& tiny, int side) {
  tiny.closed_box({-30, -1.2f, -30}, {30, 30, 30}, true);
  tiny.quad({-0.5f, -0.8f, 0.5f}, {0.5f, -0.8f, 0.5f}, {0.5f, -0.8f, -0.5f}, {-0.5f, -0.8f, -0.5f});
  std::vector<std::uint32_t> hidden;
  const float step = 1.0f / static_cast<float>(side);
  for (int i = 0; i < side * side; ++i) {
    const float x = -0.5f + step * static_cast<float>(i % side), z = -0.5f + step * static_cast<float>(i / side);
    hidden.push_back(
        tiny.quad({x, -0.81f, z}, {x + step, -0.81f, z}, {x + step, -0.81f, z + step}, {x, -0.81f, z + step}));
  }
  return hidden;
}

TEST(bench_judge, spread_is_the_variance_of_misses_under_a_bench_of_one_board) {
  tiny_scene tiny;
  const auto hidden = add_bench(tiny, 1);
  expect_spread(tiny, hidden, 20'000);
}

TEST(bench_judge, spread_is_the_variance_of_misses_under_a_bench_of_many_boards) {
  tiny_scene tiny;
  const auto hidden = add_bench(tiny, 3);
  expect_spread(tiny, hidden, 60'000);
}

TEST(bench_interval, is_that_of_poisson) {
  // Exact limits, from tables.
  for (const auto& [found, low, high] : {std::tuple{0.0, 0.0, 3.689},
                                         {1.0, 0.0253, 5.572},
                                         {5.0, 1.623, 11.668},
                                         {20.0, 12.217, 30.888},
                                         {100.0, 81.364, 121.627}}) {
    EXPECT_NEAR(poisson_interval(found).low, low, found < 5.0 ? 0.013 : 0.01 * low) << found;
    EXPECT_NEAR(poisson_interval(found).high, high, 0.01 * high) << found;
  }
  EXPECT_EQ(error_interval(0.0, 0.0, 0.0).high, 1.0);
  EXPECT_NEAR(error_interval(0.0, 0.0, 1000.0).high, 0.00369, 0.00004);
  EXPECT_NEAR(error_interval(0.01, 100.0, 1e4).high, 0.01216, 0.00001);
}

TEST(bench_jobs, settings_are_those_of_the_samplers) {
  const auto parse = [](const char* settings, const char* other = "{}") {
    json text{{"jobs", json::array()}};
    for (const char* one : {settings, other})
      text["jobs"].push_back({{"label", "x"}, {"code", "1"}, {"settings", json::parse(one)}});
    return parse_jobs(text, "jobs.json");
  };
  const job_list list = parse(R"({"sampler":"nir04","samples":80,"part-polygons":9,"jitter":true,"resolution":512})");
  const job &given = list.jobs.at(0), &plain = list.jobs.at(1);
  EXPECT_EQ(given.how.part_polygons, 9u);
  EXPECT_TRUE(given.how.jitter);
  EXPECT_EQ(given.how.max_pixel_error, 0.0);
  EXPECT_EQ(given.settings.at("part_polygons"), 9);
  EXPECT_EQ(given.settings.at("source"), "cpu");
  EXPECT_EQ(plain.settings.at("samples"), 24);
  EXPECT_FALSE(plain.settings.contains("part_polygons")) << "importance-depth has none";
  EXPECT_EQ(list.truth.max_rays, 40'000'000u);
  for (const char* wrong : {R"({"part_polygons":9})", R"({"sampler":"nobody"})", R"({"samples":"many"})", R"({"x":1})",
                            R"({"resolution":17})"})
    EXPECT_THROW(parse(wrong), sightcell::error) << wrong;
  EXPECT_THROW(parse(R"({"margin":0.5})"), sightcell::error) << "the other job has another truth";
  EXPECT_EQ(parse(R"({"margin":0.5})", R"({"margin":0.5})").jobs.at(0).rules().margin, 0.5f);
}

TEST(bench_jobs, what_is_tried_without_importance_is_another_job) {
  const auto parse = [](bool importance) {
    const json text{{"jobs", {{{"label", "x"}, {"importance", importance}, {"settings", json::object()}}}}};
    return parse_jobs(text, "jobs.json").jobs.at(0);
  };
  EXPECT_TRUE(parse(true).importance);
  EXPECT_FALSE(parse(false).importance);
  EXPECT_NE(parse(true).settings, parse(false).settings) << "they are kept by their settings";
}

TEST(bench_jobs, a_bound_that_is_asked_for_is_measured_with_all_it_takes) {
  tiny_scene tiny;
  tiny.closed_box({-9, -3, -9}, {9, 3, 9}, true);
  for (float x = -8.0f; x < 8.0f; x += 1.3f) tiny.closed_box({x, -3, 4}, {x + 0.4f, 2, 4.5f});
  const ground g(tiny.finished(), {cell_at({-1, -1, -1}, {1, 1, 1})}, {}, "pillars");
  const auto jobs = json::parse(R"({"jobs":[{"label":"a","settings":{"sampler":"guided","samples":6,"resolution":16,
                                                                    "max_pixel_error":1e-4}},
                                            {"label":"b","settings":{"sampler":"guided","samples":6}}],
                                    "truth":{"interval":1,"first_rays":100000,"max_rays":100000}})");
  const std::filesystem::path kept = std::filesystem::path(testing::TempDir()) / "sightcell_bench_targets";
  std::filesystem::remove_all(kept);
  const json result = measure_samplers(g, parse_jobs(jobs, "jobs.json"), kept_files(kept), 1);
  const json &bounded = result["jobs"][0]["cells"][0], &alone = result["jobs"][1]["cells"][0];
  EXPECT_LE(bounded["upper_bound"].get<double>(), 1e-4);
  EXPECT_LE(bounded["pixel_error"].get<double>(), bounded["upper_bound"].get<double>());
  EXPECT_GT(bounded["samples"].get<int>(), 6) << "the search after the sampler takes hemicubes too";
  EXPECT_EQ(alone["upper_bound"].get<double>(), 1.0);
  EXPECT_GT(bounded["rays"].get<double>(), alone["rays"].get<double>() + 30'000.0) << "those of the bound count";
  std::filesystem::remove_all(kept);
}

TEST(bench_growth, only_the_face_that_is_asked_for_sees) {
  tiny_scene tiny;
  tiny.wall_x(5, -1, 3), tiny.wall_x(6, -1, 40), tiny.wall_x(-6, 1, 3);
  const ground g(tiny.finished(), {cell_at({-1, -1, -1}, {1, 1, 1})}, {}, "walls");
  const bake::box grown = g.grown(0);
  const auto faces = bake::faces_of(grown.min, grown.max);
  for (const char* sampler : {"importance-depth", "nir04", "uniform", "halton"}) {
    job what;
    what.how.sampler = sampler, what.how.source = "cpu", what.how.samples = 12, what.how.resolution = 64;
    what.how.jitter = true;
    const bake::chosen_source eyes = bake::choose_source(what.how, g.geometry, g.rays);
    const auto right = growth_of_face(g, 0, what, faces[1], *eyes.source);
    const auto left = growth_of_face(g, 0, what, faces[0], *eyes.source);
    ASSERT_FALSE(right.empty() || left.empty()) << sampler;
    EXPECT_LE(right.size(), 12u) << sampler;
    EXPECT_TRUE(std::is_sorted(right.begin(), right.end())) << sampler;
    EXPECT_EQ(right.back(), 4u) << sampler;
    EXPECT_EQ(left.back(), 2u) << sampler << ": the wall at -6, and none of those at the other side";
  }
}

TEST(bench_pictures, red_pixels_grow) {
  sightcell::picture::image_rgba marked{6, 5, std::vector<std::uint8_t>(6 * 5 * 4, 100)};
  const auto red = [](const auto& image, std::size_t x, std::size_t y) {
    const std::uint8_t* at = &image.pixels[4 * (y * 6 + x)];
    return at[0] == 255 && at[1] == 0 && at[2] == 0 && at[3] == 255;
  };
  const std::uint8_t color[4]{255, 0, 0, 255};
  std::copy_n(color, 4, &marked.pixels[4 * (1 * 6 + 5)]);
  const auto grown = grow_red(marked, 2);
  for (std::size_t y = 0; y < 5; ++y)
    for (std::size_t x = 0; x < 6; ++x) EXPECT_EQ(red(grown, x, y), x >= 3 && y <= 3) << x << ' ' << y;
}

TEST(bench_pictures, the_worst_view_looks_at_what_is_missed) {
  room made;
  const ground g(made.tiny.finished(), {cell_at({-1, -1, -1}, {1, 1, 1})}, {}, "room");
  cell_truth truth(g, 0);
  truth.extend(20'000);
  const worst_view of_wall = find_worst_view(truth, all_but(g, {made.missing.front()}));  // at x = 5
  EXPECT_GT(of_wall.missed_share, 0.05);
  EXPECT_GT(of_wall.forward.x, 0.8f);
  // From where the wall is largest: near it.
  EXPECT_GT(of_wall.eye.x, 0.8f);
  EXPECT_EQ(find_worst_view(truth, all_but(g, {})).missed_share, 0.0);
  EXPECT_EQ(find_worst_view(truth, all_but(g, {made.excused.back()})).missed_share, 0.0);
}

}  // namespace
