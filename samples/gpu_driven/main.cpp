// A GPU-driven OpenGL renderer with Sightcell: clusters culled by compute shaders, by the PVS, by hierarchical depth,
// and by both. See README.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_scene.h"
#include "level_table.h"
#include "measurement.h"
#include "report.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/picture/picture.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"
#include "tour.h"

namespace gpu_driven {
namespace {

using sightcell::error;
using sightcell::error_kind;

struct arguments {
  std::string scene_file, pvs_file, device = "any", screenshot, mode = "pvs_two_pass";
  std::uint32_t cuts = 1000, frames = 2000, view = 0, leave_out = 0;
  std::uint64_t seed = 1;
  int width = 1280, height = 720;
  double most_wrong = 1e-4;
  std::optional<float> levels;
  bool is_json = false, no_draw_count = false;
};

sightcell::db open_file(const std::string& file, const sightcell::scene::scene& s) {
  auto db = sightcell::db::open_file(file.c_str());
  if (!db) throw error(error_kind::bad_input, "gpu-driven.runtime", file, db.text(), "bake the scene again");
  if (db->polygon_count() != s.polygon_count || db->same_scene(s.fingerprint) != SIGHTCELL_OK) {
    throw error(error_kind::bad_input, "gpu-driven.other-scene", file, "was baked from another scene than " + s.name,
                "name the scene and the file of one bake");
  }
  return std::move(*db);
}

std::unique_ptr<sightcell::picture::gl_context> make_context(const std::string& device) {
  if (device == "any") return std::make_unique<sightcell::picture::gl_context>();
  auto made = sightcell::picture::gl_context::on_hardware();
  if (made) return made;
  throw error(error_kind::failed, "gpu-driven.no-gpu", "OpenGL", "no device of EGL is hardware with OpenGL 4.5",
              "leave out --device");
}

draw_mode mode_of(const std::string& name) {
  return static_cast<draw_mode>(std::find(mode_names.begin(), mode_names.end(), name) - mode_names.begin());
}

void write_screenshot(const std::string& file, const renderer& draws, draw_mode mode) {
  const int width = draws.size().width, height = draws.size().height;
  sightcell::picture::image_rgba out{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  const std::size_t row = 4 * static_cast<std::size_t>(width);
  out.pixels.resize(row * static_cast<std::size_t>(height));
  glGetTextureImage(draws.picture(mode).color.id(), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                    static_cast<GLsizei>(out.pixels.size()), out.pixels.data());
  for (std::size_t low = 0, high = static_cast<std::size_t>(height) - 1; low < high; ++low, --high) {
    const auto at = [&](std::size_t r) { return out.pixels.begin() + static_cast<std::ptrdiff_t>(r * row); };
    std::swap_ranges(at(low), at(low + 1), at(high));  // OpenGL's first row is the lowest
  }
  for (std::size_t i = 3; i < out.pixels.size(); i += 4) out.pixels[i] = 255;  // else the sum of blended alphas
  sightcell::picture::write_png(file, out);
}

// Returns whether all modes but `last_frame`, which misses what comes into view, show what drawing everything shows.
bool is_right(const section& own, const renderer& draws, double most_wrong) {
  const double pixels = static_cast<double>(draws.size().width) * draws.size().height * static_cast<double>(own.frames);
  for (const draw_mode mode : {draw_mode::frustum, draw_mode::pvs, draw_mode::two_pass, draw_mode::pvs_two_pass}) {
    const auto wrong = static_cast<double>(own.modes[static_cast<std::size_t>(mode)].wrong_pixels);
    if (wrong > most_wrong * pixels) return false;
  }
  return true;
}

// Returns whether the pictures are right.
bool run(const arguments& args) {
  const sightcell::scene::scene s = sightcell::scene::load_gltf(args.scene_file);
  const sightcell::db db = open_file(args.pvs_file, s);
  const host_scene host = arrange(s, args.levels ? read_levels(args.scene_file) : level_table{});
  const auto context = make_context(args.device);
  measurement measured(db, args.pvs_file, s, host,
                       {.width = args.width,
                        .height = args.height,
                        .may_count = !args.no_draw_count,
                        .most_pixels = args.levels.value_or(0.0f)},
                       args.leave_out);
  context->check("setup");
  const std::vector<tour_frame> cuts = make_cuts(db, args.pvs_file, std::max(args.cuts, args.view + 1), args.seed);
  if (!args.screenshot.empty()) {
    if (!measured.draws().draws(mode_of(args.mode))) {
      throw error(error_kind::bad_input, "gpu-driven.no-levels", "--mode", "leaves is a mode of --levels alone",
                  "add --levels PIXELS");
    }
    measured.draw(cuts[3 * std::size_t{args.view}].view, mode_of(args.mode));
    write_screenshot(args.screenshot, measured.draws(), mode_of(args.mode));
  }
  sections all;
  run_facts facts{s.name, context->renderer(), context->software(), args.seed, 0};
  measured.run(std::span(cuts).first(3 * std::size_t{args.cuts}), all);
  if (args.frames > 0) {
    const sightcell::scene::world_geometry world = sightcell::scene::flatten(s);
    measured.run(make_walk(db, args.pvs_file, world, args.frames, args.seed, facts.jumps), all);
  }
  context->check("frames");
  (args.is_json ? print_json : print_table)(facts, host, db, measured.draws(), all);
  const auto fine = [&](const section& own) { return is_right(own, measured.draws(), args.most_wrong); };
  return fine(all.cuts) && fine(all.settled) && fine(all.walk);
}

void add_options(CLI::App& app, arguments& args) {
  app.add_option("scene", args.scene_file, "the scene, .glb or .gltf")->required();
  app.add_option("pvs", args.pvs_file, "the file baked from it")->required();
  app.add_option("--cuts", args.cuts, "camera cuts: random valid viewpoints and directions")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  app.add_option("--frames", args.frames, "frames of the walk")->check(CLI::Range(0, 1000000))->capture_default_str();
  app.add_option("--seed", args.seed, "of both")->capture_default_str();
  app.add_option("--width", args.width, "pixels")->check(CLI::Range(16, 8192))->capture_default_str();
  app.add_option("--height", args.height, "pixels")->check(CLI::Range(16, 8192))->capture_default_str();
  app.add_option("--levels", args.levels,
                 "draw the levels of detail of a file of pack --meshlets --levels: the cut with this error in pixels")
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--device", args.device, "any: a GPU if there is one, else OpenGL in software; gpu: no other")
      ->check(CLI::IsMember({"any", "gpu"}))
      ->capture_default_str();
  app.add_option("--screenshot", args.screenshot, "write the view of a cut as PNG");
  app.add_option("--view", args.view, "which cut")->check(CLI::Range(0, 1000000))->capture_default_str();
  app.add_option("--mode", args.mode, "of the screenshot")
      ->check(CLI::IsMember(std::vector<std::string>(mode_names.begin(), mode_names.end())))
      ->capture_default_str();
  app.add_option("--max-wrong", args.most_wrong,
                 "share of wrong pixels of a mode other than last_frame, above which the exit code is 1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_flag("--json", args.is_json, "print one JSON object");
  app.add_flag("--no-draw-count", args.no_draw_count, "as on a device without ARB_indirect_parameters");
  app.add_option("--leave-out", args.leave_out, "a fault: leave out each n-th cluster of the PVS");
}

}  // namespace
}  // namespace gpu_driven

int main(int argc, char** argv) {
  gpu_driven::arguments args;
  CLI::App app{"Draws a baked scene with culling on the GPU: by the PVS, by hierarchical depth, and by both"};
  gpu_driven::add_options(app, args);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    return gpu_driven::run(args) ? 0 : 1;
  } catch (const sightcell::error& e) {
    fmt::print(stderr, "{}\n", e.what());
    return e.kind() == sightcell::error_kind::bad_input ? 4 : 1;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
