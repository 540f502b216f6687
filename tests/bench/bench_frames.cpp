// Frames along a path through a baked scene, drawn whole, by clusters in the frustum, by cell set, and by both. Passes
// no judgement. bench_frames.py bakes what it needs and prints the tables.
//   bench_frames walk SCENE PATH [--frames N] [--step M] [--seed N] [--near x,y,z]   writes a path through the scene's
//   view cells bench_frames cells SCENE PATH CELLS.json                          the cells that the eyes of a path are
//   in bench_frames draw SCENE MERGED.pvs PATH [--first N] [--count N]   measures frames of it
#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/frames/baked_world.h"
#include "bench/frames/path_file.h"
#include "bench/frames/stage.h"
#include "bench/frames/walk.h"
#include "bench/frames/ways.h"
#include "sightcell/picture/gl_context.h"

namespace {

using namespace sightcell;
using namespace sightcell::bench;
using nlohmann::ordered_json;

struct arguments {
  std::string scene, pvs, path, cells, json;
  walk_settings walk;
  cluster_sizes clusters;
  std::vector<float> near;
  std::uint32_t first = 0, count = 0, width = 640, height = 360;
};

void write_json(const std::string& file, const ordered_json& value) {
  if (file.empty()) {
    std::cout << value.dump() << '\n';
  } else if (std::ofstream out(file); !(out << value.dump(1) << '\n').flush()) {
    throw std::runtime_error(file + ": cannot be written");
  }
}

void record(arguments args) {
  if (!args.near.empty()) args.walk.near = {args.near[0], args.near[1], args.near[2]};
  const scene::scene s = scene::load_gltf(args.scene);
  const std::vector<path_frame> path = record_walk(scene::flatten(s), args.walk);
  write_path(args.path, path);
  std::cerr << args.path << ": " << path.size() << " frames\n";
}

void write_cells(const arguments& args) {
  const scene::scene s = scene::load_gltf(args.scene);
  std::uint32_t outside = 0;
  ordered_json boxes = ordered_json::array();
  for (const bake::view_cell& c : cells_of(scene::flatten(s), read_path(args.path), outside)) {
    boxes.push_back({{"name", "cell " + std::to_string(boxes.size())},
                     {"min", {c.min.x, c.min.y, c.min.z}},
                     {"max", {c.max.x, c.max.y, c.max.z}}});
  }
  write_json(args.cells, {{"cells", boxes}});
  std::cerr << args.cells << ": " << boxes.size() << " cells; " << outside << " eyes are in none\n";
}

double milliseconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

// What one way took for one frame. On a software rasterizer vertices are transformed while calls are issued, and pixels
// are filled by threads of its own until the frame is finished.
ordered_json measure(way& how, stage& on, const frame_camera& camera) {
  const double frame_start = milliseconds(CLOCK_PROCESS_CPUTIME_ID);
  const double start = milliseconds(CLOCK_THREAD_CPUTIME_ID);
  how.cull(camera);
  const double culled = milliseconds(CLOCK_THREAD_CPUTIME_ID);
  on.begin(camera);
  how.issue(on);
  const double issued = milliseconds(CLOCK_THREAD_CPUTIME_ID);
  glFinish();
  const double frame_end = milliseconds(CLOCK_PROCESS_CPUTIME_ID);
  return {{"cull_ms", culled - start}, {"issue_ms", issued - culled}, {"frame_ms", frame_end - frame_start},
          {"polygons", how.polygons},  {"draws", how.draws},          {"calls", how.calls},
          {"changed", how.changed}};
}

void draw(const arguments& args) {
  const baked_world world(args.scene, args.pvs);
  const std::vector<path_frame> path = read_path(args.path);
  if (args.first >= path.size()) throw std::runtime_error(args.path + ": has no frame " + std::to_string(args.first));
  const picture::gl_context context;
  stage on(world, args.width, args.height);
  std::vector<named_way> ways = make_ways(world, on, args.clusters);
  context.check("bench_frames setup");

  // What comes before the first frame, so that the driver has compiled and a first frame is no change of cells.
  const frame_camera before = on.camera_at(path[args.first > 0 ? args.first - 1 : 0]);
  for (const named_way& w : ways) measure(*w.how, on, before);

  ordered_json frames = ordered_json::array();
  const std::size_t end = args.count == 0 ? path.size() : std::min<std::size_t>(path.size(), args.first + args.count);
  for (std::size_t f = args.first; f < end; ++f) {
    const frame_camera camera = on.camera_at(path[f]);
    ordered_json row{{"frame", f}};
    frame_picture reference;
    for (const named_way& w : ways) {
      ordered_json cost = measure(*w.how, on, camera);
      frame_picture shown = on.read();
      if (reference.depths.empty()) {
        reference = std::move(shown);
        row["seen"] = std::ranges::count_if(reference.surfaces, [](std::uint32_t surface) { return surface != 0; });
      } else {
        const frame_difference differs = compare(reference, shown);
        cost["differing"] = differs.differing;
        cost["in_place"] = differs.in_place;
      }
      row[w.name] = std::move(cost);
    }
    const way& set = *ways.back().how;
    row["cell"] = set.cell;
    row["outside"] = (set.flags & SIGHTCELL_FRAME_OUTSIDE) != 0;
    frames.push_back(std::move(row));
    context.check("bench_frames");
  }
  write_json(args.json, {{"device", context.renderer()},
                         {"software", context.software()},
                         {"polygons", world.polygons()},
                         {"cells", world.info.cell_count},
                         {"groups", world.groups.size()},
                         {"pixels", std::size_t{args.width} * args.height},
                         {"frames", frames}});
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Frames along a path: whole, in the frustum, by cell set.");
  arguments args;
  app.require_subcommand(1);
  const auto verb = [&](const char* name, const char* what) {
    CLI::App* const made = app.add_subcommand(name, what);
    made->add_option("SCENE", args.scene, "a glTF scene")->required();
    return made;
  };
  CLI::App* const walk = verb("walk", "writes a path through the scene's automatic view cells");
  walk->add_option("PATH", args.path, "where it goes")->required();
  walk->add_option("--frames", args.walk.frames, "of the path")->check(CLI::Range(2, 100000));
  walk->add_option("--step", args.walk.step, "meters from frame to frame")->check(CLI::Range(0.001, 10.0));
  walk->add_option("--seed", args.walk.seed, "of the walk");
  walk->add_option("--near", args.near, "the walk begins in a cell near this place; without: in the thick of it")
      ->type_name("x,y,z")
      ->delimiter(',')
      ->expected(3);
  CLI::App* const cells = verb("cells", "writes the automatic view cells that a path goes through");
  cells->add_option("PATH", args.path, "the path")->required();
  cells->add_option("CELLS", args.cells, "where they go, as bake --cells-file takes them")->required();
  CLI::App* const drawing = verb("draw", "measures frames of a path");
  drawing->add_option("FILE", args.pvs, "baked with --layout merged")->required();
  drawing->add_option("PATH", args.path, "the path")->required();
  drawing->add_option("--first", args.first, "frame");
  drawing->add_option("--count", args.count, "of frames; 0: all that follow");
  drawing->add_option("--width", args.width, "pixels")->check(CLI::Range(16, 8192));
  drawing->add_option("--height", args.height, "pixels")->check(CLI::Range(16, 8192));
  drawing->add_option("--cluster", args.clusters.frustum, "polygons of a cluster of the scene")
      ->check(CLI::Range(1, 65536));
  drawing->add_option("--set-cluster", args.clusters.sets, "the same, of which those of a set are kept")
      ->check(CLI::Range(1, 65536));
  drawing->add_option("--json,--json-file", args.json, "where the frames go; without: standard output");
  CLI11_PARSE(app, argc, argv);
  try {
    if (*walk) record(args);
    if (*cells) write_cells(args);
    if (*drawing) draw(args);
  } catch (const std::exception& failure) {
    std::cerr << "bench_frames: " << failure.what() << '\n';
    return 1;
  }
  return 0;
}
