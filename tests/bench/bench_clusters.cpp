// bench_clusters SCENE FILE.pvs [--cells N] [--json OUT.json]: the clusters that a bake makes of the meshes of a scene,
// each instance with clusters of its own, and how many of them a set has; or, for a file of clusters, those of the
// file. Mean over cells: polygons in the set, clusters with any of them, polygons in these clusters, words of the row
// that change on the way to the next cell. Microseconds: the median over cells of the medians of repeated calls.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/runtime_frames/frame_timing.h"
#include "sightcell/scene/clusters.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"
#include "unit/runtime/held_memory.h"

namespace {

using namespace sightcell;
using bench::median_of;
using bench::time_of;

struct options {
  std::string scene, file, json;
  std::uint32_t cells = 200;  // at most, spread evenly
  unsigned repeat = 31;
};

void require(sightcell_status s, const std::string& what) {
  if (s != SIGHTCELL_OK) throw std::runtime_error(what + ": " + sightcell_status_text(s));
}

// The clusters of all polygons of a scene.
struct scene_clusters {
  std::vector<std::uint32_t> of_source;
  std::vector<std::uint32_t> polygons;  // by cluster
};

scene_clusters clusters_of(const scene::scene& from) {
  scene_clusters all;
  all.of_source.resize(from.polygon_count, SIGHTCELL_NO_CLUSTER);
  std::vector<scene::mesh_clusters> of_mesh(from.geometries.size());
  for (const scene::draw& d : from.draws) {
    scene::mesh_clusters& mesh = of_mesh[d.geometry];
    if (mesh.count == 0) mesh = scene::clusters_of(from.geometries[d.geometry]);
    const auto base = static_cast<std::uint32_t>(all.polygons.size());
    all.polygons.resize(all.polygons.size() + mesh.count);
    for (std::uint32_t t = 0; t < d.polygon_count; ++t) {
      all.of_source[d.first_source + t] = base + mesh.of_triangle[t];
      ++all.polygons[base + mesh.of_triangle[t]];
    }
  }
  return all;
}

struct sums {
  std::uint64_t cells = 0, polygons = 0, ranges = 0, clusters = 0, drawn = 0, changed_words = 0;
  std::uint64_t most_polygons = 0;
  std::vector<double> move_us, bits_us, list_us, changes_us;
  double most_bits_us = 0.0;
};

// The clusters of a file of clusters; none for other files.
scene_clusters clusters_of(const db& file) {
  scene_clusters all;
  const std::uint32_t clusters = sightcell_db_cluster_count(file.get());
  std::vector<sightcell_range> ranges(clusters);
  std::size_t count = 0;
  require(sightcell_db_clusters(file.get(), ranges.data(), clusters, &count), "clusters of the file");
  for (const sightcell_range& r : ranges) all.polygons.push_back(r.count);
  return all;
}

cluster_map make_map(const db& file, const scene_clusters& clusters) {
  auto made = clusters.of_source.empty() && !clusters.polygons.empty()
                  ? cluster_map::of_file(file)
                  : cluster_map::create(file, clusters.of_source, static_cast<std::uint32_t>(clusters.polygons.size()));
  require(made.status(), "clusters");
  return std::move(*made);
}

class cluster_timer {
 public:
  cluster_timer(const db& file, const scene_clusters& clusters, cluster_map map, unsigned repeat)
      : file_(file), clusters_(clusters), repeat_(repeat), map_(std::move(map)) {
    auto camera = view::create(file);
    require(camera.status(), "view");
    view_ = std::move(*camera);
    row_.resize((clusters.polygons.size() + 31) / 32);
    before_.resize(row_.size());
    words_.resize(row_.size());
    list_.resize(clusters.polygons.size());
  }

  void add(std::uint32_t cell, sums& to) {
    const auto box = file_.cell_box(cell);
    require(box.status(), "cell");
    std::array<float, 3> eye{}, away{-1e9f, -1e9f, -1e9f};
    for (std::size_t k = 0; k < 3; ++k) eye[k] = 0.5f * (box->min[k] + box->max[k]);
    sightcell_frame frame;
    to.move_us.push_back(median([&] { static_cast<void>(view_.move(away, frame)); },
                                [&] { static_cast<void>(view_.move(eye, frame)); }));
    std::swap(row_, before_);
    const double bits_us = median([] {}, [&] { require(view_.clusters(map_, row_), "bits"); });
    list_result list, changes;
    to.list_us.push_back(median([] {}, [&] { list = cluster_map::list(row_, list_); }));
    to.changes_us.push_back(median([] {}, [&] { changes = cluster_map::changes(before_, row_, words_); }));
    to.bits_us.push_back(bits_us);
    to.most_bits_us = std::max(to.most_bits_us, bits_us);
    ++to.cells;
    to.polygons += frame.polygon_count;
    to.most_polygons = std::max<std::uint64_t>(to.most_polygons, frame.polygon_count);
    to.ranges += view_.ranges({}).count;
    to.clusters += list.count;
    to.changed_words += changes.count;
    for (const std::uint32_t c : std::span(list_).first(list.count)) to.drawn += clusters_.polygons[c];
  }

