#include "sightcell/sightcell.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "unit/format/caster_samples.h"
#include "unit/format/light_samples.h"
#include "unit/format/residency_samples.h"
#include "unit/format/sample_contents.h"

namespace {

TEST(sightcell_hpp, the_whole_path) {
  const auto contents = sightcell::test::small_contents();
  const auto bytes = contents.encode();
  auto opened = sightcell::db::open(bytes);
  ASSERT_TRUE(opened) << opened.text();
  const sightcell::db file = std::move(*opened);
  EXPECT_EQ(file.polygon_count(), 300u);
  EXPECT_EQ(file.cell_count(), 67u);
  EXPECT_EQ(file.check(), SIGHTCELL_OK);
  const auto info = file.info();
  ASSERT_TRUE(info);
  const auto box = file.cell_box(3);
  ASSERT_TRUE(box);
  EXPECT_EQ(box->min, contents.cells[3].min);
  EXPECT_EQ(file.cell_box(999).status(), SIGHTCELL_ERR_ARGUMENT);
  std::vector<sightcell_draw> draws(info->draw_count);
  EXPECT_TRUE(file.draws(draws));
  std::vector<std::uint32_t> order(300);
  EXPECT_TRUE(file.order(order));

  auto made = sightcell::view::create(file);
  ASSERT_TRUE(made);
  sightcell::view camera = std::move(*made);
  sightcell_frame frame;
  const float eye[3] = {3.5f, 0.5f, 0.5f};
  EXPECT_EQ(camera.move(eye, frame), SIGHTCELL_OK);
  EXPECT_EQ(frame.cell, 3u);
  std::vector<std::uint32_t> ids(300);
  auto listed = camera.polygons(ids);
  ASSERT_TRUE(listed);
  ids.resize(listed.count);
  EXPECT_EQ(ids, contents.sets[3]);
  std::vector<sightcell_range> ranges(info->range_bound);
  EXPECT_TRUE(camera.ranges(ranges));
  const std::vector<std::uint32_t> stored(900, 7);
  std::vector<std::uint32_t> indices(900);
  EXPECT_EQ(camera.indices(stored, indices).count, 3 * ids.size());
  const auto changes = camera.changes(0, ranges, {});
  EXPECT_TRUE(changes);
  EXPECT_EQ(changes.removed, 0u);
  EXPECT_EQ(camera.polygons({}).status, SIGHTCELL_ERR_CAPACITY);
}

TEST(sightcell_hpp, clusters) {
  const auto bytes = sightcell::test::tiny_contents().encode();
  const auto file = sightcell::db::open(bytes);
  ASSERT_TRUE(file);
  const std::array<std::uint32_t, 6> table{0, 0, 1, 2, 2, 40};
  EXPECT_EQ(sightcell::cluster_map::create(*file, table, 40).status(), SIGHTCELL_ERR_ARGUMENT);
  auto made = sightcell::cluster_map::create(*file, table, 41);
  ASSERT_TRUE(made);
  const sightcell::cluster_map map = std::move(*made);
  auto camera = sightcell::view::create(*file);
  ASSERT_TRUE(camera);
  sightcell_frame frame;
  std::array<std::uint32_t, 2> before{}, row{};
  const float first[3] = {1, 1, 1}, second[3] = {5, 1, 1};
  EXPECT_EQ(camera->move(first, frame), SIGHTCELL_OK);
  EXPECT_EQ(camera->clusters(map, before), SIGHTCELL_OK);
  EXPECT_EQ(before, (std::array<std::uint32_t, 2>{7, 0}));
  EXPECT_EQ(camera->move(second, frame), SIGHTCELL_OK);
  EXPECT_EQ(camera->clusters(map, row), SIGHTCELL_OK);
  std::array<std::uint32_t, 1> list{};
  EXPECT_EQ(sightcell::cluster_map::list(row, list).count, 1u);
  EXPECT_EQ(list[0], 40u);
  std::array<sightcell_cluster_word, 2> words{};
  EXPECT_EQ(sightcell::cluster_map::changes(before, row, words).count, 2u);
  EXPECT_EQ(words[1].index, 1u);
  EXPECT_EQ(words[1].bits, 256u);
  EXPECT_EQ(sightcell::cluster_map::changes(before, std::span(row).first(1), words).status, SIGHTCELL_ERR_ARGUMENT);
}

TEST(sightcell_hpp, casters) {
  const auto contents = sightcell::test::small_contents();
  const auto bytes = sightcell::test::with_casters(contents.encode(), sightcell::test::sample_casters(contents));
  const auto file = sightcell::db::open(bytes);
  ASSERT_TRUE(file);
  auto made = sightcell::casters::create(*file);
  ASSERT_TRUE(made);
  sightcell::casters casters = std::move(*made);
  std::array<sightcell_sun, 2> suns{};
  EXPECT_EQ(casters.suns(suns).count, 2u);
  auto camera = sightcell::view::create(*file);
  ASSERT_TRUE(camera);
  sightcell_frame frame;
  const float eye[3] = {3.5f, 0.5f, 0.5f};
  EXPECT_EQ(camera->move(eye, frame), SIGHTCELL_OK);
  std::vector<sightcell_range> ranges(300);
  const auto listed = camera->shadow_ranges(casters, 1, ranges);
  ASSERT_TRUE(listed);
  std::uint32_t polygons = 0;
  for (std::size_t i = 0; i < listed.count; ++i) polygons += ranges[i].count;
  EXPECT_GT(polygons, contents.sets[3].size());
  const std::vector<std::uint32_t> stored(900, 7);
  std::vector<std::uint32_t> indices(900);
  EXPECT_EQ(camera->shadow_indices(casters, 1, stored, indices).count, 3 * std::size_t{polygons});
  EXPECT_EQ(sightcell::casters().suns(suns).status, SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(camera->shadow_ranges(casters, 2, ranges).status, SIGHTCELL_ERR_ARGUMENT);
}

TEST(sightcell_hpp, lights) {
  const auto contents = sightcell::test::small_contents();
  const sightcell::test::sample_lights samples(contents);
  const auto bytes = sightcell::test::with_lights(contents.encode(), samples);
  const auto file = sightcell::db::open(bytes);
  ASSERT_TRUE(file);
  auto made = sightcell::lights::create(*file);
  ASSERT_TRUE(made);
  sightcell::lights lights = std::move(*made);
  std::array<sightcell_light, 10> list{};
  EXPECT_EQ(lights.list(list).count, 10u);
  EXPECT_EQ(list[9].node, samples.lights[9].node);
  auto camera = sightcell::view::create(*file);
  ASSERT_TRUE(camera);
  sightcell_frame frame;
  const float eye[3] = {3.5f, 0.5f, 0.5f};
  EXPECT_EQ(camera->move(eye, frame), SIGHTCELL_OK);
  std::array<std::uint32_t, 10> here{};
  EXPECT_GT(camera->lights_here(lights, here).count, 0u);
  std::vector<sightcell_range> ranges(300);
  const auto listed = camera->lit_ranges(lights, 3, ranges);
  ASSERT_TRUE(listed);
  std::uint32_t polygons = 0;
  for (std::size_t i = 0; i < listed.count; ++i) polygons += ranges[i].count;
  EXPECT_EQ(polygons, samples.sets[3].size());
  const std::vector<std::uint32_t> stored(900, 7);
  std::vector<std::uint32_t> indices(900);
  EXPECT_EQ(camera->lit_indices(lights, 3, stored, indices).count, 3 * std::size_t{polygons});
  EXPECT_EQ(sightcell::lights().list(list).status, SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(camera->lit_ranges(lights, 10, ranges).status, SIGHTCELL_ERR_ARGUMENT);
}

TEST(sightcell_hpp, residency) {
  const auto contents = sightcell::test::small_contents();
  const auto bytes = sightcell::test::with_residency(contents.encode(), sightcell::test::sample_residency(contents));
  const auto file = sightcell::db::open(bytes);
  ASSERT_TRUE(file);
  auto made = sightcell::residency::create(*file);
  ASSERT_TRUE(made);
  sightcell::residency residency = std::move(*made);
  std::array<sightcell_texture, 3> textures{};
  EXPECT_EQ(residency.textures(textures).count, 3u);
  EXPECT_EQ(textures[0].width, 1024u);
  auto camera = sightcell::view::create(*file);
  ASSERT_TRUE(camera);
  sightcell_frame frame;
  const float eye[3] = {3.5f, 0.5f, 0.5f};
  EXPECT_EQ(camera->move(eye, frame), SIGHTCELL_OK);
  std::array<std::uint8_t, 3> here{}, of_cell{};
  ASSERT_TRUE(camera->texture_levels(residency, 1000.0f, here));
  ASSERT_TRUE(residency.levels(3, 1000.0f, of_cell));
  EXPECT_EQ(here, of_cell);
  EXPECT_EQ(sightcell::residency().textures(textures).status, SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(camera->texture_levels(residency, -1.0f, here).status, SIGHTCELL_ERR_ARGUMENT);
}

TEST(sightcell_hpp, an_opening_that_does_not_wait) {
  struct {
    std::uint32_t size = 0, ticket = 0;
  } asked;
  const auto bytes = sightcell::test::small_contents().encode();
  const sightcell_source source{&asked, bytes.size(),
                                [](void* user, std::uint64_t, std::uint32_t size, std::uint32_t ticket) {
                                  *static_cast<decltype(asked)*>(user) = {size, ticket};
                                  return SIGHTCELL_OK;
                                }};
  sightcell_db* handle = nullptr;
  auto begun = sightcell::db::begin_source(source, 1 << 20, handle);
  ASSERT_TRUE(begun);
  sightcell::db file = std::move(*begun);
  for (int request = 0; request < 2; ++request) {
    EXPECT_EQ(file.opened(), SIGHTCELL_PENDING);
    EXPECT_EQ(sightcell::view::create(file).status(), SIGHTCELL_PENDING);
    EXPECT_EQ(file.deliver(asked.ticket, std::span(bytes).first(asked.size)), SIGHTCELL_OK);
  }
  EXPECT_EQ(file.opened(), SIGHTCELL_OK);
  EXPECT_EQ(file.same_scene(file.info()->scene_fingerprint), SIGHTCELL_OK);
  const std::array<std::uint8_t, 16> other{1};
  EXPECT_EQ(file.same_scene(other), SIGHTCELL_ERR_OTHER_SCENE);
}

TEST(sightcell_hpp, named_groups) {
  auto contents = sightcell::test::small_contents();
  contents.named_groups = {"door", "lamp"};
  contents.draws[2].named_group = 1;
  const auto bytes = contents.encode();
  auto opened = sightcell::db::open(bytes);
  ASSERT_TRUE(opened);
  const sightcell::db file = std::move(*opened);
  EXPECT_EQ(file.named_group_count(), 2u);
  EXPECT_EQ(file.find_named_group("lamp"), 1u);
  EXPECT_EQ(file.find_named_group("lam"), SIGHTCELL_NO_NAMED_GROUP);
  std::string name(4, ' ');
  EXPECT_EQ(file.named_group_name(1, name).count, 4u);
  EXPECT_EQ(name, "lamp");
  std::vector<std::uint32_t> groups(contents.draws.size());
  ASSERT_TRUE(file.named_groups_of_draws(groups));
  EXPECT_EQ(groups[1], SIGHTCELL_NO_NAMED_GROUP);
  EXPECT_EQ(groups[2], 1u);

  auto made = sightcell::view::create(file);
  ASSERT_TRUE(made);
  sightcell::view camera = std::move(*made);
  const float eye[3] = {3.5f, 0.5f, 0.5f};
  sightcell_frame all;
  sightcell_frame without;
  EXPECT_EQ(camera.move(eye, all), SIGHTCELL_OK);
  EXPECT_EQ(camera.show_named_group(1, false), SIGHTCELL_OK);
  EXPECT_EQ(camera.move(eye, without), SIGHTCELL_OK);
  EXPECT_LT(without.polygon_count, all.polygon_count);
  EXPECT_EQ(camera.show_named_group(1, true), SIGHTCELL_OK);
  EXPECT_EQ(camera.move(eye, without), SIGHTCELL_OK);
  EXPECT_EQ(without.polygon_count, all.polygon_count);
  EXPECT_EQ(camera.show_named_group(2, true), SIGHTCELL_ERR_ARGUMENT);
}

TEST(sightcell_hpp, viewpoints) {
  auto contents = sightcell::test::tiny_contents();
  contents.player_radius = 0.125f;
  contents.viewpoints = {{.cell = 0, .valid_share = 0.5f, .outside_share = 0.25, .region = {std::byte{0x12}}},
                         {.cell = 1, .region = {}, .eyes = {{7, 7, 7}, {0, 2048, 4095}}}};
  const auto bytes = contents.encode();
  const auto file = sightcell::db::open(bytes);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->info()->player_radius, 0.125f);
  const auto shares = file->viewpoints_of_cell(0);
  ASSERT_TRUE(shares);
  EXPECT_EQ(shares->valid_share, 0.5f);
  EXPECT_EQ(shares->outside_share, 0.25f);
  EXPECT_EQ(file->viewpoints_of_cell(1)->valid_share, 1.0f);
  EXPECT_EQ(file->viewpoints_of_cell(2).status(), SIGHTCELL_ERR_ARGUMENT);
  const auto eye = file->cell_eye(1, 1);  // the box is (4, 0, 0) to (8, 2, 4)
  ASSERT_TRUE(eye);
  EXPECT_EQ(*eye, (std::array<float, 3>{4.00048828125f, 1.000244140625f, 3.99951171875f}));
  EXPECT_EQ(file->cell_eye(0).status(), SIGHTCELL_ERR_ABSENT);
}

TEST(sightcell_hpp, identity_of_draws) {
  auto contents = sightcell::test::tiny_contents();
  contents.geometry_hashes = {9};
  contents.node_names = {"", "", "Tor"};
  const auto bytes = contents.encode();
  const auto file = sightcell::db::open(bytes);
  ASSERT_TRUE(file);
  EXPECT_EQ(*file->draw_hash(0), 9u);
  std::array<char, 8> name{};
  EXPECT_EQ(file->draw_name(0, SIGHTCELL_NAME_NODE, name).count, 3u);
  EXPECT_STREQ(name.data(), "Tor");
  const std::array<std::uint64_t, 2> hashes{8, 9};
  std::array<std::uint32_t, 2> draws{};
  sightcell_draw_match counts;
  EXPECT_EQ(file->match(hashes, {}, draws, counts), SIGHTCELL_ERR_OTHER_SCENE);
  EXPECT_EQ(draws, (std::array<std::uint32_t, 2>{SIGHTCELL_NO_DRAW, 0}));
  EXPECT_EQ(counts.first_extra, 0u);
  EXPECT_EQ(file->match(hashes, {}, std::span(draws).first(1), counts), SIGHTCELL_ERR_ARGUMENT);
}

TEST(sightcell_hpp, failures_are_values) {
  const auto file = sightcell::db::open({});
  EXPECT_FALSE(file);
  EXPECT_EQ(file.status(), SIGHTCELL_ERR_TRUNCATED);
  EXPECT_EQ(sightcell::db::open_file("no such file").status(), SIGHTCELL_ERR_IO);
  EXPECT_EQ(sightcell::view::create(sightcell::db()).status(), SIGHTCELL_ERR_ARGUMENT);
  sightcell::view none;
  sightcell_frame frame;
  const float eye[3] = {0, 0, 0};
  EXPECT_EQ(none.move(eye, frame), SIGHTCELL_ERR_ARGUMENT);
}

}  // namespace
