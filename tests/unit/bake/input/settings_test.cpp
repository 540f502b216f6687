#include "sightcell/bake/settings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "errors/error_id.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

std::string error_of(const std::function<void(settings&)>& change) {
  settings s;
  change(s);
  try {
    validate(s);
  } catch (const error& e) {
    EXPECT_EQ(e.kind(), error_kind::wrong_use);
    return e.what();
  }
  return "";
}

TEST(settings, defaults_are_in_range) {
  EXPECT_NO_THROW(validate({}));
}

TEST(settings, errors_name_the_option) {
  const auto expect = [](const char* option, const std::function<void(settings&)>& change) {
    EXPECT_EQ(error_of(change).find(option), 0u) << option << ": " << error_of(change);
  };
  expect("--cell-size", [](settings& s) { s.cell_size = 0.2f; });
  expect("--cell-size", [](settings& s) { s.cell_size = 1001.0f; });
  expect("--cell-size", [](settings& s) { s.cell_size = NAN; });
  expect("--margin", [](settings& s) { s.margin = -0.1f; });
  expect("--margin", [](settings& s) { s.margin = 10.1f; });
  expect("--player-radius", [](settings& s) { s.player_radius = 0.0f; });
  expect("--player-radius", [](settings& s) { s.player_radius = INFINITY; });
  expect("--smallest-gap", [](settings& s) { s.smallest_gap = -0.001f; });
  expect("--smallest-gap", [](settings& s) { s.smallest_gap = 0.2f; });
  expect("--sampler", [](settings& s) { s.sampler = "guesswork"; });
  expect("--source", [](settings& s) { s.source = "opengl"; });
  expect("--source", [](settings& s) { s.source = ""; });
  expect("--samples", [](settings& s) { s.samples = 5; });
  expect("--samples", [](settings& s) { s.samples = 100001; });
  expect("--seconds-per-cell", [](settings& s) { s.seconds_per_cell = NAN; });
  expect("--interior-share", [](settings& s) { s.interior_share = 1.0; });
  expect("--reliability", [](settings& s) { s.reliability = 0.0; });
  expect("--difference", [](settings& s) { s.difference = -0.1; });
  expect("--resolution", [](settings& s) { s.resolution = 255; });
  expect("--resolution", [](settings& s) { s.resolution = 8; });
  expect("--resolution", [](settings& s) { s.resolution = 8192; });
  expect("--max-pixel-error", [](settings& s) { s.max_pixel_error = 1e-8; });
  expect("--max-pixel-error", [](settings& s) { s.max_pixel_error = 0.6; });
  expect("--max-pixel-error", [](settings& s) { s.max_pixel_error = -1e-3; });
  expect("--max-pixel-error", [](settings& s) { s.max_pixel_error = NAN; });
  expect("--metric", [](settings& s) { s.metric.kind = static_cast<metric_kind>(3); });
  expect("--view-resolution", [](settings& s) { s.metric.view_width = 15; });
  expect("--view-resolution", [](settings& s) { s.metric.view_height = 65537; });
  expect("--view-fov", [](settings& s) { s.metric.view_fov = 0.5; });
  expect("--view-fov", [](settings& s) { s.metric.view_fov = NAN; });
  expect("--view-pitch", [](settings& s) { s.metric.view_pitch = {-91.0, 0.0}; });
  expect("--view-pitch", [](settings& s) { s.metric.view_pitch = {0.0, NAN}; });
  expect("--view-pitch", [](settings& s) { s.metric.view_pitch = {10.0, 5.0}; });
  expect("--view-least", [](settings& s) { s.metric.view_least = -0.1; });
  expect("--animated", [](settings& s) { s.animated = static_cast<scene::animated_as>(3); });
  expect("--safety-ring", [](settings& s) { s.safety_ring = static_cast<safety_ring>(3); });
  expect("--layout", [](settings& s) { s.file.layout = static_cast<host_layout>(2); });
  expect("--order", [](settings& s) { s.file = {{}, polygon_order_kind::per_instance, host_layout::merged}; });
  expect("--cells-grid", [](settings& s) { s.cells_grid = {{0, 0, 0, 1, 0, 1}}; });
  expect("--cells-grid", [](settings& s) { s.cells_grid = {{0, 0, 0, 1, NAN, 1}}; });
  expect("--cells-grid", [](settings& s) {
    s.cells_grid = {{0, 0, 0, 1, 1, 1}};
    s.cells_file = "cells.json";
  });
  expect("--fly", [](settings& s) { s.fly = {{0, 0, 0, 1, 1, 1}, {0, 0, 0, 1, 1, 0}}; });
  expect("--fly", [](settings& s) { s.fly = {{0, 0, 0, 1, NAN, 1}}; });
  expect("--fly", [](settings& s) {
    s.fly = {{0, 0, 0, 1, 1, 1}};
    s.cells_file = "cells.json";
  });
  expect("--path", [](settings& s) {
    s.path_file = "path.json";
    s.cells_grid = {{0, 0, 0, 1, 1, 1}};
  });
  expect("--path-radius", [](settings& s) { s.path_radius = 101.0f; });
  expect("--path", [](settings& s) { s.paths = {{}}; });
  expect("--path", [](settings& s) { s.paths = {{{0, NAN, 0}}}; });
  expect("--reach", [](settings& s) { s.reach = reach_kind::none; });
  expect("--reach", [](settings& s) { s.reach = static_cast<reach_kind>(3); });
}

