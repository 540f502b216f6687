// What the cells of one scene see of another: as if both were one, but for the polygons of the first.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "errors/error_id.h"
#include "input/two_scenes.h"
#include "sightcell/bake/misses.h"
#include "sightcell/bake/recode.h"
#include "sightcell/bake/shards.h"
#include "sightcell/bake/verify.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/writer.h"
#include "sightcell/sightcell.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

namespace fs = std::filesystem;
using test::error_id;
using test::tiny_scene;
using polygons = std::vector<std::uint32_t>;
constexpr tiny_scene::look sheet{scene::alpha_mode::opaque, true};

// A part of the room's wall at x = 3.
std::uint32_t wall(tiny_scene& tiny, float y0, float y1, float z0, float z1) {
  return tiny.quad({3, y0, z0}, {3, y0, z1}, {3, y1, z1}, {3, y1, z0}, sheet);
}

// A: a room of 6 x 4 x 6 m whose wall at x = 3 has a window of one meter.
void add_room(tiny_scene& tiny) {
  wall(tiny, -2, -0.5f, -3, 3), wall(tiny, 0.5f, 2, -3, 3);
  wall(tiny, -0.5f, 0.5f, -3, -0.5f), wall(tiny, -0.5f, 0.5f, 0.5f, 3);
  tiny.quad({-3, -2, -3}, {-3, -2, 3}, {-3, 2, 3}, {-3, 2, -3}, sheet);
  for (const float y : {-2.0f, 2.0f}) tiny.quad({-3, y, -3}, {-3, y, 3}, {3, y, 3}, {3, y, -3}, sheet);
  for (const float z : {-3.0f, 3.0f}) tiny.quad({-3, -2, z}, {3, -2, z}, {3, 2, z}, {-3, 2, z}, sheet);
}

// Where closed_box has the polygons of its sides.
constexpr std::uint32_t at_low_z = 0, at_high_z = 2, at_low_x = 8;

// B: outside a row of boxes, of which the middle one and those beside it are seen through the window; a pillar inside
// of the room; and the lower part of the wall once more. Returns what the first cell sees.
polygons add_objects(tiny_scene& tiny) {
  polygons seen;
  const auto add = [&](std::uint32_t first) { seen.insert(seen.end(), {first, first + 1}); };
  tiny.closed_box({6, -0.8f, 2}, {6.4f, 0.8f, 2.2f});  // behind the wall
  add(tiny.closed_box({6, -0.8f, -0.6f}, {6.4f, 0.8f, 0.6f}) + at_low_x);
  const auto left = tiny.closed_box({6, -0.8f, 0.8f}, {6.4f, 0.8f, 1.0f});
  add(left + at_low_x), add(left + at_low_z);
  const auto right = tiny.closed_box({6, -0.8f, -1.0f}, {6.4f, 0.8f, -0.8f});
  add(right + at_low_x), add(right + at_high_z);
  tiny.closed_box({6, -0.8f, -9}, {6.4f, 0.8f, -8});
  const auto pillar = tiny.closed_box({1.5f, -1, 1.5f}, {2.9f, 1, 2.9f});
  add(pillar + at_low_x), add(pillar + at_low_z);
  add(wall(tiny, -2, -0.5f, -3, 3));
  std::sort(seen.begin(), seen.end());
  return seen;
}

class two_scenes : public testing::Test {
 protected:
  two_scenes() {
    tiny_scene room, objects, both;
    add_room(room);
    seen_ = add_objects(objects);
    add_objects(both);
    add_room(both);
    room_ = room.finished(), objects_ = objects.finished(), both_ = both.finished();
    how_.cells = {{"", {-2, -0.5f, -0.5f}, {-1, 0.5f, 0.5f}},
                  {"", {2, -0.3f, 2}, {2.4f, 0.3f, 2.4f}},       // in the pillar, which is of the other scene
                  {"", {4, -0.3f, -0.3f}, {4.5f, 0.3f, 0.3f}}};  // outside of the window
    how_.margin = 0.0f;
    how_.source = "cpu";
    how_.resolution = 64;
    how_.file.profile = slack_profile::exact;
    how_.cells_from = &room_;
  }
  fs::path baked(const char* name, const scene::scene& s, const settings& how) {
    last_ = bake(s, how, folder_ / name, true, {});
    return folder_ / name;
  }
  fs::path crossed(const char* name = "room_sees_objects.pvs") { return baked(name, objects_, how_); }
  verification check(const fs::path& file, const scene::scene& s, const scene::scene* cells_from) {
    verify_settings how;
    how.rays = 100'000;
    how.cells_from = cells_from;
    return verify(s, test::file_bytes(file), file.string(), how, {});
  }

