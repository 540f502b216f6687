// Several hemicubes on their way at once, and what the device keeps between them: counts and the union of a cell.
#include <algorithm>
#include <set>

#include "cell_set.h"
#include "gpu_scene.h"
#include "sample_cell.h"
#include "source/polygon_counts.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using sightcell::test::expect_same_view;
using sightcell::test::rooms;
using sightcell::test::tiny_scene;

class gpu_flight_test : public sightcell::test::gpu_test {
 protected:
  static std::unique_ptr<bake::hemicube_source> source(const scene::world_geometry& world, bake::gather how,
                                                       std::uint32_t resolution = 64,
                                                       bake::culling hide = bake::culling::automatic) {
    return bake::make_gpu_source(*context_, world,
                                 {.resolution = resolution, .far_plane = 100.0f, .how = how, .hide = hide});
  }
};

TEST_F(gpu_flight_test, poses_of_one_call_are_answered_as_one_at_a_time) {
  const scene::world_geometry world = rooms().world();
  const std::vector<bake::pose> walk = rooms::walk(17);
  for (const bake::gather how : {bake::gather::read_back, bake::gather::compute}) {
    for (const bake::culling hide : {bake::culling::frustum, bake::culling::occlusion}) {
      const auto alone = source(world, how, 64, hide), together = source(world, how, 64, hide);
      for (const std::size_t at_once : {0u, 1u, 2u, 3u, 4u, 17u}) {
        std::vector<bake::hemicube_view> views(at_once);
        together->render(std::span(walk).first(at_once), views);
        for (std::size_t i = 0; i < at_once; ++i) {
          bake::hemicube_view expected;
          alone->render(walk[i], expected);
          EXPECT_GT(expected.seen.size(), 10u);
          expect_same_view(expected, views[i], std::to_string(i) + " of " + std::to_string(at_once));
        }
      }
    }
  }
}

// The list of a hemicube grows beyond what is read at once, for one in the middle of others.
TEST_F(gpu_flight_test, a_hemicube_sees_many_times_what_the_last_one_saw) {
  tiny_scene specks;
  specks.wall_x(-3, 1, 2);
  for (int y = 0; y < 100; ++y)
    for (int z = 0; z < 100; ++z) {
      const glm::vec3 a(10, static_cast<float>(y) - 50, static_cast<float>(z) - 50);
      specks.triangle(a, a + glm::vec3(0, 0.7f, 0), a + glm::vec3(0, 0, 0.7f), {scene::alpha_mode::opaque, true});
    }
  const scene::world_geometry world = scene::flatten(specks.finished());
  const bake::pose along_x{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  bake::pose back = along_x;
  back.forward.x = -1;
  back.right.z = -1;
  const std::vector<bake::pose> poses{back, along_x, back, along_x, along_x, back};
  std::vector<bake::hemicube_view> views(poses.size());
  source(world, bake::gather::compute, 512)->render(poses, views);
  const auto read_back = source(world, bake::gather::read_back, 512);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    bake::hemicube_view expected;
    read_back->render(poses[i], expected);
    EXPECT_GT(expected.seen.size(), poses[i].forward.x > 0 ? 5000u : 1u);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(views[i].importance[k], expected.importance[k], 1e-4 * expected.importance[k]);
      expected.importance[k] = views[i].importance[k];
    }
    expect_same_view(expected, views[i], std::to_string(i));
  }
}

TEST_F(gpu_flight_test, an_image_between_two_hemicubes_changes_nothing) {
  const scene::world_geometry world = rooms().world();
  const bake::pose from = rooms::walk(1)[0];
  for (const bake::gather how : {bake::gather::read_back, bake::gather::compute}) {
    const auto tested = source(world, how);
    bake::hemicube_view before, after;
    bake::hemicube_image image;
    tested->render(from, before);
    EXPECT_TRUE(std::any_of(before.seen.begin(), before.seen.end(),
                            [&](const bake::seen_polygon& p) { return !world.kinds[p.id].hides(); }));
    tested->render_image(from, image);
    tested->render(from, after);
    expect_same_view(before, after, "after an image");
  }
}