TEST(sampler_options, every_sampler_is_known_and_every_option_is_somebodys) {
  for (const sampler_option& option : sampler_options()) {
    EXPECT_FALSE(option.samplers.empty()) << option.name;
    for (const std::string_view name : option.samplers) {
      settings s;
      s.sampler = name;
      EXPECT_NO_THROW(validate(s)) << option.name << " is one of " << name;
      EXPECT_TRUE(option.of(name));
    }
    EXPECT_FALSE(option.of("nobody"));
  }
  for (const sampler_info& one : samplers()) {
    const auto all = sampler_options();
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const sampler_option& o) { return o.of(one.name); }));
  }
}

TEST(sampler_options, what_is_not_the_default_stands_in_the_text_of_who_has_it) {
  settings s;
  const std::string before = describe(s);
  s.difference = 0.25;
  EXPECT_EQ(describe(s), before) << "importance-depth has none";
  s.sampler = "nir04";
  EXPECT_NE(describe(s).find(R"("difference":0.25)"), std::string::npos);
  s.jitter = true;
  EXPECT_NE(describe(s).find(R"("jitter":true)"), std::string::npos);
}

TEST(settings, a_time_budget_needs_a_bound_and_a_search_that_goes_on) {
  const auto id_of = [](const std::function<void(settings&)>& change) {
    settings s;
    s.time_budget = 60.0;
    change(s);
    return test::error_id([&] { validate(s); });
  };
  EXPECT_EQ(id_of([](settings&) {}), "");
  EXPECT_EQ(id_of([](settings& s) { s.sampler = "halton"; }), "settings.time-budget");
  EXPECT_EQ(id_of([](settings& s) { s.max_pixel_error = 0.0; }), "settings.time-budget");
  EXPECT_EQ(id_of([](settings& s) { s.seconds_per_cell = 1.0; }), "settings.time-budget");
  EXPECT_EQ(id_of([](settings& s) { s.time_budget = -1.0; }), "settings.out-of-range");
  EXPECT_EQ(id_of([](settings& s) { s.time_budget = NAN; }), "settings.out-of-range");
}

