// bench_samplers: the samplers against each other: what each finds in the cells of a scene, in how much CPU time, and
// what independent rays see that it missed. It judges nothing; bench_samplers.py plans, and makes tables and figures of
// what this writes. One process per scene, Linux alone.
//
//   measure   all jobs over all cells; what was measured before is taken from the cache
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <thread>

#include "bench/samplers/measure.h"

namespace {

using namespace sightcell::bench;

void declare(CLI::App& app, measure_options& how) {
  app.add_option("SCENE", how.scene, "a .glb file")->required()->check(CLI::ExistingFile);
  app.add_option("--cells", how.cells, "boxes; else automatic cells")->check(CLI::ExistingFile);
  app.add_option("--jobs", how.jobs, "what to measure")->required()->check(CLI::ExistingFile);
  app.add_option("--out", how.out, "the JSON to write")->required();
  app.add_option("--cache", how.cache, "a folder for sets, truths and figures")->required();
  app.add_option("--threads", how.threads, "cells that are measured at once; 0: as many as there are cores");
  app.add_option("--cell-limit", how.cell_limit, "so many of the cells, spread evenly; 0: all");
  app.add_option("--scene-hash", how.scene_hash, "names the scene's content; else the hash of its bytes");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Samplers against each other and the truth.", "bench_samplers");
  app.require_subcommand(1);
  measure_options measure;
  declare(*app.add_subcommand("measure", "all jobs over all cells"), measure);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    if (measure.threads == 0) measure.threads = std::max(1u, std::thread::hardware_concurrency());
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, measure.threads);
    int code = 0;
    tbb::task_arena(static_cast<int>(measure.threads)).execute([&] { code = run_measure(measure); });
    return code;
  } catch (const std::exception& e) {
    std::cerr << "bench_samplers: " << e.what() << '\n';
    return 1;
  }
}
