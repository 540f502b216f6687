// bench_sets --folder DIR [--cells N] [--ids N]: as many records as a big bake makes, through checkpoint and writer,
// without rendering: CPU seconds and peak memory of each step. One JSON object on standard output; bench_scale.py reads
// it. Linux alone: the peak of a step is VmHWM, set back by /proc/self/clear_refs.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cell_set/cell_record.h"
#include "cells/lattice.h"
#include "cells/view_cell.h"
#include "checkpoint/checkpoint.h"
#include "file/pvs_output.h"
#include "sightcell/base/error.h"
#include "sightcell/base/process_time.h"
#include "sightcell/base/random.h"
#include "sightcell/scene/scene.h"

namespace {

using namespace sightcell;

constexpr std::uint32_t polygons = 2'000'000;

std::uint64_t peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kib = 0;
    if (word == "VmHWM:" && status >> kib) return kib * 1024;
  }
  return 0;
}

std::uint64_t disk_bytes(const std::filesystem::path& folder) {
  std::uint64_t sum = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) sum += entry.file_size();
  return sum;
}

// A set like those of cells in a street: runs of a few polygons, three quarters of them those of the other cells of the
// same 64, with witnesses.
class record_maker {
 public:
  explicit record_maker(std::uint32_t ids) : ids_(ids) {}

  bake::cell_record make(std::uint32_t cell) {
    bake::cell_record record;
    std::vector<std::uint32_t>& set = record.set;
    add_runs(cell / 64, ids_ * 3 / 4, set);
    add_runs(0x80000000u + cell, ids_ * 9 / 8, set);  // some come twice
    std::sort(set.begin(), set.end());
    set.erase(std::unique(set.begin(), set.end()), set.end());
    set.resize(std::min<std::size_t>(set.size(), ids_));
    bake::random_stream random(1, cell, bake::purpose::boundary);
    for (int i = 0; i < 200; ++i) record.witnesses.push_back(random.in_box({0, 0, 0}, {1, 1, 1}));
    for (std::size_t i = 0; i < set.size(); ++i)
      record.witness_of.push_back(static_cast<std::uint32_t>(set[i] / 16 * 2654435761u % record.witnesses.size()));
    record.rays = 3000;
    record.upper_bound = 1e-3;
    return record;
  }

 private:
  static void add_runs(std::uint64_t name, std::size_t until, std::vector<std::uint32_t>& set) {
    bake::random_stream random(2, name, bake::purpose::boundary);
    while (set.size() < until) {
      const auto first = static_cast<std::uint32_t>(random.bits() % (polygons - 16));
      const auto count = static_cast<std::uint32_t>(1 + random.bits() % 7);
      for (std::uint32_t i = 0; i < count; ++i) set.push_back(first + i);
    }
  }
  std::uint32_t ids_;
};

class bench {
 public:
  bench(std::filesystem::path folder, std::uint32_t cells, std::uint32_t ids)
      : folder_(std::move(folder)), cells_(cells), ids_(ids), maker_(ids) {}

  nlohmann::ordered_json run() {
    const std::filesystem::path output = folder_ / "sets.pvs", beside = folder_ / "sets.pvs.bake";
    bake::checkpoint done(beside, "bench_sets", true);
    step("making and storing them, 8 at a time", [&] { store_all(done); });
    step("telling of them, as a bake that goes on", [&] {
      std::uint32_t told = 0;
      const std::uint32_t damaged = done.survey([&](std::uint32_t, bake::cell_stage, const bake::cell_summary& one) {
        told += one.polygons == ids_ ? 1 : 0;
      });
      if (damaged != 0 || told != cells_) throw std::runtime_error("records are not what they were");
    });
    step("encoding and writing the file", [&] { write(done, output); });
    done.remove();
    return {{"cells", cells_}, {"ids", ids_}, {"polygons", polygons}, {"steps", steps_}};
  }

 private:
  void step(const std::string& name, const std::function<void()>& work) {
    std::ofstream("/proc/self/clear_refs") << 5;
    const double began = bake::process_cpu_seconds();
    work();
    steps_.push_back({{"step", name},
                      {"cpu", bake::process_cpu_seconds() - began},
                      {"peak", peak_memory()},
                      {"bytes", disk_bytes(folder_)}});
  }
  void store_all(bake::checkpoint& done) {
    std::vector<bake::stage_record> some;
    for (std::uint32_t cell = 0; cell < cells_; ++cell) {
      some.push_back({cell, bake::cell_stage::finished, maker_.make(cell)});
      if (some.size() < 8 && cell + 1 < cells_) continue;
      done.store(some);
      some.clear();
    }
  }
  void write(bake::checkpoint& done, const std::filesystem::path& output) {
    scene::scene s;
    s.name = "bench_sets";
    s.polygon_count = polygons;
    s.draws.push_back({});
    s.draws.back().polygon_count = polygons;
    const bake::lattice grid(1.0);
    std::vector<bake::view_cell> cells;
    for (std::uint32_t i = 0; i < cells_; ++i) cells.push_back(grid.cell({.z = i / 100, .y = 0, .x = i % 100}));
    bake::summary sum;
    bake::write_pvs(
        bake::frame_of(s, {}, "{}", cells),
        [&](std::uint32_t cell) { return *done.load(cell, bake::cell_stage::finished); }, output, {}, sum);
  }

  std::filesystem::path folder_;
  std::uint32_t cells_, ids_;
  record_maker maker_;
  nlohmann::ordered_json steps_ = nlohmann::ordered_json::array();
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Records of a big bake through checkpoint and writer.");
  std::string folder;
  std::uint32_t cells = 10'000, ids = 30'000;
  app.add_option("--folder", folder)->required();
  app.add_option("--cells", cells);
  app.add_option("--ids", ids);
  CLI11_PARSE(app, argc, argv);
  try {
    std::cout << bench(folder, cells, ids).run().dump(1) << '\n';
  } catch (const std::exception& e) {
    std::cerr << "bench_sets: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
