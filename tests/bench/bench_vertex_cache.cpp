// bench_vertex_cache SCENE FILE.pvs [--cells N] [--cache N] [--json OUT.json]: how many vertices a GPU transforms per
// polygon of a cell's list (the average cache miss ratio, ACMR) in stored order, in source order and in the order that
// meshoptimizer finds for the same polygons, draw by draw, or draw group by draw group where the file is merged. The
// cache is first in, first out, and empty where a draw begins.
#include <meshoptimizer.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/scene/scene.h"

namespace {

using namespace sightcell;

struct settings {
  std::string scene, file, json;
  std::uint32_t cells = 32;  // spread evenly
  unsigned cache = 16;       // vertices
};

void require(format::status s, const std::string& what) {
  if (s != format::status::ok) throw std::runtime_error(what + ": " + format::status_text(s));
}

// Vertices that lists of polygons let a GPU transform.
struct transforms {
  std::uint64_t polygons = 0, stored = 0, source = 0, optimized = 0;
  std::uint64_t worst_polygons = 0, worst_stored = 0, worst_optimized = 1;  // of the cell with the worst ratio
};

// Every polygon of a scene as the three vertices that its draw call fetches, and the draw call it belongs to.
struct fetches {
  std::vector<std::uint32_t> corners;  // by source id; numbered through all draws
  std::vector<std::uint32_t> call;     // by source id
  std::uint32_t vertices = 0;
};

fetches fetches_of(const scene::scene& from, const format::reader& file) {
  fetches made;
  made.corners.reserve(3 * std::size_t{from.polygon_count});
  std::vector<std::uint32_t> group_of(from.draws.size());
  for (std::uint32_t i = 0; i < file.draw_count(); ++i) {
    format::draw_record record;
    require(file.draw(i, record), "a draw of the file");
    const auto at = std::ranges::find_if(from.draws, [&](const scene::draw& d) {
      return d.first_source == record.first_source && d.polygon_count == record.polygon_count;
    });
    if (at == from.draws.end()) throw std::runtime_error("the file is of another scene");
    group_of[static_cast<std::size_t>(at - from.draws.begin())] = record.group;
  }
  const bool merged = file.facts().layout == format::host_layout::merged;
  for (std::uint32_t d = 0; d < from.draws.size(); ++d) {
    const scene::draw& draw = from.draws[d];
    const scene::geometry& shape = from.geometries[draw.geometry];
    for (const std::uint32_t corner : shape.indices) made.corners.push_back(draw.base_vertex + corner);
    made.call.insert(made.call.end(), draw.polygon_count, merged ? group_of[d] : d);
    made.vertices =
        std::max<std::uint32_t>(made.vertices, draw.base_vertex + static_cast<std::uint32_t>(shape.positions.size()));
  }
  if (made.call.size() != from.polygon_count) throw std::runtime_error("draws and polygons do not match");
  return made;
}

class cache_counter {
 public:
  cache_counter(const fetches& of, unsigned cache)
      : of_(of), cache_(cache), local_(of.vertices), seen_(of.vertices, 0) {}

  // ids: of one draw call.
  std::uint64_t count(std::span<const std::uint32_t> ids) {
    number(ids);
    return meshopt_analyzeVertexCache(list_.data(), list_.size(), used_, cache_, 0, 0).vertices_transformed;
  }
  // The best of meshoptimizer's two orders.
  std::uint64_t count_optimized(std::span<const std::uint32_t> ids) {
    number(ids);
    best_.resize(list_.size());
    meshopt_optimizeVertexCache(best_.data(), list_.data(), list_.size(), used_);
    const std::uint64_t any =
        meshopt_analyzeVertexCache(best_.data(), best_.size(), used_, cache_, 0, 0).vertices_transformed;
    meshopt_optimizeVertexCacheFifo(best_.data(), list_.data(), list_.size(), used_, cache_);
    return std::min<std::uint64_t>(
        any, meshopt_analyzeVertexCache(best_.data(), best_.size(), used_, cache_, 0, 0).vertices_transformed);
  }

 private:
  // Vertices from 0 on, so that a short list of a large mesh costs little.
  void number(std::span<const std::uint32_t> ids) {
    list_.clear();
    used_ = 0;
    ++now_;
    for (const std::uint32_t id : ids)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = of_.corners[3 * std::size_t{id} + k];
        if (seen_[vertex] != now_) {
          seen_[vertex] = now_;
          local_[vertex] = used_++;
        }
        list_.push_back(local_[vertex]);
      }
  }

