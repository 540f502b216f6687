#include <gtest/gtest.h>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <functional>
#include <set>

#include "errors/error_id.h"
#include "sampler/face_sampler.h"
#include "sampler/importance_depth.h"
#include "sightcell/base/error.h"
#include "unit/bake/sampler/sample_cell.h"

namespace sightcell::bake {
namespace {

// Answers every pose with what a function says, and remembers the poses and how many came together.
class scripted_source final : public hemicube_source {
 public:
  std::function<void(const pose&, hemicube_view&)> answer = [](const pose&, hemicube_view&) {};
  std::vector<pose> poses;
  std::vector<std::size_t> batches;
  using hemicube_source::render;
  void render(std::span<const pose> wanted, std::span<hemicube_view> views) override {
    batches.push_back(wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      poses.push_back(wanted[i]);
      views[i] = {};
      answer(wanted[i], views[i]);
    }
  }
  void render_image(const pose&, hemicube_image&) override {}
  bool shared() const override { return false; }
  std::uint32_t resolution() const override { return 64; }
  std::string device() const override { return "scripted"; }
};

TEST(boundary_face, six_faces_cover_the_box_and_look_out) {
  const glm::vec3 low{1, 2, 3}, high{5, 4, 9};
  std::set<std::array<float, 3>> corners;
  for (const boundary_face& face : faces_of(low, high)) {
    EXPECT_EQ(glm::cross(face.outward, face.up), face.right);
    for (const glm::vec2 uv : {glm::vec2{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
      const glm::vec3 eye = face.at(uv).eye;
      corners.insert({eye.x, eye.y, eye.z});
      const float along = glm::dot(face.outward, eye);
      EXPECT_FLOAT_EQ(along, std::max(glm::dot(face.outward, low), glm::dot(face.outward, high)));
    }
  }
  EXPECT_EQ(corners.size(), 8u);
}

TEST(reliability_map, is_one_at_the_sample_and_falls_with_distance) {
  reliability_map map({4, 4});
  map.add_sample({0.5f, 0.5f}, {0, 0, 0, 0});
  EXPECT_GT(map.at(128, 128), 0.9999f);
  EXPECT_LT(map.at(255, 128), map.at(200, 128));
  EXPECT_NEAR(map.at(0, 128), std::exp(-0.25), 0.01);
}

TEST(reliability_map, falls_faster_toward_a_gap) {
  reliability_map map({4, 4});
  std::array<double, 4> gap{};
  gap[toward_right] = 3.0;
  map.add_sample({0.5f, 0.5f}, gap);
  EXPECT_LT(map.at(200, 128), map.at(55, 128));
  EXPECT_GT(map.lowest().place.x, 0.9f);
}

TEST(reliability_map, a_new_largest_importance_rebuilds_the_map) {
  reliability_map small({4, 4});
  small.add_sample({0.25f, 0.5f}, {1, 0, 0, 0});
  const float before = small.at(128, 128);
  small.add_sample({0.9f, 0.5f}, {1000, 0, 0, 0});  // the first one's importance is now next to nothing
  EXPECT_LT(before, 0.1f);
  EXPECT_NEAR(small.at(128, 128), std::exp(-0.25 * 0.25), 0.01);
}

TEST(reliability_map, is_only_ever_raised_by_samples_of_equal_scale) {
  reliability_map map({4, 2});
  map.add_sample({0.3f, 0.3f}, {1, 1, 1, 1});
  std::vector<float> before;
  for (std::uint32_t i = 0; i < 256; ++i) before.push_back(map.at(i, i));
  map.add_sample({0.8f, 0.6f}, {0.5, 1, 0.2, 0});
  for (std::uint32_t i = 0; i < 256; ++i) EXPECT_GE(map.at(i, i), before[i]);
}

TEST(reliability_map, knows_its_lowest_place_and_follows_the_formula) {
  reliability_map map({4, 2});
  random_stream random(3, 3, purpose::verify);
  // As the thesis has it, each texel on its own: distances through the longest side, normalised by the largest sum.
  struct sample {
    glm::vec2 place;
    std::array<double, 4> importance;
  };
  std::vector<sample> samples;
  double largest = 0.0;
  for (int i = 0; i < 12; ++i) {
    const glm::vec2 place{random.uniform(), random.uniform()};
    if (i % 3 == 2) {
      map.exclude(place);
      continue;
    }
    sample s{place, {}};
    for (double& part : s.importance) part = static_cast<double>(random.uniform()) * (1.0 + i);
    samples.push_back(s);
    largest = std::max(largest, *std::max_element(s.importance.begin(), s.importance.end()));
    map.add_sample(place, s.importance);

    float lowest = 2.0f;
    glm::vec2 first{0.0f};
    int differ = 0;
    for (std::uint32_t y = 0; y < reliability_map::map_size; ++y)
      for (std::uint32_t x = 0; x < reliability_map::map_size; ++x) {
        const glm::dvec2 at{(x + 0.5) / 256.0, (y + 0.5) / 256.0};
        if (map.at(x, y) < lowest) lowest = map.at(x, y), first = glm::vec2(at);
        double expected = 0.0;
        for (const sample& one : samples) {
          const double du = at.x - static_cast<double>(one.place.x),
                       dv = (at.y - static_cast<double>(one.place.y)) / 2.0;
          const auto variance = [&](direction k) { return std::max(1.0 - one.importance[k] / largest, 0.02); };
          const double square = du * du + dv * dv, a = du * du / square;
          const double r = a * std::exp(-square / variance(du < 0.0 ? toward_left : toward_right)) +
                           (1.0 - a) * std::exp(-square / variance(dv > 0.0 ? toward_up : toward_down));
          expected = std::max(expected, r);
        }
        const bool same = std::abs(static_cast<double>(map.at(x, y)) - expected) < 1e-6;
        differ += same || map.at(x, y) == 1.0f ? 0 : 1;  // 1: taken out of the search
      }
    EXPECT_EQ(differ, 0) << i;
    EXPECT_EQ(map.lowest().reliability, lowest);
    EXPECT_EQ(map.lowest().place, first);
  }
}

TEST(importance_depth, starts_with_the_grid_then_goes_where_reliability_is_lowest) {
  importance_depth sampler({4, 4}, {.sampler = "importance-depth", .samples = 16});
  std::vector<glm::vec2> places;
  for (int i = 0; i < 10; ++i) {
    const auto place = sampler.next();
    ASSERT_TRUE(place);
    if (i >= 9) {
      EXPECT_EQ(*place, sampler.map().lowest().place);
    }
    places.push_back(*place);
    hemicube_view view;
    view.importance = {1, 1, 1, 1};
    sampler.rendered(*place, view);
  }
  EXPECT_EQ(places[0], glm::vec2(1.0f / 6, 1.0f / 6));
  EXPECT_EQ(places[4], glm::vec2(0.5f, 0.5f));
}

TEST(importance_depth, samples_gather_where_the_gap_is) {
  // Half the face sees gaps to the right, half sees a flat wall.
  importance_depth sampler({4, 4}, {.sampler = "importance-depth", .samples = 40});
  int in_gap = 0;
  for (int i = 0; i < 40; ++i) {
    const auto place = sampler.next();
    if (!place) break;
    hemicube_view view;
    if (place->x > 0.5f) view.importance = {1, 1, 1, 1};
    sampler.rendered(*place, view);
    in_gap += place->x > 0.5f;
  }
  EXPECT_GT(in_gap, 24);
}

TEST(importance_depth, ends_when_nothing_is_free) {
  importance_depth sampler({4, 2}, {.sampler = "importance-depth", .samples = 10});
  int asked = 0;
  while (const auto place = sampler.next()) {
    sampler.rejected(*place);
    ASSERT_LT(++asked, 5000);
  }
}

TEST(halton, is_even_and_ends_when_nothing_is_free) {
  const auto places =
      make_face_sampler({.sampler = "halton", .samples = 100}, {4, 4}, random_stream(1, 2, purpose::boundary));
  std::array<int, 4> quarter{};
  for (int i = 0; i < 64; ++i) {
    const auto place = places->next();
    ASSERT_TRUE(place);
    ASSERT_GE(place->x, 0.0f);
    ASSERT_LT(place->x, 1.0f);
    ++quarter[static_cast<std::size_t>((place->x > 0.5f) + 2 * (place->y > 0.5f))];
    places->rendered(*place, {});
  }
  for (const int count : quarter) EXPECT_NEAR(count, 16, 3);
  int asked = 0;
  while (const auto place = places->next()) {
    places->rejected(*place);
    ASSERT_LT(++asked, 5000);
  }
}

TEST(face_sampler, unknown_name_is_an_error) {
  EXPECT_EQ(test::error_id([] {
              make_face_sampler({.sampler = "best", .samples = 1}, {1, 1}, random_stream(1, 1, purpose::boundary));
            }),
            "settings.out-of-range");
}

TEST(uniform_grid, has_as_many_places_as_it_may_and_they_are_even) {
  for (const std::uint32_t samples : {1u, 7u, 44u, 45u}) {
    const auto places =
        make_face_sampler({.sampler = "uniform", .samples = samples}, {8, 2}, random_stream(1, 2, purpose::boundary));
    std::vector<glm::vec2> all;
    while (const auto place = places->next()) all.push_back(*place);
    ASSERT_EQ(all.size(), samples);
    float nearest = 100.0f;
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) nearest = std::min(nearest, glm::length((all[i] - all[k]) * glm::vec2(8, 2)));
    if (samples >= 44) {
      EXPECT_GT(nearest, 0.4f) << "16 square metres, so squares of 0.6 m";
    }
  }
}

TEST(uniform_grid, the_first_half_covers_the_face) {
  const auto places =
      make_face_sampler({.sampler = "uniform", .samples = 64}, {4, 4}, random_stream(1, 2, purpose::boundary));
  std::array<int, 4> quarter{};
  for (int i = 0; i < 32; ++i) {
    const auto place = places->next();
    ++quarter[static_cast<std::size_t>((place->x > 0.5f) + 2 * (place->y > 0.5f))];
  }
  for (const int count : quarter) EXPECT_EQ(count, 8);
}

TEST(quad_difference, is_the_largest_share_of_pixels_that_another_corner_sees_and_one_does_not) {
  const corner_view a{{1, 60}, {2, 40}}, b{{1, 50}, {3, 50}}, c{{1, 100}};
  const auto of = [](std::vector<const corner_view*> corners) { return quad_difference(corners, 100.0); };
  EXPECT_EQ(of({&a, &a, &a}), 0.0);
  EXPECT_EQ(of({&a, &b}), 0.5) << "a lacks 3";
  EXPECT_EQ(of({&a, &b, &c}), 0.9) << "c lacks 2 and 3";
  EXPECT_EQ(of({&a}), 0.0);
  EXPECT_EQ(of({}), 0.0);
}

TEST(nir04, divides_where_corners_see_different_polygons) {
  scripted_source source;
  // What looks toward +x sees another polygon from each half of the face's lower left quarter.
  source.answer = [](const pose& p, hemicube_view& view) {
    if (p.forward.x > 0.5f && p.eye.z > 2.0f && p.eye.y < 2.0f)
      view.seen = {{p.eye.y < 1.0f ? 1u : 2u, 3 * 64 * 64, 0}};
    else
      view.seen = {{3, 3 * 64 * 64, 0}};
  };
  cell_set set(10);
  const auto free = [](const glm::vec3&) { return true; };
  EXPECT_EQ(sample_cell({"nir04", 120, false, 1, 1}, {{0, 0, 0}, {4, 4, 4}}, {}, free, source, set), 120u);
  std::array<int, 2> on_face{};
  for (const pose& p : source.poses)
    if (p.forward.x > 0.5f) ++on_face[p.eye.z >= 2.0f && p.eye.y <= 2.0f ? 1 : 0];
  EXPECT_EQ(on_face[0] + on_face[1], 120 - 5 * 9) << "the other faces are the same everywhere";
  EXPECT_GT(on_face[1], 50);
  EXPECT_EQ(set.sorted(), (std::vector<std::uint32_t>{1, 2, 3}));
  std::set<std::array<float, 6>> places;
  for (const pose& p : source.poses) places.insert({p.eye.x, p.eye.y, p.eye.z, p.forward.x, p.forward.y, p.forward.z});
  EXPECT_EQ(places.size(), 120u) << "no hemicube twice";
}

TEST(nir04, ends_where_nothing_differs) {
  scripted_source source;
  source.answer = [](const pose&, hemicube_view& view) { view.seen = {{3, 10, 0}}; };
  cell_set set(10);
  const auto free = [](const glm::vec3&) { return true; };
  EXPECT_EQ(sample_cell({"nir04", 500, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, free, source, set), 54u);
  EXPECT_EQ(sample_cell({"nir04", 40, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, free, source, set), 24u);
  EXPECT_EQ(sample_cell({"nir04", 6, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, free, source, set), 6u);
}

TEST(nir04, a_cell_that_sees_much_is_sampled_in_parts) {
  scripted_source source;
  source.answer = [](const pose& p, hemicube_view& view) {
    view.seen = {{static_cast<std::uint32_t>(p.eye.x * 10.0f), 10, 0}};
  };
  const auto free = [](const glm::vec3&) { return true; };
  const box where{{0, 0, 0}, {4, 2, 3}};
  const auto inner = [&](std::uint32_t part_polygons) {
    source.poses.clear();
    cell_set set(100);
    const hemicube_plan plan{.samples = 600};
    hemicubes taken(plan, source, set);
    sample_nir04({.part_polygons = part_polygons}, where, free, taken);
    EXPECT_LE(taken.taken(), 600u);
    int on_the_cut = 0;
    for (const pose& p : source.poses) on_the_cut += std::abs(p.forward.x) > 0.5f && p.eye.x == 2.0f ? 1 : 0;
    return on_the_cut;
  };
  EXPECT_EQ(inner(0), 0);
  EXPECT_EQ(inner(50), 0);
  EXPECT_GT(inner(5), 10);
}

TEST(hemicubes, jitter_turns_by_at_most_half_a_pixel) {
  const pose straight;
  double most = 0.0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const pose turned = jittered(straight, 64, random_stream(1, 1, purpose::jitter, 0, i));
    EXPECT_NEAR(glm::length(turned.right), 1.0, 1e-6);
    EXPECT_NEAR(glm::dot(turned.right, turned.up), 0.0, 1e-6);
    EXPECT_NEAR(glm::distance(glm::cross(turned.forward, turned.up), turned.right), 0.0, 1e-6);
    const double right = std::abs(glm::dot(turned.forward, straight.right)),
                 up = std::abs(glm::dot(turned.forward, straight.up));
    EXPECT_LT(std::max(right, up), 0.5 * 2.0 / 64);
    most = std::max(most, right);
  }
  EXPECT_GT(most, 0.4 * 2.0 / 64);
}

TEST(hemicubes, a_limit_of_time_ends_a_cell) {
  scripted_source source;
  cell_set set(10);
  const hemicube_plan plan{.samples = 1000, .seconds = 1e-9};
  hemicubes taken(plan, source, set);
  sample_faces(
      {.sampler = "halton"}, plan, {{0, 0, 0}, {4, 2, 4}}, [](const glm::vec3&) { return true; }, taken);
  EXPECT_LE(taken.taken(), 6u);
}

TEST(hemicubes, are_weighed_before_what_they_see_joins) {
  scripted_source source;
  source.answer = [](const pose&, hemicube_view& view) {
    view.seen = {{3, 10, 0}};
    view.importance = {1, 2, 3, 4};
  };
  cell_set set(10);
  const hemicube_plan plan{.samples = 4};
  hemicubes taken(plan, source, set);
  const std::array<pose, 2> poses{};
  std::array<hemicube_view, 2> views;
  const importance_weight weigh = [&](const pose&, const hemicube_view&) { return set.contains(3) ? 1.0 : 2.0; };
  taken.take(poses, views, weigh);
  EXPECT_EQ(views[0].importance, (std::array<double, 4>{2, 4, 6, 8}));
  EXPECT_EQ(views[1].importance, (std::array<double, 4>{2, 4, 6, 8})) << "a round is weighed by what was before it";
  taken.take(poses, views, weigh);
  EXPECT_EQ(views[0].importance, (std::array<double, 4>{1, 2, 3, 4}));
}

TEST(hemicubes, cubes_leave_time_for_the_faces) {
  scripted_source source;
  source.answer = [](const pose&, hemicube_view&) {
    for (const double began = thread_cpu_seconds(); thread_cpu_seconds() - began < 1e-4;) continue;
  };
  cell_set set(10);
  const std::vector<glm::vec3> interior(100'000, glm::vec3{2, 1, 2});
  const hemicube_plan plan{.samples = 100'000, .geometry_inside = true, .interior_share = 0.25, .seconds = 0.1};
  hemicubes taken(plan, source, set);
  taken.take_interior(interior);
  const std::uint32_t cubes = taken.taken();
  EXPECT_GT(cubes, 32u);
  EXPECT_LT(cubes, 500u);
  EXPECT_GT(taken.left(), 0u);
}

TEST(sample_cell, an_empty_cell_gets_boundary_samples_only) {
  scripted_source source;
  source.answer = [](const pose&, hemicube_view& view) { view.seen = {{3, 10}}; };
  cell_set set(10);
  const std::uint32_t rendered = sample_cell(
      {"importance-depth", 24, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, [](const glm::vec3&) { return true; }, source,
      set);
  EXPECT_EQ(rendered, 24u);
  ASSERT_EQ(source.poses.size(), 24u);
  for (const pose& p : source.poses) {
    // On the boundary and looking out.
    const glm::vec3 step = p.eye + p.forward * 0.01f;
    EXPECT_TRUE(step.x < 0 || step.y < 0 || step.z < 0 || step.x > 4 || step.y > 2 || step.z > 4);
  }
  EXPECT_EQ(set.sorted(), std::vector<std::uint32_t>{3});
}

TEST(sample_cell, half_of_the_images_are_cubes_where_geometry_is_inside) {
  scripted_source source;
  cell_set set(10);
  std::vector<glm::vec3> interior(20, glm::vec3{2, 1, 2});
  const std::uint32_t rendered = sample_cell(
      {"halton", 24, true, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, interior, [](const glm::vec3&) { return true; }, source, set);
  EXPECT_EQ(rendered, 24u);
  int inside = 0;
  glm::vec3 sum{0.0f};
  for (const pose& p : source.poses) {
    if (p.eye != glm::vec3(2, 1, 2)) continue;
    ++inside;
    sum += p.forward;
    EXPECT_EQ(glm::cross(p.forward, p.up), p.right);
  }
  EXPECT_EQ(inside, 12);
  EXPECT_EQ(sum, glm::vec3(0.0f)) << "two hemicubes back to back make a cube";
}

TEST(sample_cell, no_hemicube_stands_in_a_wall) {
  scripted_source source;
  cell_set set(10);
  const auto is_free = [](const glm::vec3& eye) { return eye.x < 2.0f; };
  (void)sample_cell({"importance-depth", 60, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, is_free, source, set);
  EXPECT_GT(source.poses.size(), 20u);
  for (const pose& p : source.poses) EXPECT_TRUE(is_free(p.eye));
}

TEST(sample_cell, a_round_is_one_hemicube_of_each_face_in_their_order) {
  scripted_source source;
  cell_set set(10);
  const auto free = [](const glm::vec3&) { return true; };
  EXPECT_EQ(sample_cell({"importance-depth", 20, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, free, source, set), 20u);
  EXPECT_EQ(source.batches, (std::vector<std::size_t>{6, 6, 6, 2})) << "the last round has two left";
  const auto faces = faces_of({0, 0, 0}, {4, 2, 4});
  for (std::size_t i = 0; i < source.poses.size(); ++i) EXPECT_EQ(source.poses[i].forward, faces[i % 6].outward) << i;
}

TEST(sample_cell, what_a_face_in_a_wall_does_not_use_goes_to_the_others) {
  for (const char* sampler : {"importance-depth", "halton"}) {
    scripted_source source;
    cell_set set(10);
    // The last face, +z, is the one that nobody can stand on: those before it have to get its share.
    const auto is_free = [](const glm::vec3& eye) { return eye.z < 4.0f; };
    EXPECT_EQ(sample_cell({sampler, 48, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, is_free, source, set), 48u);
    std::array<int, 6> each{};
    const auto faces = faces_of({0, 0, 0}, {4, 2, 4});
    for (const pose& p : source.poses)
      for (std::size_t f = 0; f < 6; ++f) each[f] += p.forward == faces[f].outward ? 1 : 0;
    EXPECT_EQ(each, (std::array<int, 6>{10, 10, 10, 9, 9, 0})) << sampler;
  }
}

TEST(sample_cell, nothing_is_asked_where_no_face_is_free) {
  scripted_source source;
  cell_set set(10);
  const auto nowhere = [](const glm::vec3&) { return false; };
  EXPECT_EQ(sample_cell({"halton", 24, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, nowhere, source, set), 0u);
  EXPECT_TRUE(source.poses.empty());
}

TEST(sample_cell, cubes_come_in_batches_of_bounded_size) {
  scripted_source source;
  cell_set set(10);
  const std::vector<glm::vec3> interior(100, glm::vec3{2, 1, 2});
  const auto free = [](const glm::vec3&) { return true; };
  EXPECT_EQ(sample_cell({"halton", 160, true, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, interior, free, source, set), 160u);
  EXPECT_EQ(std::vector<std::size_t>(source.batches.begin(), source.batches.begin() + 4),
            (std::vector<std::size_t>{32, 32, 16, 6}));
}

TEST(sample_cell, threads_change_no_place) {
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, 8);
  // Slow, so that the other threads have the time to take part.
  const auto is_free = [](const glm::vec3& eye) {
    float sum = 0.0f;
    for (int i = 0; i < 4000; ++i) sum += std::sin(5.0f * (eye.x + 2.0f * eye.y + 3.0f * eye.z));
    return sum > 0.0f;
  };
  std::vector<glm::vec3> first;
  for (const int threads : {1, 2, 8}) {
    scripted_source source;
    source.answer = [](const pose& p, hemicube_view& view) {
      for (std::size_t k = 0; k < 4; ++k)
        view.importance[k] = 1.0 + std::sin(static_cast<double>(p.eye.x) * 7 + double(k));
    };
    cell_set set(10);
    tbb::task_arena arena(threads);
    arena.execute([&] {
      EXPECT_EQ(sample_cell({"importance-depth", 90, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, is_free, source, set),
                90u);
    });
    std::vector<glm::vec3> eyes;
    for (const pose& p : source.poses) eyes.push_back(p.eye);
    if (first.empty()) first = eyes;
    EXPECT_EQ(eyes, first) << threads << " threads";
  }
}

}  // namespace
}  // namespace sightcell::bake
