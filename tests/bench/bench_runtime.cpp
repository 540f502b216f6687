// bench_runtime [FILE.pvs ...] [--json-file OUT.json] [--repeat N] [--quick]: what a frame costs. Lookups among 1,000
// to a million cells of our own, frames that stay in their cell, boxes among volumes, and, for each file, switches to
// the cells whose sets come nearest to some sizes, for each output, beside memcpy of the same bytes and CRoaring.
// Prints tables; passes no judgement.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/runtime_frames/box_tests.h"
#include "bench/runtime_frames/lookups.h"
#include "bench/runtime_frames/switches.h"

namespace {

using namespace sightcell::bench;
using nlohmann::ordered_json;

void print(const lookup_row& row) {
  std::printf("| %s | %u | %.2f | %.1f | %.1f | %.1f |\n", row.kind.c_str(), row.cells, row.bytes_per_cell,
              row.random_ns, row.coherent_ns, row.frame_ns);
}

void print(const switch_row& row) {
  std::printf("| %u | %u | %.0f | %.1f | %s |", row.polygons, row.ranges, row.run_length, row.move_us,
              row.cold ? "cold" : "warm");
  for (const double us : {row.ranges_us, row.polygons_us, row.indices_us, row.commands_us, row.objects_us,
                          row.memcpy_us, row.roaring_us}) {
    std::printf(" %.1f |", us);
  }
  std::printf(" %.2f |\n", (row.move_us + row.indices_us) / std::max(row.memcpy_us, 1e-9));
}

ordered_json json_of(const lookup_row& row) {
  return {{"kind", row.kind},
          {"cells", row.cells},
          {"bytes_per_cell", row.bytes_per_cell},
          {"random_ns", row.random_ns},
          {"coherent_ns", row.coherent_ns},
          {"frame_ns", row.frame_ns}};
}

ordered_json json_of(const box_test_row& row) {
  return {{"volumes", row.volumes},
          {"visible_share", row.visible_share},
          {"random_ns", row.random_ns},
          {"walking_ns", row.walking_ns},
          {"with_origin_ns", row.with_origin_ns}};
}

ordered_json json_of(const switch_row& row) {
  return {{"file", row.file},
          {"cell", row.cell},
          {"polygons", row.polygons},
          {"ranges", row.ranges},
          {"cold", row.cold},
          {"move_us", row.move_us},
          {"ranges_us", row.ranges_us},
          {"polygons_us", row.polygons_us},
          {"indices_us", row.indices_us},
          {"commands_us", row.commands_us},
          {"objects_us", row.objects_us},
          {"memcpy_us", row.memcpy_us},
          {"roaring_us", row.roaring_us}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What a frame of the runtime costs.");
  std::vector<std::string> files;
  std::vector<std::uint32_t> sizes{8'000, 45'000, 84'000};
  std::string json;
  frame_timing how;
  bool quick = false;
  app.add_option("FILE", files, "files whose cells are switched to");
  app.add_option("--sizes", sizes, "polygons of the sets to look for")->delimiter(',');
  app.add_option("--json,--json-file", json, "where the figures go besides");
  app.add_option("--repeat", how.repeat, "of each figure, of which the median counts")->check(CLI::Range(1, 10000));
  app.add_flag("--quick", quick, "few repeats, small lattices; its times say nothing");
  CLI11_PARSE(app, argc, argv);
  if (quick) {
    how.repeat = 3;
    how.most_cells = 10'000;
    how.lookups = 10'000;
  }
  try {
    ordered_json result;
    std::printf(
        "| cells are | cells | bytes/cell | random ns | along a path ns | frame in its cell ns "
        "|\n|---|---|---|---|---|---|\n");
    for (const lookup_row& row : measure_lookups(how)) {
      print(row);
      result["lookups"].push_back(json_of(row));
    }
    // Masked Occlusion Culling (Hasselgren, Andersson, Akenine-Moller 2016) reports 36 to 77 ns for a box; it answers
    // for one frame's depths.
    std::printf(
        "\n| volumes | visible | random ns | people who walk ns | with an origin ns |\n|---|---|---|---|---|\n");
    for (const box_test_row& row : measure_box_tests(how)) {
      std::printf("| %u | %.0f %% | %.1f | %.1f | %.1f |\n", row.volumes, 100.0 * row.visible_share, row.random_ns,
                  row.walking_ns, row.with_origin_ns);
      result["box_tests"].push_back(json_of(row));
    }
    for (const std::string& file : files) {
      std::printf(
          "\n%s\n\n| polygons | ranges | polygons/range | move us | | ranges us | ids us | indices us | commands us | "
          "objects us | memcpy us | CRoaring us | (move + indices)/memcpy "
          "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
          file.c_str());
      for (const switch_row& row : measure_switches(file, sizes, how)) {
        print(row);
        result["switches"].push_back(json_of(row));
      }
    }
    if (std::ofstream out(json); !json.empty() && !(out << result.dump(1) << '\n')) {
      throw std::runtime_error(json + ": cannot be written");
    }
  } catch (const std::exception& failure) {
    std::cerr << "bench_runtime: " << failure.what() << '\n';
    return 1;
  }
  return 0;
}