TEST(settings, one_kind_of_cells_is_enough) {
  settings s;
  s.cells.push_back({"", {0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(test::error_id([&] { validate(s); }), "");
  s.cells_file = "cells.json";
  EXPECT_EQ(test::error_id([&] { validate(s); }), "settings.two-kinds-of-cells");
}

TEST(settings, ends_of_the_ranges_are_inside) {
  settings s;
  s.cell_size = 0.25f;
  s.margin = 0.0f;
  s.player_radius = 1.0f;
  s.sampler = "halton";
  s.samples = 6;
  s.resolution = 4096;
  s.max_pixel_error = 0.0;
  s.cells_grid = {{-1, -1, -1, 1, 1, 1}};
  EXPECT_NO_THROW(validate(s));
  s.max_pixel_error = 1e-7;
  EXPECT_NO_THROW(validate(s));
}

TEST(settings, description_is_one_line_of_json_in_fixed_order) {
  EXPECT_EQ(describe({}),
            R"({"cells":"automatic","cell_size":4,"cell_limit":0,"margin":0.25,"player_radius":0.05,"merge_cells":0.1,)"
            R"("sampler":"guided","samples":24,"resolution":512,"max_pixel_error":0.0001,"seed":1,)"
            R"("all_double_sided":false,"smallest_gap":0.002,"profile":"balanced"})");
}

TEST(settings, the_default_is_the_normal_quality) {
  EXPECT_EQ(settings().max_pixel_error, max_pixel_error_of_quality[static_cast<std::size_t>(quality::normal)]);
  EXPECT_EQ(kind_of<quality>(quality_names, "final"), quality::final);
}

TEST(settings, where_a_camera_flies_stands_in_the_description) {
  settings s;
  s.path_radius = 2.0f;
  EXPECT_EQ(describe(s), describe({})) << "without a path";
  s.reach = reach_kind::none;
  s.fly = {{0, 0, 0, 1, 1, 1}, {-1.5f, 0, 0, 1, 2, 1}};
  s.path_file = "path.json";
  EXPECT_NO_THROW(validate(s));
  EXPECT_NE(describe(s).find(R"(,"reach":"none","fly":[[0,0,0,1,1,1],[-1.5,0,0,1,2,1]],"path_radius":2,)"),
            std::string::npos)
      << describe(s);
}

TEST(settings, a_metric_other_than_pixel_stands_in_the_description) {
  settings s;
  const std::string before = describe(s);
  s.metric.view_fov = 90.0;
  EXPECT_EQ(describe(s), before) << "of view alone";
  s.metric.kind = metric_kind::color;
  EXPECT_NE(describe(s).find(R"(,"metric":"color",)"), std::string::npos) << describe(s);
  s.metric = {.kind = metric_kind::view, .view_width = 640, .view_pitch = {-20.0, 12.5}};
  EXPECT_NE(describe(s).find(R"(,"metric":"view","view_resolution":[640,1080],"view_fov":60,"view_pitch":[-20,12.5],)"
                             R"("view_least":0.25,)"),
            std::string::npos)
      << describe(s);
}

TEST(settings, description_tells_settings_apart_and_leaves_out_what_changes_no_byte) {
  settings a, b;
  b.threads = 7;
  b.source = "cpu";
  EXPECT_EQ(describe(a), describe(b));
  b.margin = std::nextafter(0.25f, 1.0f);
  EXPECT_NE(describe(a), describe(b));
  b = a;
  b.animated = scene::animated_as::rest;
  EXPECT_NE(describe(b).find(R"("animated":"rest")"), std::string::npos);
  b.animated = scene::animated_as::dynamic;
  EXPECT_NE(describe(b).find(R"("animated":"dynamic")"), std::string::npos);
  b = a;
  b.safety_ring = safety_ring::edge;
  EXPECT_NE(describe(b).find(R"("safety_ring":"edge")"), std::string::npos);
  b = a;
  b.file = {slack_profile::small, polygon_order_kind::per_instance};
  EXPECT_NE(describe(b).find(R"("profile":"small","order":"per-instance")"), std::string::npos);
  EXPECT_EQ(file_settings_of(describe(b)).profile, slack_profile::small);
  EXPECT_EQ(file_settings_of(describe(b)).order, polygon_order_kind::per_instance);
  EXPECT_EQ(file_settings_of(describe(a)).profile, slack_profile::balanced);
  EXPECT_EQ(file_settings_of("{}").profile, slack_profile::exact) << "from before there was slack";
  EXPECT_EQ(file_settings_of("no JSON").order, polygon_order_kind::per_mesh);
  EXPECT_EQ(file_settings_of(describe(a)).layout, host_layout::instanced);
  EXPECT_EQ(describe(a).find("layout"), std::string::npos);
  b = a;
  b.file.layout = host_layout::merged;
  EXPECT_NE(describe(b).find(R"("layout":"merged")"), std::string::npos);
  EXPECT_EQ(file_settings_of(describe(b)).layout, host_layout::merged);
  b = a;
  b.time_budget = 90.0;
  EXPECT_NE(describe(b).find(R"("time_budget":90)"), std::string::npos);
  a.cells_file = "here/cells.json";
  b = a;
  b.cells_file = "there/cells.json";
  EXPECT_EQ(describe(a), describe(b));
  a = {};
  a.cells_grid = {{0, 0, 0, 1.5f, 1, 1}};
  EXPECT_NE(describe(a).find(R"("cells":"grid","cells_grid":[0,0,0,1.5,1,1])"), std::string::npos);
}

}  // namespace
}  // namespace sightcell::bake