  // Of the row with everything in it.
  double all_us() {
    const std::array<float, 3> away{-1e9f, -1e9f, -1e9f};
    sightcell_frame frame;
    static_cast<void>(view_.move(away, frame));
    return median([] {}, [&] { require(view_.clusters(map_, row_), "bits"); });
  }

 private:
  template <class Before, class Work>
  double median(const Before& before, const Work& work) {
    std::vector<double> passes;
    for (unsigned i = 0; i < repeat_; ++i) {
      before();
      passes.push_back(time_of(work));
    }
    return median_of(passes) / 1000.0;
  }

  const db& file_;
  const scene_clusters& clusters_;
  const unsigned repeat_;
  cluster_map map_;
  view view_;
  std::vector<std::uint32_t> row_, before_, list_;
  std::vector<sightcell_cluster_word> words_;
};

nlohmann::ordered_json run(const options& how) {
  test::held_memory memory;
  auto opened = db::open_file(how.file.c_str(), &memory.interface);
  require(opened.status(), how.file);
  const db file = std::move(*opened);
  const scene::scene from = scene::load_gltf(how.scene);
  require(file.same_scene(from.fingerprint), how.file);
  const scene_clusters of_file = clusters_of(file);
  const scene_clusters clusters = of_file.polygons.empty() ? clusters_of(from) : of_file;
  const std::size_t before = memory.bytes;
  cluster_map map = make_map(file, clusters);
  const std::size_t map_bytes = memory.bytes - before;
  cluster_timer timer(file, clusters, std::move(map), how.repeat);
  sums all;
  const std::uint32_t cells = std::min(how.cells, file.cell_count());
  for (std::uint32_t i = 0; i < cells; ++i) {
    timer.add(static_cast<std::uint32_t>(std::uint64_t{i} * file.cell_count() / cells), all);
  }
  const auto mean = [&](std::uint64_t sum) { return static_cast<double>(sum) / static_cast<double>(all.cells); };
  return {
      {"polygons", from.polygon_count},
      {"of_file", !of_file.polygons.empty()},
      {"clusters", clusters.polygons.size()},
      {"polygons_per_cluster", static_cast<double>(from.polygon_count) / static_cast<double>(clusters.polygons.size())},
      {"map_bytes_per_polygon", static_cast<double>(map_bytes) / std::max(from.polygon_count, 1u)},
      {"cells", all.cells},
      {"polygons_in_set", mean(all.polygons)},
      {"most_polygons_in_set", all.most_polygons},
      {"ranges_in_set", mean(all.ranges)},
      {"clusters_in_set", mean(all.clusters)},
      {"polygons_in_clusters", mean(all.drawn)},
      {"drawn_by_set", static_cast<double>(all.drawn) / static_cast<double>(std::max<std::uint64_t>(all.polygons, 1))},
      {"changed_words", mean(all.changed_words)},
      {"move_us", median_of(all.move_us)},
      {"bits_us", median_of(all.bits_us)},
      {"most_bits_us", all.most_bits_us},
      {"all_bits_us", timer.all_us()},
      {"list_us", median_of(all.list_us)},
      {"changes_us", median_of(all.changes_us)}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Clusters of a host in the sets of a file.");
  options how;
  bool quick = false;
  app.add_option("SCENE", how.scene, "a glTF scene")->required();
  app.add_option("FILE", how.file, "a .pvs file of it")->required();
  app.add_option("--cells", how.cells, "cells, spread evenly")->check(CLI::Range(1u, 1u << 30));
  app.add_option("--repeat", how.repeat, "of each call, of which the median counts")->check(CLI::Range(1u, 10000u));
  app.add_option("--json,--json-file", how.json, "where the result goes; without: standard output");
  app.add_flag("--quick", quick, "two cells, few repeats");
  CLI11_PARSE(app, argc, argv);
  if (quick) {
    how.cells = 2;
    how.repeat = 3;
  }
  try {
    const nlohmann::ordered_json result = run(how);
    if (how.json.empty()) {
      std::cout << result.dump(1) << '\n';
    } else if (std::ofstream out(how.json); !(out << result.dump(1) << '\n')) {
      throw std::runtime_error(how.json + ": cannot be written");
    }
  } catch (const std::exception& failure) {
    std::cerr << "bench_clusters: " << failure.what() << '\n';
    return 1;
  }
  return 0;
}
