#include "sampler/face_sampling.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <array>
#include <glm/geometric.hpp>
#include <vector>

#include "unit/bake/sampler/sample_cell.h"
#include "unit/bake/sampler/scripted_source.h"

namespace sightcell::bake {
namespace {

using test::scripted_source;

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
  const auto is_valid = [](const glm::vec3& eye) { return eye.x < 2.0f; };
  (void)sample_cell({"importance-depth", 60, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, is_valid, source, set);
  EXPECT_GT(source.poses.size(), 20u);
  for (const pose& p : source.poses) EXPECT_TRUE(is_valid(p.eye));
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
    const auto is_valid = [](const glm::vec3& eye) { return eye.z < 4.0f; };
    EXPECT_EQ(sample_cell({sampler, 48, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, is_valid, source, set), 48u);
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
  const auto is_valid = [](const glm::vec3& eye) {
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
      EXPECT_EQ(sample_cell({"importance-depth", 90, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, is_valid, source, set),
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
