// bench_stages SCENE [--threads N]: what a bake takes before its first cell, stage by stage: CPU seconds, those of them
// that other threads than the calling one computed, wall seconds, the memory that stays and the most that was resident
// meanwhile, both above what was resident before. One JSON object on standard output; bench_scale.py reads
// it. Linux alone: the peak of a stage is VmHWM, set back by /proc/self/clear_refs.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cell_set/cell_set.h"
#include "hemicube/cpu/cpu_source.h"
#include "search/near_polygons.h"
#include "sightcell/base/error.h"
#include "sightcell/base/process_time.h"
#include "sightcell/scene/scene.h"
#include "trace/duplicates.h"
#include "trace/ray_scene.h"

namespace {

using namespace sightcell;

// Bytes, from /proc/self/status.
std::uint64_t memory(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kib = 0;
    if (word == field + ":" && status >> kib) return kib * 1024;
  }
  return 0;
}

void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << 5;
}

class stopwatch {
 public:
  double wall() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count(); }
  double cpu() const { return bake::process_cpu_seconds() - cpu_began_; }
  double own_cpu() const { return bake::thread_cpu_seconds() - own_began_; }

 private:
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  double cpu_began_ = bake::process_cpu_seconds(), own_began_ = bake::thread_cpu_seconds();
};

nlohmann::ordered_json measured(const std::string& name, const std::function<void()>& stage) {
  const std::uint64_t before = memory("VmRSS");
  forget_peak();
  const stopwatch watch;
  stage();
  const double wall = watch.wall(), cpu = watch.cpu(), own = watch.own_cpu();
  const auto above = [before](std::uint64_t bytes) {
    return static_cast<std::int64_t>(bytes) - static_cast<std::int64_t>(before);
  };
  return {{"stage", name},
          {"cpu", cpu},
          {"workers", cpu - own},
          {"wall", wall},
          {"stays", above(memory("VmRSS"))},
          {"peak", above(memory("VmHWM"))},
          {"resident", memory("VmRSS")}};
}

nlohmann::ordered_json stages_of(const std::string& path) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::array();
  scene::scene loaded;
  scene::world_geometry geometry;
  std::optional<bake::ray_scene> rays;
  std::optional<bake::near_polygons> neighbors;
  std::optional<bake::duplicate_classes> duplicates;
  std::unique_ptr<bake::hemicube_source> source;
  std::optional<bake::cell_set> lane_set;
  bake::hemicube_view view;
  stages.push_back(measured("import", [&] { loaded = scene::load_gltf(path); }));
  stages.push_back(measured("flatten", [&] { geometry = scene::flatten(loaded); }));
  stages.push_back(measured("rays", [&] { rays.emplace(geometry, false); }));
  stages.push_back(measured("neighbors", [&] { neighbors.emplace(*rays); }));
  stages.push_back(measured("source", [&] {
    const float far_plane = glm::distance(geometry.min, geometry.max);
    source = bake::make_cpu_source(geometry, {.resolution = 256, .far_plane = far_plane});
  }));
  stages.push_back(measured("duplicates", [&] { duplicates.emplace(geometry, false); }));
  // What every cell in work has besides: a set, and a place to draw in.
  stages.push_back(measured("lane", [&] {
    lane_set.emplace(loaded.polygon_count, &*duplicates);
    const bake::pose middle{.eye = 0.5f * (geometry.min + geometry.max)};
    source->render(middle, view);
  }));
  return {{"scene", loaded.name}, {"polygons", loaded.polygon_count}, {"stages", stages}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What a bake takes before its first cell.");
  std::string scene;
  int threads = 1;
  app.add_option("SCENE", scene)->required();
  app.add_option("--threads", threads);
  CLI11_PARSE(app, argc, argv);
  try {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    nlohmann::ordered_json found;
    arena.execute([&] { found = stages_of(scene); });
    found["threads"] = threads;
    std::cout << found.dump(1) << '\n';
  } catch (const sightcell::error& e) {
    std::cerr << "bench_stages: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