  const fetches& of_;
  unsigned cache_;
  std::vector<std::uint32_t> local_, seen_, list_, best_;
  std::uint32_t used_ = 0, now_ = 0;
};

void add_cell(const fetches& of, std::span<const std::uint32_t> ids, cache_counter& counter, transforms& sums) {
  transforms cell;
  std::vector<std::uint32_t> sorted;
  for (std::size_t begin = 0; begin < ids.size();) {
    std::size_t end = begin;
    while (end < ids.size() && of.call[ids[end]] == of.call[ids[begin]]) ++end;
    const std::span<const std::uint32_t> call = ids.subspan(begin, end - begin);
    sorted.assign(call.begin(), call.end());
    std::ranges::sort(sorted);
    cell.stored += counter.count(call);
    cell.source += counter.count(sorted);
    cell.optimized += counter.count_optimized(sorted);
    begin = end;
  }
  cell.polygons = ids.size();
  sums.polygons += cell.polygons;
  sums.stored += cell.stored;
  sums.source += cell.source;
  sums.optimized += cell.optimized;
  if (cell.stored * sums.worst_optimized > sums.worst_stored * cell.optimized && cell.optimized != 0) {
    sums.worst_polygons = cell.polygons;
    sums.worst_stored = cell.stored;
    sums.worst_optimized = cell.optimized;
  }
}

nlohmann::ordered_json run(const settings& how) {
  std::ifstream in(how.file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  format::reader file;
  format::set_reader sets;
  require(format::reader::open(std::as_bytes(std::span(text)), file), how.file);
  require(sets.open(file), how.file);
  const scene::scene from = scene::load_gltf(how.scene);
  if (from.fingerprint != file.facts().scene_fingerprint) throw std::runtime_error(how.file + ": is of another scene");
  const fetches of = fetches_of(from, file);
  cache_counter counter(of, how.cache);
  transforms sums;
  std::vector<std::uint32_t> ids;
  const std::uint32_t cells = std::min(how.cells, file.cell_count());
  for (std::uint32_t i = 0; i < cells; ++i) {
    const auto cell = static_cast<std::uint32_t>(std::uint64_t{i} * file.cell_count() / cells);
    std::span<const format::run> runs;
    require(sets.runs(cell, runs), how.file);
    ids.clear();
    for (const format::run& r : runs)
      for (std::uint32_t n = 0; n < r.count; ++n) ids.push_back(sets.source_of_stored()[r.first + n]);
    add_cell(of, ids, counter, sums);
  }
  const auto ratio = [](std::uint64_t a, std::uint64_t b) {
    return static_cast<double>(a) / static_cast<double>(std::max<std::uint64_t>(b, 1));
  };
  return {{"cells", cells},
          {"cache", how.cache},
          {"polygons", sums.polygons},
          {"acmr_stored", ratio(sums.stored, sums.polygons)},
          {"acmr_source", ratio(sums.source, sums.polygons)},
          {"acmr_optimized", ratio(sums.optimized, sums.polygons)},
          {"stored_by_optimized", ratio(sums.stored, sums.optimized)},
          {"source_by_optimized", ratio(sums.source, sums.optimized)},
          {"worst_cell_stored_by_optimized", ratio(sums.worst_stored, sums.worst_optimized)},
          {"worst_cell_polygons", sums.worst_polygons}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Vertices that lists of visible polygons let a GPU transform, by their order.");
  settings how;
  bool quick = false;
  app.add_option("SCENE", how.scene, "a glTF scene")->required();
  app.add_option("FILE", how.file, "a .pvs file of it")->required();
  app.add_option("--cells", how.cells, "cells that are counted, spread evenly")->check(CLI::Range(1u, 1u << 30));
  app.add_option("--cache", how.cache, "vertices that the cache holds")->check(CLI::Range(3, 1024));
  app.add_option("--json,--json-file", how.json, "where the result goes; without: standard output");
  app.add_flag("--quick", quick, "two cells");
  CLI11_PARSE(app, argc, argv);
  if (quick) how.cells = 2;
  try {
    const nlohmann::ordered_json result = run(how);
    if (how.json.empty()) {
      std::cout << result.dump(1) << '\n';
    } else if (std::ofstream out(how.json); !(out << result.dump(1) << '\n')) {
      throw std::runtime_error(how.json + ": cannot be written");
    }
  } catch (const std::exception& failure) {
    std::cerr << "bench_vertex_cache: " << failure.what() << '\n';
    return 1;
  }
  return 0;
}
