// sightcell-viewer: see README.md beside this file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "sightcell/base/error.h"
#include "viewer.h"

namespace {

using sightcell::error;
using sightcell::error_kind;

std::string keys_text() {
  return "Keys are listed in the window. Exit codes: 0 done, 1 failed, 2 wrong use, 4 bad input.";
}

const CLI::Validator finite(
    [](const std::string& text) {
      float number = 0.0f;
      const bool good = CLI::detail::lexical_cast(text, number) && std::isfinite(number);
      return good ? std::string() : text + " is not a finite number";
    },
    "NUMBER");

// A line of the command line that is taken apart after parsing.
struct words {
  std::vector<float> eye, look;
  std::string size, show;
  float fov = 0.0f, brightness = 0.0f;
};

void add_options(CLI::App& app, viewer::options& chosen, words& rest) {
  const std::map<std::string, viewer::draw_mode> modes{
      {"pvs", viewer::draw_mode::pvs}, {"all", viewer::draw_mode::all}, {"tint", viewer::draw_mode::tint}};
  app.add_option("scene", chosen.scene_file, "the scene, .glb or .gltf")->required();
  app.add_option("pvs", chosen.pvs_file, "the file baked from it; without: the scene alone");
  app.add_option("--scene", chosen.scene, "which scene of the file; without: its default")
      ->check(CLI::Range(0, INT32_MAX));
  app.add_option("--cells-file", chosen.cells_file, "the cells file of the bake: gives cells their names");
  app.add_option("--size", rest.size, "of the window, WxH in pixels")->default_str("1280x800");
  app.add_option("--cell", chosen.cell, "start in this cell, at a valid viewpoint");
  app.add_option("--eye", rest.eye, "start here, x,y,z in meters")->delimiter(',')->expected(3)->check(finite);
  app.add_option("--look", rest.look, "yaw,pitch in degrees; yaw 0 looks along -Z and grows to the right")
      ->delimiter(',')
      ->expected(2)
      ->check(finite);
  app.add_option("--fov", rest.fov, "vertical field of view in degrees")->check(CLI::Range(5.0f, 150.0f));
  app.add_option("--brightness", rest.brightness, "of the light; without: 1, or more where a window would be dark")
      ->check(CLI::Range(0.1f, 10.0f));
  app.add_flag("--walk", chosen.walk, "begin on foot: G changes between walking and flying");
  app.add_flag("--objects", chosen.objects, "draw all of each object of which a polygon is in the set");
  app.add_flag("--frustum", chosen.frustum, "leave out what is not in view of the camera");
  app.add_option("--mode", chosen.mode, "pvs, all, or tint: what the set leaves out is red")
      ->transform(CLI::CheckedTransformer(modes));
  app.add_option("--frozen-from", chosen.frozen_from, "draw the set of this cell, wherever the camera is");
  auto* screenshot = app.add_option("--screenshot", chosen.screenshot,
                                    "write this .png without showing a window, print one line of JSON, end");
  app.add_option("--frames", chosen.frames, "draw so many before the screenshot")
      ->check(CLI::Range(1, 100000))
      ->needs(screenshot);
  app.add_option("--show", rest.show, "in the screenshot: words of hud,map,box,cells,wireframe,wrong")
      ->needs(screenshot);
  app.add_option("--bake", chosen.bake,
                 "without a .pvs file: bakes one beside the scene, draft, normal or final, in the background")
      ->check(CLI::IsMember({"draft", "normal", "final"}))
      ->excludes(screenshot)
      ->excludes(app.get_option("pvs"));
  app.add_option("--camera-file", chosen.camera_file,
                 "write where the camera is into this .json file, for sightcell bake --watch --near")
      ->excludes(screenshot);
  app.add_option("--record", chosen.record, "write the path of the camera into this file")->excludes(screenshot);
  auto* replay =
      app.add_option("--replay", chosen.replay, "follow the path of a file that --record wrote")->excludes(screenshot);
  auto* benchmark = app.add_option("--benchmark", chosen.benchmark,
                                   "draw each pose of --replay with the set and with everything, write numbers into "
                                   "this .csv, end")
                        ->needs(replay)
                        ->excludes("--bake");
  app.add_option("--poses", chosen.poses, "of the benchmark: so many, spread over the path; without: all")
      ->check(CLI::Range(1, 1000000))
      ->needs(benchmark);
}

[[noreturn]] void refuse(const std::string& subject, const std::string& cause, const std::string& remedy) {
  throw error(error_kind::wrong_use, "viewer.wrong-use", subject, cause, remedy);
}

void take_apart(const words& rest, viewer::options& chosen) {
  if (rest.eye.size() == 3) chosen.eye = {rest.eye[0], rest.eye[1], rest.eye[2]};
  if (rest.look.size() == 2) chosen.look = {rest.look[0], rest.look[1]};
  if (rest.fov > 0.0f) chosen.fov = rest.fov;
  if (rest.brightness > 0.0f) chosen.brightness = rest.brightness;
  if (!rest.size.empty()) {
    unsigned width = 0, height = 0;
    char end = 0;
    if (std::sscanf(rest.size.c_str(), "%5ux%5u%c", &width, &height, &end) != 2 || width < 16 || height < 16 ||
        width > 8192 || height > 8192) {
      refuse("--size " + rest.size, "is no size", "say it as 1280x800, 16 to 8192 each");
    }
    chosen.width = width;
    chosen.height = height;
  }
  for (const std::string& word : CLI::detail::split(rest.show, ',')) {
    if (word == "hud") {
      chosen.hud = true;
    } else if (word == "map") {
      chosen.map = true;
    } else if (word == "wrong") {
      chosen.wrong = true;
    } else if (word == "box") {
      chosen.box = true;
    } else if (word == "cells") {
      chosen.all_cells = true;
    } else if (word == "wireframe") {
      chosen.wireframe = true;
    } else if (!word.empty()) {
      refuse("--show " + word, "there is no such thing", "name some of hud,map,box,cells,wireframe,wrong");
    }
  }
  if (chosen.pvs_file.empty() && (chosen.cell || chosen.frozen_from)) {
    refuse("--cell, --frozen-from", "there are no cells without a .pvs file", "name the .pvs file after the scene");
  }
}

int fail(const std::string& line, int code) {
  fmt::print(stderr, "sightcell-viewer: {}\n", line);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Flies through a scene and what was baked of it"};
  app.footer(keys_text());
  viewer::options chosen;
  words rest;
  try {
    add_options(app, chosen, rest);
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    return fail(std::string(e.what()) + "; see --help [viewer.wrong-use]", 2);
  }
  try {
    take_apart(rest, chosen);
    viewer::run(chosen);
    return 0;
  } catch (const error& e) {
    return fail(e.what(), e.kind() == error_kind::wrong_use ? 2 : e.kind() == error_kind::bad_input ? 4 : 1);
  } catch (const std::exception& e) {
    return fail(e.what(), 1);
  }
}
