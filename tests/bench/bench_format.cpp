// bench_format FILE.pvs [--json OUT.json] [--repeat N] [--quick]: how many bytes the cell sets of a file take, and how
// long decoding takes, beside CRoaring, varint runs and zstd, each at its best settings and checked to give the same
// ids. One JSON object, on standard output where no file is named. bench_format.py makes tables of it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "bench/format_peers/corpus.h"
#include "bench/format_peers/peers.h"
#include "bench/format_peers/timing.h"

namespace {

using namespace sightcell::bench;
using nlohmann::ordered_json;

std::ptrdiff_t rows_of_depth(const corpus& of, int depth) {
  return std::count(of.depth.begin(), of.depth.end(), depth);
}

ordered_json facts_of(const corpus& of) {
  const double cells = std::max<double>(of.info.cell_count, 1.0);
  const double visible = static_cast<double>(of.visible);
  return {{"polygons", of.info.polygon_count},
          {"draws", of.info.draw_count},
          {"cells", of.info.cell_count},
          {"visible_polygons", of.visible},
          {"visible_set_percent", 100.0 * visible / cells / std::max<double>(of.info.polygon_count, 1.0)},
          {"runs", of.run_count},
          {"runs_per_cell", static_cast<double>(of.run_count) / cells},
          {"ranges", of.range_count},
          {"ranges_per_cell", static_cast<double>(of.range_count) / cells},
          {"polygons_seen", of.polygons_seen},
          {"atoms", of.atoms},
          {"rows_of_depth", {rows_of_depth(of, 0), rows_of_depth(of, 1), rows_of_depth(of, 2)}},
          {"file_bytes", of.file_bytes},
          {"format_version", of.info.format_version}};
}

ordered_json bytes_of(const peer_rows& peers) {
  ordered_json tries = ordered_json::array();
  for (const dictionary_try& one : peers.tries) tries.push_back({{"dictionary", one.dictionary}, {"bytes", one.rows}});
  const auto whole = [](const whole_file& one) -> ordered_json {
    return {{"bytes", one.bytes}, {"long_distance", one.long_distance}};
  };
  return {{"roaring", {{"bytes", size_of(peers.roaring)}}},
          {"roaring_zstd", {{"bytes", size_of(peers.roaring_zstd)}}},
          {"varint", {{"bytes", size_of(peers.varint)}}},
          {"varint_zstd_dictionary",
           {{"bytes", size_of(peers.varint_dictionary)},
            {"dictionary", peers.dictionary.size()},
            {"bytes_with_dictionary", size_of(peers.varint_dictionary) + peers.dictionary.size()},
            {"tries", tries}}},
          {"varint_zstd_whole", whole(peers.varint_whole)},
          {"roaring_zstd_whole", whole(peers.roaring_whole)}};
}

ordered_json times_of(const std::vector<call_times>& calls) {
  ordered_json made = ordered_json::object();
  for (const call_times& one : calls)
    made[one.name] = {{"ns_per_cell", one.ns_per_cell},
                      {"ns_per_run", one.ns_per_run},
                      {"ns_per_polygon", one.ns_per_polygon},
                      {"worst_cell_ns", one.worst_cell_ns},
                      {"ns_per_run_of_depth", one.ns_per_run_of_depth}};
  return made;
}

ordered_json run(const std::string& file, const timing_settings& how) {
  const corpus of = read_corpus(file);
  if (of.info.cell_count < 2) throw std::runtime_error(file + ": has fewer than two cells");
  const peer_rows peers = pack_peers(of);
  const all_times times = measure(of, peers, how);
  return {{"file", file},
          {"facts", facts_of(of)},
          {"peers", bytes_of(peers)},
          {"times",
           {{"clock", "steady"},
            {"clock_ns", times.clock_ns},
            {"repeat", how.repeat},
            {"shuffled", times_of(times.shuffled)},
            {"file_order", times_of(times.file_order)},
            {"cold",
             {{"cells", std::min<std::size_t>(how.cold_cells, of.info.cell_count)},
              {"walked_bytes", how.walk_bytes},
              {"calls", times_of(times.cold)}}}}}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Bytes and decode times of a .pvs file beside its peers.");
  std::string file, json;
  timing_settings how;
  bool quick = false;
  app.add_option("FILE", file, "a .pvs file of two cells or more, none in another")->required();
  app.add_option("--json,--json-file", json, "where the result goes; without: standard output");
  app.add_option("--repeat", how.repeat, "passes, of which the median counts")->check(CLI::Range(1, 1000));
  app.add_flag("--quick", quick, "one pass, a few cold cells; its times say nothing");
  CLI11_PARSE(app, argc, argv);
  if (quick) {
    how.repeat = 1;
    how.cold_cells = 4;
  }
  try {
    const ordered_json result = run(file, how);
    if (json.empty()) {
      std::cout << result.dump(1) << '\n';
    } else if (std::ofstream out(json); !(out << result.dump(1) << '\n')) {
      throw std::runtime_error(json + ": cannot be written");
    }
  } catch (const std::exception& failure) {
    std::cerr << "bench_format: " << failure.what() << '\n';
    return 1;
  }
  return 0;
}