  test::fresh_folder folder_;
  scene::scene room_, objects_, both_;
  polygons seen_;
  settings how_;
  summary last_;
};

TEST_F(two_scenes, give_the_sets_that_they_have_as_one) {
  settings as_one = how_;
  as_one.cells_from = nullptr;
  for (const char* source : {"cpu", "rays"}) {
    how_.source = as_one.source = source;
    test::stored_file crossed_file(test::file_bytes(crossed()));
    EXPECT_EQ(last_.cells_left_out, 1u) << "what of the other scene is solid is solid";
    test::stored_file whole(test::file_bytes(baked("whole.pvs", both_, as_one)));
    ASSERT_EQ(crossed_file.reader().cell_count(), 2u);
    EXPECT_EQ(crossed_file.set(0), seen_) << source;
    EXPECT_LT(crossed_file.set(1).size(), objects_.polygon_count);
    for (const std::uint32_t cell : {0u, 1u}) {
      polygons expected = whole.set(cell);
      EXPECT_GT(expected.back(), objects_.polygon_count) << "the room is seen too";
      std::erase_if(expected, [&](std::uint32_t polygon) { return polygon >= objects_.polygon_count; });
      EXPECT_EQ(crossed_file.set(cell), expected) << source << ", cell " << cell;
    }
    const format::reader& file = crossed_file.reader();
    EXPECT_EQ(file.polygon_count(), objects_.polygon_count);
    EXPECT_EQ(file.draw_count(), objects_.draws.size());
    EXPECT_EQ(file.facts().scene_fingerprint, objects_.fingerprint);
    EXPECT_NE(std::string(file.settings()).find(R"("cells_from":")" + fingerprint_text(room_)), std::string::npos);
  }
}

TEST(joined_scenes, have_the_opacity_maps_of_both) {
  tiny_scene one, other;
  one.masked_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {8, 1, {0, 0, 0, 0, 255, 255, 255, 255}});
  other.masked_quad({0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {8, 1, {255, 255, 255, 255, 0, 0, 0, 0}});
  scene::world_geometry world = scene::flatten(one.finished()), added = scene::flatten(other.finished());
  const auto known = [](const scene::world_geometry& of, std::size_t masked) {
    std::vector<scene::opacity> out;
    for (const float u : {0.1f, 0.5f, 0.8f}) out.push_back(of.opacity.at(masked, u, 0.1f));
    return out;
  };
  const std::vector<scene::opacity> first = known(world, 0), second = known(added, 0);
  ASSERT_NE(first, second);
  append(world, std::move(added), false, "other");
  ASSERT_EQ(world.opacity.map_of.size(), 4u);
  EXPECT_EQ(known(world, 0), first);
  EXPECT_EQ(known(world, 2), second);
}

TEST_F(two_scenes, have_the_cells_of_one) {
  // The other one has a floor, where nobody walks.
  tiny_scene other;
  add_objects(other);
  other.quad({40, 0, -9}, {40, 0, 9}, {60, 0, 9}, {60, 0, -9});
  const scene::scene objects = other.finished();
  how_.cells.clear();
  how_.cell_size = 2.0f;
  const auto farthest_cell = [&](const char* name) {
    test::stored_file file(test::file_bytes(baked(name, objects, how_)));
    EXPECT_GT(file.reader().cell_count(), 1u);
    float farthest = -100.0f;
    for (std::uint32_t cell = 0; cell < file.reader().cell_count(); ++cell) {
      format::box b;
      EXPECT_EQ(file.reader().cell_box(cell, b), format::status::ok);
      farthest = std::max(farthest, b.max[0]);
    }
    return farthest;
  };
  EXPECT_LE(farthest_cell("floor.pvs"), 4.0f);
  how_.cells_from = nullptr;
  EXPECT_GE(farthest_cell("own.pvs"), 58.0f) << "its own floor";
}

TEST_F(two_scenes, are_both_asked_by_verify) {
  const fs::path file = crossed();
  EXPECT_EQ(check(file, objects_, &room_).misses, 0u);
  EXPECT_EQ(error_id([&] { (void)check(file, objects_, nullptr); }), "pvs.two-scenes");
  EXPECT_EQ(error_id([&] { (void)check(file, objects_, &objects_); }), "pvs.other-scene");
  EXPECT_EQ(error_id([&] { (void)check(file, room_, &room_); }), "pvs.other-scene");
  settings as_one = how_;
  as_one.cells_from = nullptr;
  EXPECT_EQ(error_id([&] { (void)check(baked("one.pvs", objects_, as_one), objects_, &room_); }), "pvs.other-scene");

  // A bake of the objects alone, which nothing hides, has all that the room sees of them and more; one that lacks a
  // polygon is found out.
  how_.max_pixel_error = 0.0;
  how_.sampler = "uniform";
  how_.samples = 6;
  how_.resolution = 16;
  const fs::path weak = crossed("weak.pvs");
  test::stored_file has(test::file_bytes(weak));
  polygons lacks;
  for (const std::uint32_t polygon : seen_)
    if (!has.has(0, polygon)) lacks.push_back(polygon);
  ASSERT_FALSE(lacks.empty()) << "this bake is too good to show anything";
  EXPECT_GT(check(weak, objects_, &room_).misses, 0u);

  // The same of what a host found missing, and what the wall hides is not seen.
  const fs::path misses = folder_ / "misses.json";
  std::ofstream(misses) << fmt::format(
      R"({{"misses":[{{"eye":[-1.5,0,0],"polygon":{}}},{{"eye":[-1.5,0,0],"polygon":{}}}]}})", lacks.front(), at_low_x);
  const auto tried = [&](const fs::path& baked_file) {
    return check_misses(objects_, test::file_bytes(baked_file), baked_file.string(), misses, {.cells_from = &room_},
                        {});
  };
  EXPECT_EQ(tried(weak).reproduced, 1u);
  EXPECT_EQ(tried(weak).not_visible, 1u) << "it is behind the wall";
  how_.misses_file = misses;
  EXPECT_EQ(tried(crossed("repaired.pvs")).reproduced, 0u);
}

TEST_F(two_scenes, excuse_what_lies_in_the_same_place) {
  // A poster on the wall: where it is missing the wall shows, as rule 2 of seeing has it.
  tiny_scene with_poster;
  add_objects(with_poster);
  const auto poster = with_poster.quad({3, 1, -1}, {3, 1, 1}, {3, 1.5f, 1}, {3, 1.5f, -1}, sheet);
  const scene::scene objects = with_poster.finished();
  const auto whole = test::file_bytes(baked("poster.pvs", objects, how_));
  test::stored_file file(whole);
  EXPECT_TRUE(file.has(0, poster) && file.has(0, poster + 1));
  format::file_parts parts;
  ASSERT_EQ(format::take_apart(file.reader(), parts), format::status::ok);
  std::vector<polygons> sets{file.set(0), file.set(1)};
  std::erase(sets[0], poster);
  std::erase(sets[0], poster + 1);
  std::vector<std::byte> bytes;
  ASSERT_EQ(format::encode(parts.contents(format::sets_of(sets)), bytes), format::status::ok);
  verify_settings how;
  how.cells_from = &room_;
  EXPECT_EQ(verify(objects, bytes, "poster.pvs", how, {}).misses, 0u);
  const fs::path misses = folder_ / "misses.json";
  std::ofstream(misses) << fmt::format(R"({{"misses":[{{"eye":[-1.5,0,0],"polygon":{}}}]}})", poster);
  EXPECT_EQ(check_misses(objects, bytes, "poster.pvs", misses, how, {}).not_missing, 1u);
}

TEST_F(two_scenes, are_opened_side_by_side_by_the_runtime) {
  const fs::path other = crossed();
  settings own = how_;
  own.cells_from = nullptr;
  const fs::path level = baked("room.pvs", room_, own);
  const std::array<float, 3> eye{-1.5f, 0.0f, 0.0f};
  const auto visible = [&](const fs::path& path) {
    sightcell_db* db = nullptr;
    sightcell_view* view = nullptr;
    sightcell_frame frame{};
    EXPECT_EQ(sightcell_db_open_file(path.c_str(), nullptr, &db), SIGHTCELL_OK);
    EXPECT_EQ(sightcell_view_create(db, &view), SIGHTCELL_OK);
    EXPECT_EQ(sightcell_view_move(view, eye.data(), &frame), SIGHTCELL_OK);
    EXPECT_EQ(frame.flags & (SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE), 0u);
    polygons ids(frame.polygon_count);
    std::size_t count = 0;
    EXPECT_EQ(sightcell_view_polygons(view, ids.data(), ids.size(), &count), SIGHTCELL_OK);
    EXPECT_EQ(count, ids.size());
    sightcell_view_destroy(view);
    sightcell_db_close(db);
    std::sort(ids.begin(), ids.end());
    return ids;
  };
  EXPECT_EQ(visible(other), seen_);
  EXPECT_EQ(visible(level).size(), room_.polygon_count) << "all of the room's own walls";
}

TEST_F(two_scenes, give_the_same_bytes_in_shards_and_on_any_threads) {
  how_.safety_ring = safety_ring::vertex;
  how_.file.importance = true;
  how_.threads = 1;
  const auto one = test::file_bytes(crossed());
  EXPECT_GT(last_.unseen_per_cell, 0.0);
  test::stored_file file(one);
  for (const std::uint32_t cell : {0u, 1u}) EXPECT_LT(file.set(cell).back(), objects_.polygon_count);
  how_.threads = 3;
  EXPECT_EQ(test::file_bytes(crossed()), one);

  how_.file.importance = false;
  const auto plain = test::file_bytes(crossed());
  for (const std::uint32_t phase : {1u, 2u})
    for (const std::uint32_t i : {0u, 1u})
      (void)bake_shard(objects_, how_, folder_ / "m.pvs", {i, 2, phase}, false, {});
  (void)merge(find_shard_files(folder_ / "m.pvs"), folder_ / "m.pvs", {});
  EXPECT_EQ(test::file_bytes(folder_ / "m.pvs"), plain);
  how_.cells_from = &objects_;
  EXPECT_EQ(error_id([&] {
              (void)bake_shard(objects_, how_, folder_ / "m.pvs", {0, 2, 2}, false, {});
            }),
            "shard.other-bake");
}

TEST_F(two_scenes, are_refused_where_one_is_looked_at) {
  const fs::path file = crossed();
  const auto with = [&](auto change) {
    settings how = how_;
    change(how);
    return error_id([&] { (void)bake(objects_, how, folder_ / "no.pvs", true, {}); });
  };
  EXPECT_EQ(with([](settings& how) { how.metric.kind = metric_kind::color; }), "settings.two-scenes");
  EXPECT_EQ(with([](settings& how) { how.sampler = "importance-depth-color"; }), "settings.two-scenes");
  verify_settings by_color;
  by_color.cells_from = &room_;
  by_color.metric.kind = metric_kind::color;
  EXPECT_EQ(error_id([&] { (void)verify(objects_, test::file_bytes(file), file.string(), by_color, {}); }),
            "settings.two-scenes");
  recode_settings with_importance;
  with_importance.importance_in = &objects_;
  EXPECT_EQ(error_id([&] { (void)recode(test::file_bytes(file), file.string(), with_importance, file); }),
            "recode.two-scenes");
  recode_settings merged;
  merged.layout = host_layout::merged;
  merged.layout_from = &objects_;
  EXPECT_EQ(error_id([&] { (void)recode(test::file_bytes(file), file.string(), merged, folder_ / "merged.pvs"); }), "");
  test::stored_file recoded(test::file_bytes(folder_ / "merged.pvs"));
  EXPECT_EQ(recoded.set(0), seen_);
  EXPECT_EQ(check(folder_ / "merged.pvs", objects_, &room_).misses, 0u) << "the settings text is kept";
}

TEST(append, puts_masks_and_bounds_behind) {
  const scene::alpha_map checker{2, 1, {255, 0}};
  tiny_scene a, b;
  a.masked_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, checker);
  b.wall_x(-5, 1, 1);
  b.masked_quad({0, 0, 3}, {1, 0, 3}, {1, 1, 3}, {0, 1, 3}, checker);
  b.masked_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, checker);  // where a has one
  scene::world_geometry geometry = scene::flatten(a.finished());
  append(geometry, scene::flatten(b.finished()), false, "b");
  ASSERT_EQ(geometry.kinds.size(), 8u);
  EXPECT_EQ(geometry.min.x, -5.0f);
  EXPECT_EQ(geometry.max.z, 3.0f);
  std::vector<std::uint32_t> tested;
  for (const scene::masked_polygon& m : geometry.masked) {
    tested.push_back(m.id);
    EXPECT_LT(m.mask, geometry.masks.size());
    EXPECT_EQ(m.mask, m.id < 2 ? 0u : 1u);
  }
  EXPECT_EQ(tested, (polygons{0, 1, 4, 5})) << "those that lie on others are absent";
  for (const std::uint32_t polygon : {6u, 7u}) EXPECT_TRUE(geometry.kinds[polygon].absent);
  for (const std::uint32_t polygon : {0u, 2u, 5u}) EXPECT_FALSE(geometry.kinds[polygon].absent);
  for (const std::uint32_t vertex : geometry.indices) EXPECT_LT(vertex, geometry.positions.size());
}

}  // namespace
}  // namespace sightcell::bake
