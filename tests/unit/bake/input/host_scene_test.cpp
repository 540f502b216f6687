#include "input/host_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>

#include "errors/error_id.h"
#include "sightcell/bake/host_scene.h"
#include "sightcell/bake/shards.h"
#include "sightcell/bake/verify.h"
#include "sightcell/base/error.h"
#include "sightcell/format/reader.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/stored_file.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

// The arrays of an engine, and a host_scene over them.
struct engine {
  std::vector<std::vector<float>> positions;
  std::vector<std::vector<std::uint32_t>> indices;
  std::vector<host_mesh> meshes;
  std::vector<host_material> materials;
  std::vector<host_draw> draws;

  host_scene view() const { return {"engine", meshes, materials, draws}; }

  std::uint32_t mesh(std::vector<float> p, std::vector<std::uint32_t> i) {
    positions.push_back(std::move(p));
    indices.push_back(std::move(i));
    host_mesh m;
    m.positions = positions.back().data();
    m.vertex_count = positions.back().size() / 3;
    m.indices = indices.back().data();
    m.index_count = indices.back().size();
    meshes.push_back(m);
    return static_cast<std::uint32_t>(meshes.size() - 1);
  }
  // A unit square in x and y, facing +z.
  std::uint32_t square() { return mesh({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, {0, 1, 2, 0, 2, 3}); }
  host_draw& draw(std::uint32_t mesh_number) {
    draws.emplace_back().mesh = mesh_number;
    return draws.back();
  }
};

std::string refusal(const engine& e) {
  try {
    (void)scene_of(e.view());
  } catch (const error& failure) {
    EXPECT_EQ(failure.kind(), error_kind::bad_input);
    return failure.what();
  }
  return {};
}

TEST(host_scene, arrays_become_the_same_scene) {
  test::tiny_scene tiny;
  tiny.closed_box({-1, -2, -3}, {1, 2, 3});
  tiny.wall_x(4, -1, 2, {scene::alpha_mode::blend, true});
  const scene::scene expected = tiny.finished();

  engine e;
  for (const scene::geometry& g : expected.geometries) {
    std::vector<float> p;
    for (const glm::vec3& v : g.positions) p.insert(p.end(), {v.x, v.y, v.z});
    e.mesh(std::move(p), g.indices);
  }
  for (const scene::material& m : expected.materials) {
    host_material& to = e.materials.emplace_back();
    to.alpha = m.alpha;
    to.double_sided = m.double_sided;
  }
  for (const scene::draw& d : expected.draws) e.draw(d.geometry).material = d.material;
  const scene::scene got = scene_of(e.view());
  EXPECT_EQ(got.polygon_count, expected.polygon_count);
  EXPECT_EQ(got.fingerprint, expected.fingerprint);
  EXPECT_EQ(got.name, "engine");
}

TEST(host_scene, strides_16_bit_indices_and_no_indices) {
  struct vertex {
    float normal[3], position[3], color, uv[2];
  };
  const std::vector<vertex> vertices = {
      {{9, 9, 9}, {0, 0, 0}, 7, {0, 0.5f}}, {{9, 9, 9}, {1, 0, 0}, 7, {1, 0}}, {{9, 9, 9}, {0, 1, 0}, 7, {0.25f, 1}}};
  const std::vector<std::uint16_t> indices = {2, 0, 1};
  engine e;
  host_mesh& m = e.meshes.emplace_back();
  m.positions = vertices[0].position;
  m.position_stride = sizeof(vertex);
  m.vertex_count = 3;
  m.uvs = vertices[0].uv;
  m.uv_stride = sizeof(vertex);
  m.indices = indices.data();
  m.index_count = 3;
  m.index_type = index_format::u16;
  const scene::scene s = scene_of(e.view());
  EXPECT_EQ(s.geometries[0].positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(s.geometries[0].uvs, (std::vector<glm::vec2>{{0, 0.5f}, {1, 0}, {0.25f, 1}}));
  EXPECT_EQ(s.geometries[0].indices, (std::vector<std::uint32_t>{2, 0, 1}));
  m.indices = nullptr;
  EXPECT_EQ(scene_of(e.view()).geometries[0].indices, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(host_scene, draws_carry_what_moves_and_what_the_host_knows) {
  const auto tags_of = [](const std::function<void(host_draw&)>& mark) {
    engine e;
    e.square();
    mark(e.draw(0));
    e.draw(0);
    const scene::scene s = scene_of(e.view());
    EXPECT_EQ(s.draws[1].tags, scene::draw_tags{}) << "a draw beside it";
    return s.draws[0].tags;
  };
  using tags = scene::draw_tags;
  EXPECT_EQ(tags_of([](host_draw&) {}), tags{});
  EXPECT_EQ(tags_of([](host_draw& d) { d.occluder = false; }), (tags{.occluder = false}));
  EXPECT_EQ(tags_of([](host_draw& d) { d.dynamic = true; }), (tags{.dynamic = true}));
  EXPECT_EQ(tags_of([](host_draw& d) { d.always = true; }), (tags{.always = true}));
  EXPECT_EQ(tags_of([](host_draw& d) { d.never = true; }), (tags{.never = true}));
  EXPECT_EQ(tags_of([](host_draw& d) { d.animated = true; }), (tags{.animated = true}));
  EXPECT_EQ(tags_of([](host_draw& d) { d.group = "door"; }), (tags{.group = 0}));
  // Another mark speaks for what moves; in every set it still hides nothing.
  EXPECT_EQ(tags_of([](host_draw& d) { d.animated = d.dynamic = true; }), (tags{.dynamic = true}));
  EXPECT_EQ(tags_of([](host_draw& d) { d.animated = d.always = true; }), (tags{.occluder = false, .always = true}));
}

TEST(host_scene, groups_are_numbered_by_first_use) {
  engine e;
  e.square();
  for (const char* name : {"", "wing", "door", "wing"}) e.draw(0).group = name;
  const scene::scene s = scene_of(e.view());
  EXPECT_EQ(s.groups, (std::vector<std::string>{"wing", "door"}));
  EXPECT_EQ(s.draws[0].tags.group, scene::no_index);
  EXPECT_EQ(s.draws[1].tags.group, 0u);
  EXPECT_EQ(s.draws[2].tags.group, 1u);
  EXPECT_EQ(s.draws[3].tags.group, 0u);
}

TEST(host_scene, draws_keep_place_tag_and_name) {
  engine e;
  const auto square = e.square();
  e.draw(square);
  host_draw& second = e.draw(square);
  second.to_world = {2, 0, 0, 9, 0, 3, 0, 9, 0, 0, 4, 9, 5, 6, 7, 9};  // the last row is not read
  second.tag = 0xFEDCBA9876543210u;
  second.name = "window";
  const scene::scene s = scene_of(e.view());
  ASSERT_EQ(s.draws.size(), 2u);
  EXPECT_EQ(s.draws[1].first_source, 2u);
  EXPECT_EQ(s.draws[1].host_tag, 0xFEDCBA9876543210u);
  EXPECT_EQ(s.node_names[s.draws[1].node], "window");
  EXPECT_EQ(s.draws[1].to_world[0][3], 0.0);
  EXPECT_EQ(s.draws[1].to_world[3][3], 1.0);
  EXPECT_EQ(scene::flatten(s).positions[6], glm::vec3(7, 9, 7)) << "the corner (1, 1, 0)";
}

TEST(host_scene, alpha_from_bytes_and_from_a_function) {
  const std::vector<std::uint8_t> rgba = {1, 2, 3, 10, 1, 2, 3, 20, 0, 0, 0, 0,  // a row and 4 bytes of padding
                                          1, 2, 3, 30, 1, 2, 3, 40};
  engine e;
  host_material& m = e.materials.emplace_back();
  m.alpha = scene::alpha_mode::mask;
  m.cutoff = 0.25f;
  m.constant_alpha = 0.75f;
  m.texture = {rgba.data() + 3, 2, 2, 4, 12};
  scene::scene s = scene_of(e.view());
  EXPECT_EQ(s.alpha_maps.at(0).texels, (std::vector<std::uint8_t>{10, 20, 30, 40}));
  EXPECT_EQ(s.materials[0].alpha_cutoff, 0.25f);
  EXPECT_EQ(s.materials[0].base_color.a, 0.75f);

  m.texture = {};
  m.function_width = 4;
  m.function_height = 2;
  std::size_t calls = 0;
  m.alpha_function = [&](float u, float v) {
    ++calls;
    if (v > 0.5f) return u < 0.5f ? std::numeric_limits<float>::quiet_NaN() : u < 0.75f ? -1.0f : 2.0f;
    return u;
  };
  s = scene_of(e.view());
  EXPECT_EQ(calls, 8u);
  EXPECT_EQ(s.alpha_maps.at(0).texels, (std::vector<std::uint8_t>{32, 96, 159, 223, 0, 0, 0, 255}));

  m.alpha = scene::alpha_mode::opaque;
  EXPECT_TRUE(scene_of(e.view()).alpha_maps.empty());
  EXPECT_EQ(calls, 8u) << "only masks ask";
}

TEST(host_scene, broken_arrays_are_refused_by_name) {
  const auto after = [](const std::function<void(engine&)>& change) {
    engine e;
    e.materials.emplace_back().alpha = scene::alpha_mode::mask;
    e.draw(e.square()).material = 0;
    EXPECT_EQ(refusal(e), "");
    change(e);
    return refusal(e);
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  static const std::uint8_t texel = 0;
  EXPECT_PRED2(has, after([](engine& e) { e.meshes[0].positions = nullptr; }),
               "mesh 0 has 4 vertices and no positions");
  EXPECT_PRED2(has, after([](engine& e) { e.meshes[0].position_stride = 8; }), "mesh 0 has a position stride of 8");
  EXPECT_PRED2(has, after([](engine& e) { e.meshes[0].position_stride = 14; }), "multiple of 4");
  EXPECT_PRED2(has, after([](engine& e) { e.meshes[0].position_stride = 14; }), "[host.bad-array]");
  EXPECT_PRED2(has, after([](engine& e) { e.meshes[0].index_count = 5; }), "5 indices");
  EXPECT_PRED2(has, after([](engine& e) { e.meshes[0].vertex_count = 3; }), "index 3");
  EXPECT_PRED2(has, after([](engine& e) { e.meshes[0].vertex_count = std::size_t{1} << 32; }), "2^32");
  EXPECT_PRED2(has, after([](engine& e) { e.draws[0].mesh = 1; }), "draw 0");
  EXPECT_PRED2(has, after([](engine& e) { e.draws[0].material = 7; }), "draw 0");
  EXPECT_PRED2(has, after([](engine& e) { e.draws[0].to_world[12] = std::nan(""); }), "draw 0 has a transform");
  EXPECT_PRED2(has, after([](engine& e) { e.materials[0].cutoff = std::nanf(""); }), "material 0");
  EXPECT_PRED2(has, after([](engine& e) { e.materials[0].texture = {&texel, 0, 1, 1, 0}; }), "0 x 1 texels");
  EXPECT_PRED2(has, after([](engine& e) { e.materials[0].texture = {&texel, 1, 20000, 1, 0}; }), "16384");
  EXPECT_PRED2(has, after([](engine& e) { e.materials[0].texture = {&texel, 4, 1, 1, 3}; }), "rows of 3 bytes");
  EXPECT_PRED2(has, after([](engine& e) {
                 e.materials[0].texture = {&texel, 1, 1, 1, 0};
                 e.materials[0].alpha_function = [](float, float) { return 1.0f; };
               }),
               "both");
  EXPECT_PRED2(has, after([](engine& e) {
                 e.materials[0].function_width = 0;
                 e.materials[0].alpha_function = [](float, float) { return 1.0f; };
               }),
               "0 x 256");
}

TEST(host_scene, has_no_colors_to_measure_by) {
  engine e;
  e.draw(e.square());
  settings how;
  how.metric.kind = metric_kind::color;
  verify_settings check;
  check.metric.kind = metric_kind::color;
  EXPECT_EQ(test::error_id([&] { (void)bake(e.view(), how, "none.pvs", true, {}); }), "host.no-colors");
  EXPECT_EQ(test::error_id([&] { (void)bake_shard(e.view(), how, "none.pvs", {}, true, {}); }), "host.no-colors");
  EXPECT_EQ(test::error_id([&] { (void)verify(e.view(), {}, "none.pvs", check, {}); }), "host.no-colors");
}

// A closed room with a fence across it and a sheet behind: bake, verify and the tags in the file.
class host_bake : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() / ("host_bake_" + std::to_string(std::random_device{}()) + ".pvs");
    const auto square = engine_.square();
    host_material& fence = engine_.materials.emplace_back();
    fence.name = "fence";
    fence.alpha = scene::alpha_mode::mask;
    fence.double_sided = true;
    // Six panels toward +z at z = -4, a sheet behind each at z = -6, and a wall behind all.
    for (std::uint32_t i = 0; i < 6; ++i) {
      host_draw& panel = engine_.draw(square);
      panel.material = 0;
      panel.to_world = at(-6.0 + 2.0 * i, -2, -4, 2, 4);
      panel.tag = 100 + i;
    }
    for (std::uint32_t i = 0; i < 6; ++i) {
      host_draw& sheet = engine_.draw(square);
      sheet.to_world = at(-5.9 + 2.0 * i, -0.1, -4.2, 1.8, 0.3);
      sheet.tag = 200 + i;
    }
    engine_.draw(square).to_world = at(-30, -30, -9, 60, 60);
    engine_.draws.back().tag = 300;
    const float uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};
    std::copy(std::begin(uvs), std::end(uvs), uvs_.begin());
    engine_.meshes[0].uvs = uvs_.data();
    how_.cells = {{"stand", {-1, -1, -1}, {1, 1, 1}}};
    how_.resolution = 128;
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    std::filesystem::remove(path_.string() + ".bake", ignored);
  }
  static std::array<double, 16> at(double x, double y, double z, double wide, double high) {
    return {wide, 0, 0, 0, 0, high, 0, 0, 0, 0, 1, 0, x, y, z, 1};
  }
  // The tags of draws of which anything is in the only cell's set.
  std::vector<std::uint64_t> seen_tags(const std::vector<std::byte>& bytes) {
    test::stored_file file(bytes);
    const std::vector<std::uint32_t> set = file.set(0);
    std::vector<std::uint64_t> tags;
    for (std::uint32_t i = 0; i < file.reader().draw_count(); ++i) {
      format::draw_record d;
      EXPECT_EQ(file.reader().draw(i, d), format::status::ok);
      const auto found = std::lower_bound(set.begin(), set.end(), d.first_source);
      if (found != set.end() && *found < d.first_source + d.polygon_count) tags.push_back(d.host_tag);
    }
    std::sort(tags.begin(), tags.end());
    return tags;
  }

  std::filesystem::path path_;
  engine engine_;
  std::array<float, 8> uvs_{};
  settings how_;
};

TEST_F(host_bake, a_fence_shows_what_is_behind_its_holes_and_tags_come_back) {
  // Bars: solid but for a slit in the middle third of the height; the sheets stand right behind the slit.
  engine_.materials[0].alpha_function = [](float, float v) { return v > 0.4f && v < 0.6f ? 0.0f : 1.0f; };
  std::vector<std::string> warnings, notes;
  callbacks events;
  events.on_message = [&](severity how_bad, const std::string& text) {
    (how_bad == severity::warning ? warnings : notes).push_back(text);
  };
  const summary sum = bake(engine_.view(), how_, path_, true, events);
  EXPECT_EQ(sum.result, outcome::done);
  EXPECT_EQ(sum.cells, 1u);
  EXPECT_TRUE(warnings.empty());
  EXPECT_NE(std::find(notes.begin(), notes.end(), "cells: 1 cells given"), notes.end());
  const std::vector<std::byte> bytes = test::file_bytes(path_);
  EXPECT_EQ(seen_tags(bytes),
            (std::vector<std::uint64_t>{100, 101, 102, 103, 104, 105, 200, 201, 202, 203, 204, 205, 300}));
  const verification checked = verify(engine_.view(), bytes, "host.pvs", {.rays = 50'000}, nullptr);
  EXPECT_EQ(checked.rays, 50'000u);
  EXPECT_LE(checked.upper_bound, 1e-3);
}

TEST_F(host_bake, a_fence_without_holes_hides_it) {
  engine_.materials[0].alpha_function = [](float, float) { return 1.0f; };
  (void)bake(engine_.view(), how_, path_, true, {});
  EXPECT_EQ(seen_tags(test::file_bytes(path_)), (std::vector<std::uint64_t>{100, 101, 102, 103, 104, 105, 300}));
}

TEST_F(host_bake, another_alpha_is_another_scene) {
  engine_.materials[0].alpha_function = [](float u, float) { return u; };
  (void)bake(engine_.view(), how_, path_, true, {});
  engine_.materials[0].alpha_function = [](float, float v) { return v; };
  try {
    (void)verify(engine_.view(), test::file_bytes(path_), "host.pvs", {}, nullptr);
    FAIL() << "another scene was taken";
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "pvs.other-scene");
  }
}

TEST_F(host_bake, can_be_cancelled_before_the_first_cell) {
  callbacks events;
  std::uint32_t calls = 0;
  events.on_progress = [&](const progress& now) {
    ++calls;
    EXPECT_EQ(now.cells_done, 0u);
    EXPECT_EQ(now.cells_total, 1u);
    return false;
  };
  EXPECT_EQ(bake(engine_.view(), how_, path_, true, events).result, outcome::cancelled);
  EXPECT_EQ(calls, 1u);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(host_bake, cells_that_are_no_boxes_are_refused) {
  how_.cells[0].max[1] = -1;
  try {
    (void)bake(engine_.view(), how_, path_, true, {});
    FAIL() << "a box without volume was taken";
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "cells.empty-box");
    EXPECT_NE(std::string(e.what()).find("cell 0 \"stand\""), std::string::npos) << e.what();
  }
  how_.cells[0].max[1] = std::nanf("");
  EXPECT_THROW((void)bake(engine_.view(), how_, path_, true, {}), error);
  how_.cells[0].max[1] = 1;
  how_.cells_grid = {-1.0f, -1.0f, -1.0f, 1.0f, 1.0f, 1.0f};
  EXPECT_THROW((void)bake(engine_.view(), how_, path_, true, {}), error);
}

}  // namespace
}  // namespace sightcell::bake