// The sampler's loop over a source that does all it can on the device, and over one that does nothing there.
TEST_F(gpu_flight_test, a_cell_has_the_same_set_by_either_way) {
  const scene::world_geometry world = rooms().world();
  const bake::box cell{{9, 1, 9}, {13, 2, 14}};
  const std::vector<glm::vec3> interior{{10, 1.5f, 10}, {12, 1.2f, 13}};
  const auto is_free = [](const glm::vec3& place) { return place.x < 12.7f || place.z > 10; };
  const bake::sampling_plan plan{.sampler = "halton", .samples = 30, .geometry_inside = true};
  std::vector<std::vector<std::uint32_t>> sets;
  for (const auto& [how, hide] : {std::pair{bake::gather::read_back, bake::culling::none},
                                  std::pair{bake::gather::compute, bake::culling::occlusion}}) {
    bake::cell_set set(static_cast<std::uint32_t>(world.kinds.size()));
    const auto tested = source(world, how, 64, hide);
    EXPECT_GT(bake::sample_cell(plan, cell, interior, is_free, *tested, set), 20u);
    sets.push_back(set.sorted());
  }
  EXPECT_GT(sets[0].size(), 100u);
  EXPECT_EQ(sets[0], sets[1]);
}

TEST_F(gpu_flight_test, the_parts_of_the_cost_are_told) {
  const scene::world_geometry world = rooms().world();
  const bake::pose from = rooms::walk(1)[0];
  for (const bake::gather how : {bake::gather::read_back, bake::gather::compute}) {
    const auto tested = source(world, how);
    bake::hemicube_view view, split_view;
    tested->render(from, view);
    const auto split = tested->render_split(from, split_view);
    ASSERT_TRUE(split);
    EXPECT_GT(split->draw, 0.0);
    EXPECT_GT(split->gather, 0.0);
    expect_same_view(view, split_view, "split");
  }
}

std::set<std::uint32_t> ids_of(const bake::hemicube_view& view) {
  std::set<std::uint32_t> ids;
  for (const bake::seen_polygon& p : view.seen) ids.insert(p.id);
  return ids;
}

TEST_F(gpu_flight_test, while_a_union_is_kept_views_hold_what_is_new) {
  const scene::world_geometry world = rooms().world();
  const std::vector<bake::pose> walk = rooms::walk(12);
  const auto all = source(world, bake::gather::compute), tested = source(world, bake::gather::compute);
  ASSERT_TRUE(tested->keeps_union());
  std::vector<bake::hemicube_view> whole(walk.size()), fresh(walk.size());
  all->render(walk, whole);
  for (int cell = 0; cell < 2; ++cell) {
    tested->begin_union();
    tested->render(std::span(walk).first(5), std::span(fresh).first(5));
    tested->render(std::span(walk).subspan(5), std::span(fresh).subspan(5));
    std::set<std::uint32_t> known;
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < walk.size(); ++i) {
      bake::hemicube_view expected = whole[i];
      std::erase_if(expected.seen, [&](const bake::seen_polygon& p) { return known.count(p.id) > 0; });
      left_out += whole[i].seen.size() - expected.seen.size();
      expect_same_view(expected, fresh[i], "pose " + std::to_string(i));
      known.merge(ids_of(whole[i]));
    }
    EXPECT_GT(left_out, 100u);
    const std::vector<std::uint32_t> met = tested->collect_union();
    EXPECT_TRUE(std::equal(met.begin(), met.end(), known.begin(), known.end()));
  }
  tested->end_union();
  bake::hemicube_view view;
  tested->render(walk[0], view);
  expect_same_view(whole[0], view, "after the union");
}

TEST_F(gpu_flight_test, what_a_union_was_asked_to_show_again) {
  const scene::world_geometry world = rooms().world();
  const bake::pose from = rooms::walk(1)[0];
  const auto tested = source(world, bake::gather::compute);
  bake::hemicube_view first, again;
  tested->begin_union();
  tested->render(from, first);
  ASSERT_GT(first.seen.size(), 40u);
  const std::vector<std::uint32_t> refused{first.seen[3].id, first.seen[4].id, first.seen[39].id};
  tested->render(from, again);
  EXPECT_TRUE(again.seen.empty());
  tested->show_again(refused);
  EXPECT_EQ(tested->collect_union().size(), first.seen.size() - 3);
  tested->render(from, again);
  ASSERT_EQ(again.seen.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(again.seen[i].id, refused[i]);
  EXPECT_EQ(again.importance, first.importance);
}

TEST_F(gpu_flight_test, sources_that_keep_no_union_show_everything) {
  const scene::world_geometry world = rooms().world();
  const bake::pose from = rooms::walk(1)[0];
  const auto tested = source(world, bake::gather::read_back);
  bake::hemicube_view first, again;
  EXPECT_FALSE(tested->keeps_union());
  tested->begin_union();
  tested->render(from, first);
  tested->show_again({});
  tested->render(from, again);
  EXPECT_GT(first.seen.size(), 40u);
  expect_same_view(first, again, "no union");
  EXPECT_TRUE(tested->collect_union().empty());
  tested->end_union();
}

}  // namespace
