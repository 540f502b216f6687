// bench_samplers: the samplers against each other: what each finds in the cells of a scene, in how much CPU time, and
// what independent rays see that it missed. It judges nothing; bench_targets.py, bench_coverage.py and
// tests/research/bench_samplers.py plan, and make tables and figures of what this writes. One process per scene, Linux
// alone.
//
//   measure   all jobs over all cells; what was measured before is taken from the cache
//   growth    how a cell's set grows with hemicubes on one face
//   pictures  what sets show and lack, as PNGs
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>
#include <thread>

#include "bench/samplers/commands.h"

namespace {

using namespace sightcell::bench;

void declare(CLI::App& app, bench_options& how) {
  app.add_option("SCENE", how.scene, "a .glb file")->required()->check(CLI::ExistingFile);
  app.add_option("--cells", how.cells, "boxes; else automatic cells")->check(CLI::ExistingFile);
  app.add_option("--jobs", how.jobs, "what to measure")->required()->check(CLI::ExistingFile);
  app.add_option("--threads", how.threads, "cells that are measured at once; 0: as many as there are cores");
  app.add_option("--cell-limit", how.cell_limit, "so many of the cells, spread evenly; 0: all");
  app.add_option("--scene-hash", how.scene_hash, "names the scene's content; else the hash of its bytes");
}

void declare_cache(CLI::App& app, bench_options& how) {
  app.add_option("--cache", how.cache, "a folder for sets, truths and figures")->required();
}

void declare_cell(CLI::App& app, bench_options& how) {
  app.add_option("--cell", how.cell, "by name")->required();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Samplers against each other and the truth.", "bench_samplers");
  app.require_subcommand(1);
  bench_options how;
  std::function<void(const bench_options&)> command;
  const auto add = [&](const char* name, const char* meaning, const char* out, void (*run)(const bench_options&)) {
    CLI::App* verb = app.add_subcommand(name, meaning);
    declare(*verb, how);
    verb->add_option("--out", how.out, out)->required();
    verb->callback([&command, run] { command = run; });
    return verb;
  };
  declare_cache(*add("measure", "all jobs over all cells", "the JSON to write", run_measure), how);
  declare_cell(*add("growth", "a set after each hemicube on one face", "the JSON to write", run_growth), how);
  CLI::App* pictures = add("pictures", "what sets show and lack", "a folder for PNGs", run_pictures);
  declare_cache(*pictures, how);
  declare_cell(*pictures, how);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    if (how.threads == 0) how.threads = std::max(1u, std::thread::hardware_concurrency());
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, how.threads);
    tbb::task_arena(static_cast<int>(how.threads)).execute([&] { command(how); });
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "bench_samplers: " << e.what() << '\n';
    return 1;
  }
}
