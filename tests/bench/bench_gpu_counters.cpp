// What a device can do (pixels, triangles and atomics per second), and how many hemicubes per second come of it. Runs
// on any device, a software rasterizer too; says which.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench/gpu_counters/counters.h"
#include "bench/gpu_counters/pace.h"
#include "sightcell/base/error.h"

namespace {

namespace bench = sightcell::bench;
using sightcell::picture::gl_context;

struct options {
  std::string scene, cells, json_file, gather = "all", culling = "all";
  std::uint32_t resolution = 1024;
  std::uint32_t samples = 32;
  double seconds = 0.5;
  bool quick = false;
};

nlohmann::json counters_of(const gl_context& context, const options& asked) {
  const bench::gpu_counters c = bench::count_gpu(context, asked.resolution, asked.seconds);
  const auto line = [](const char* what, double value) { std::printf("%-40s %10.1f million/s\n", what, 1e-6 * value); };
  line("pixels (R32UI and D32F)", c.pixels_per_second);
  line("small triangles", c.triangles_per_second);
  line("small triangles behind a wall", c.hidden_triangles_per_second);
  line("compute atomics, each on its own word", c.atomics_per_second);
  line("compute atomics, all on one word", c.atomics_on_one_word_per_second);
  return {{"pixels_per_second", c.pixels_per_second},
          {"triangles_per_second", c.triangles_per_second},
          {"hidden_triangles_per_second", c.hidden_triangles_per_second},
          {"atomics_per_second", c.atomics_per_second},
          {"atomics_on_one_word_per_second", c.atomics_on_one_word_per_second}};
}

nlohmann::json paces_of(const gl_context& context, const options& asked) {
  const auto world = sightcell::scene::flatten(sightcell::scene::load_gltf(asked.scene));
  const auto poses = bench::poses_in(asked.cells, asked.samples);
  std::printf("\n%s: %zu polygons, %zu poses\n%-10s %-10s %8s %12s %14s %18s %14s\n", asked.scene.c_str(),
              world.kinds.size(), poses.size(), "gather", "culling", "at once", "samples/s", "CPU ms/sample",
              "triangles/sample", "polygons seen");
  nlohmann::json rows = nlohmann::json::array();
  for (const bench::pace& p :
       bench::measure_paces(context, world, poses, asked.resolution, asked.gather, asked.culling)) {
    std::printf("%-10s %-10s %8u %12.1f %14.1f %18.0f %14.1f\n", p.gather.c_str(), p.culling.c_str(), p.at_once,
                p.samples_per_second, p.cpu_ms_per_sample, p.triangles_per_sample, p.polygons_seen);
    nlohmann::json stages = nlohmann::json::object();
    for (const auto& [name, seconds] : p.stages) {
      std::printf("    %-22s %10.1f us\n", name.c_str(), 1e6 * seconds);
      stages[name] = 1e6 * seconds;
    }
    rows.push_back({{"gather", p.gather},
                    {"culling", p.culling},
                    {"at_once", p.at_once},
                    {"samples_per_second", p.samples_per_second},
                    {"cpu_ms_per_sample", p.cpu_ms_per_sample},
                    {"triangles_per_sample", p.triangles_per_sample},
                    {"polygons_seen", p.polygons_seen},
                    {"stage_microseconds", stages}});
  }
  return {{"scene", asked.scene}, {"polygons", world.kinds.size()}, {"poses", poses.size()}, {"paces", rows}};
}

int run(const options& asked) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // each line as it comes: a limit of time may end the program
  const gl_context context;
  std::printf("device: %s (%s), resolution %u\n", context.renderer().c_str(), context.choice().c_str(),
              asked.resolution);
  nlohmann::json result{{"device", context.renderer()},
                        {"software", context.software()},
                        {"resolution", asked.resolution},
                        {"counters", counters_of(context, asked)}};
  if (!asked.scene.empty()) result["hemicubes"] = paces_of(context, asked);
  if (!asked.json_file.empty()) {
    std::ofstream out(asked.json_file);
    if (!(out << result.dump(2) << '\n').flush()) {
      std::fprintf(stderr, "bench_gpu_counters: %s cannot be written\n", asked.json_file.c_str());
      return 1;
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  options asked;
  CLI::App app{"Counts what the OpenGL device can do, and hemicubes per second of a scene on it"};
  auto* scene = app.add_option("scene", asked.scene, "a .glb, for hemicubes per second")->check(CLI::ExistingFile);
  auto* cells =
      app.add_option("--cells", asked.cells, "cells file: where the hemicubes stand")->check(CLI::ExistingFile);
  scene->needs(cells);
  auto* resolution =
      app.add_option("--resolution", asked.resolution, "pixels along a face (1024)")->check(CLI::Range(16, 4096));
  auto* samples = app.add_option("--samples", asked.samples, "hemicubes (32)");
  app.add_option("--gather", asked.gather, "compute, read_back or all (all)")
      ->check(CLI::IsMember({"compute", "read_back", "all"}));
  app.add_option("--culling", asked.culling, "none, frustum, occlusion or all (all)")
      ->check(CLI::IsMember({"none", "frustum", "occlusion", "all"}));
  app.add_option("--json-file", asked.json_file, "write the results here, too");
  app.add_flag("--quick", asked.quick, "small and short: does it run?");
  CLI11_PARSE(app, argc, argv);
  if (asked.quick) {
    if (resolution->empty()) asked.resolution = 64;
    if (samples->empty()) asked.samples = 4;
    asked.seconds = 0.01;
  }
  try {
    return run(asked);
  } catch (const sightcell::error& e) {
    std::fprintf(stderr, "bench_gpu_counters: %s\n", e.what());
    return 1;
  }
}
