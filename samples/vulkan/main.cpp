// A Vulkan engine with Sightcell: the same frames with frustum culling alone and with the PVS, as commands of the
// runtime and as clusters of the host. See README.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "device.h"
#include "host_scene.h"
#include "measure.h"
#include "renderer.h"
#include "screenshot.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"
#include "visibility.h"
#include "walk.h"

namespace vulkan_host {
namespace {

struct arguments {
  std::string scene_file, pvs_file, screenshot, mode = "clusters";
  std::uint32_t cells = 16, headings = 4, width = 640, height = 480, view = 0, frames = 0, min_gap = 0, leave_out = 0;
  double most_wrong = 1e-4;
  bool is_json = false, has_window = false, validates = false, no_draw_count = false;
};

sightcell::db open_file(const std::string& file) {
  auto db = sightcell::db::open_file(file.c_str());
  if (db) return std::move(*db);
  throw sightcell::error(sightcell::error_kind::bad_input, "vulkan.runtime", file, db.text(), "bake the scene again");
}

draw_mode mode_of(const std::string& name) {
  const auto found = std::find(mode_names.begin(), mode_names.end(), name);
  return static_cast<draw_mode>(found - mode_names.begin());
}

void print_json(const device& on, const host_scene& host, const sightcell::db& db, const std::vector<result>& results) {
  nlohmann::ordered_json out{{"device", on.name()},
                             {"draw_count", on.counts()},
                             {"polygons", db.polygon_count()},
                             {"draws", host.sorted_draws.size()},
                             {"clusters", host.clusters.size()},
                             {"textures", host.textures.size()},
                             {"pipelines", host.bins.size()},
                             {"cells", db.cell_count()}};
  for (const result& r : results) {
    const auto frames = static_cast<double>(r.sums.frames);
    out["modes"][mode_names[static_cast<std::size_t>(r.mode)]] = {
        {"frames", r.sums.frames},
        {"draws", static_cast<double>(r.sums.draws) / frames},
        {"triangles", static_cast<double>(r.sums.triangles) / frames},
        {"host_ms", r.sums.host_milliseconds / frames},
        {"cpu_ms", r.cpu_milliseconds / frames},
        {"wrong_pixels", r.wrong},
        {"wrong_share", r.wrong_share()},
        {"ties", r.ties}};
  }
  fmt::print("{}\n", out.dump(2));
}

void print_table(const device& on, const host_scene& host, const sightcell::db& db, const std::string& scene,
                 const std::vector<result>& results) {
  fmt::print("{}: {} polygons, {} draws, {} clusters, {} pipelines, {} cells; {}{}\n", scene, db.polygon_count(),
             host.sorted_draws.size(), host.clusters.size(), host.bins.size(), db.cell_count(), on.name(),
             on.counts() ? "" : ", without drawIndirectCount");
  fmt::print("{:<12}{:>8}{:>10}{:>12}{:>10}{:>10}{:>12}{:>10}{:>8}\n", "mode", "frames", "draws", "triangles",
             "host ms", "CPU ms", "wrong", "of all", "ties");
  for (const result& r : results) {
    const auto frames = static_cast<double>(r.sums.frames);
    fmt::print("{:<12}{:>8}{:>10.1f}{:>12.1f}{:>10.3f}{:>10.2f}{:>12}{:>10.1e}{:>8}\n",
               mode_names[static_cast<std::size_t>(r.mode)], r.sums.frames, static_cast<double>(r.sums.draws) / frames,
               static_cast<double>(r.sums.triangles) / frames, r.sums.host_milliseconds / frames,
               r.cpu_milliseconds / frames, r.wrong, r.wrong_share(), r.ties);
  }
}

// Without a window. Returns whether all modes show what drawing everything shows.
bool run_headless(const sightcell::scene::scene& s, const sightcell::db& db, const host_scene& host,
                  visibility& visible, const arguments& args) {
  const instance vulkan({}, args.validates);
  bool is_fine = true;
  {
    const device on(vulkan, VK_NULL_HANDLE, !args.no_draw_count);
    renderer draws(on, s, host, visible, {args.width, args.height});
    const std::vector<camera> views = find_views(db, args.pvs_file, args.cells, args.headings,
                                                 static_cast<float>(args.width) / static_cast<float>(args.height));
    if (!args.screenshot.empty()) {
      draws.submit(draws.draw(views[args.view % views.size()], mode_of(args.mode)));
      draws.finish();
      write_screenshot(args.screenshot, draws.picture_target().read_back(on));
    }
    const std::vector<result> results = measure(on, draws, views);
    if (args.is_json) {
      print_json(on, host, db, results);
    } else {
      print_table(on, host, db, s.name, results);
    }
    is_fine = std::all_of(results.begin(), results.end(),
                          [&](const result& r) { return r.wrong_share() <= args.most_wrong; });
  }
  return is_fine && vulkan.validation_messages() == 0;
}

bool run(const arguments& args) {
  const sightcell::scene::scene s = sightcell::scene::load_gltf(args.scene_file);
  const sightcell::db db = open_file(args.pvs_file);
  const host_scene host = arrange(s, db, args.pvs_file);
  visibility visible(db, args.pvs_file, host.cluster_of_source, static_cast<std::uint32_t>(host.clusters.size()),
                     args.min_gap);
  visible.leave_out(args.leave_out);
  if (!args.has_window) return run_headless(s, db, host, visible, args);
  return walk(s, db, args.pvs_file, host, visible,
              {.width = args.width,
               .height = args.height,
               .frames = args.frames,
               .validates = args.validates,
               .may_count = !args.no_draw_count,
               .screenshot = args.screenshot}) == 0;
}

void add_options(CLI::App& app, arguments& args) {
  const auto positive = CLI::Range(1, 100000);
  app.add_option("scene", args.scene_file, "the scene, .glb or .gltf")->required();
  app.add_option("pvs", args.pvs_file, "the file baked from it")->required();
  app.add_flag("--window", args.has_window,
               "walk: W A S D, E and Q up and down, Shift faster, mouse, 1-4 modes, Tab another cell, Esc ends");
  app.add_option("--frames", args.frames, "with --window: end after this many frames");
  app.add_option("--cells", args.cells, "cells to draw from")->check(positive)->capture_default_str();
  app.add_option("--headings", args.headings, "directions in each")->check(positive)->capture_default_str();
  app.add_option("--width", args.width, "pixels")->check(CLI::Range(16, 8192))->capture_default_str();
  app.add_option("--height", args.height, "pixels")->check(CLI::Range(16, 8192))->capture_default_str();
  app.add_option("--min-gap", args.min_gap, "commands draw gaps of fewer polygons")->capture_default_str();
  app.add_option("--screenshot", args.screenshot, "write a view (with --window: the last frame) as PNG");
  app.add_option("--view", args.view, "which view: cell * headings + heading")->capture_default_str();
  app.add_option("--mode", args.mode, "of the screenshot")
      ->check(CLI::IsMember(std::vector<std::string>(mode_names.begin(), mode_names.end())))
      ->capture_default_str();
  app.add_option("--max-wrong", args.most_wrong, "share of wrong pixels of a mode, above which the exit code is 1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_flag("--json", args.is_json, "print one JSON object");
  app.add_flag("--validate", args.validates, "with the validation layer; its messages make the exit code 1");
  app.add_flag("--no-draw-count", args.no_draw_count, "as on a device without drawIndirectCount");
  app.add_option("--leave-out", args.leave_out, "a fault: leave out each n-th visible cluster");
}

}  // namespace
}  // namespace vulkan_host

int main(int argc, char** argv) {
  vulkan_host::arguments args;
  CLI::App app{"Draws a baked scene with Vulkan: by frustum, by indirect commands and by clusters of its set"};
  vulkan_host::add_options(app, args);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    return vulkan_host::run(args) ? 0 : 1;
  } catch (const sightcell::error& e) {
    fmt::print(stderr, "{}\n", e.what());
    return e.kind() == sightcell::error_kind::bad_input ? 4 : 1;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
