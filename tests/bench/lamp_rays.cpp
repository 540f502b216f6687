// Lamps (docs/lights.md) by brute force. `place` finds places for lamps in the streets of a scene. `check` casts rays
// from the lamps of a file and counts, for each, the polygons of its set, those that rays meet, and those that the set
// lacks: all of them, and without those that the visibility rules excuse. It also casts rays from the cells, and from
// what they meet to each lamp: which lamps light what is visible, beside those that the file says touch the cell.
#include <tbb/parallel_for.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/baked_scene.h"
#include "bound/ray_trial.h"
#include "file/light_sets.h"
#include "sightcell/base/random.h"
#include "sightcell/scene/scene.h"
#include "trace/light_reach.h"
#include "verify/each_cell.h"

namespace {

using namespace sightcell;
using bench::require;

constexpr float least_height = 3.0f, most_height = 5.0f;  // meters above what is below
constexpr float clearance = 0.25f;                        // meters
constexpr int headings = 16, least_walled = 8;            // a street has walls around it
constexpr float wall_distance = 40.0f;                    // meters
constexpr std::uint64_t rays_of_chunk = 4096;

struct lamp_options {
  std::filesystem::path scene, file;
  std::vector<float> within;  // corners of a box, meters
  std::uint32_t count = 50;
  std::uint64_t seed = 1, rays = 1'000'000, cell_rays = 1'000'000;
};

bool is_in_street(const bake::ray_scene& rays, const glm::vec3& at) {
  bake::sight seen;
  int walled = 0;
  for (int i = 0; i < headings; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / headings;
    rays.trace(at, glm::vec3(std::sin(angle), 0.0, std::cos(angle)), seen);
    walled += seen.distance < wall_distance ? 1 : 0;
  }
  return walled >= least_walled;
}

nlohmann::ordered_json place(const lamp_options& how) {
  const scene::scene s = scene::load_gltf(how.scene);
  const scene::world_geometry geometry = scene::flatten(s);
  const bake::ray_scene rays(geometry, false);
  const glm::vec3 low(how.within[0], how.within[1], how.within[2]), high(how.within[3], how.within[4], how.within[5]);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  bake::random_stream random(how.seed, 0, bake::purpose::light_verify, 0, 0);
  bake::sight below;
  for (std::uint64_t tries = 0; list.size() < how.count && tries < 100'000'000; ++tries) {
    const glm::vec3 at = random.in_box(low, high);
    rays.trace(at, {0, -1, 0}, below);
    if (!(below.distance >= least_height && below.distance <= most_height)) continue;
    if (!rays.is_valid(at, clearance) || !is_in_street(rays, at)) continue;
    list.push_back({{"position", {at.x, at.y, at.z}}, {"floor", at.y - below.distance}});
  }
  return list;
}

class lamp_check {
 public:
  explicit lamp_check(const lamp_options& how) : how_(how), baked_(how.scene, how.file) {
    require(lights_.open(opened_.file()));
  }

  nlohmann::ordered_json run() {
    nlohmann::ordered_json lamps = nlohmann::ordered_json::array(), cells = nlohmann::ordered_json::array();
    for (std::uint32_t number = 0; number < lights_.table().light_count(); ++number) lamps.push_back(row_of(number));
    for (std::uint32_t cell = 0; cell < opened_.file().cell_count(); ++cell) cells.push_back(row_of_cell(cell));
    return {{"lamps", std::move(lamps)}, {"cells", std::move(cells)}};
  }

 private:
  struct chunk_result {
    std::vector<std::uint32_t> found, missing;  // polygons, some of them twice
    std::uint64_t reaching = 0, misses = 0;
  };

  nlohmann::ordered_json row_of(std::uint32_t number) {
    format::light_record record;
    format::certificate_record proof;
    require(lights_.table().light(number, record));
    require(lights_.table().sets().certificate(number, number, proof));
    const scene::light light = bake::light_of(record);
    std::vector<std::uint32_t> set;
    require(lights_.source_ids(number, set));
    std::vector<std::uint8_t> in(opened_.rays().geometry().kinds.size(), 0);
    for (const std::uint32_t polygon : set) in[polygon] = 1;
    std::vector<chunk_result> chunks((how_.rays + rays_of_chunk - 1) / rays_of_chunk);
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
      const std::uint64_t size = std::min(rays_of_chunk, how_.rays - i * rays_of_chunk);
      cast(light, in, size, bake::random_stream(how_.seed, number, bake::purpose::light_verify, 1, i), chunks[i]);
    });
    std::vector<std::uint8_t> found(in.size(), 0), missing(in.size(), 0);
    std::uint64_t reaching = 0, misses = 0;
    for (const chunk_result& one : chunks) {
      for (const std::uint32_t polygon : one.found) found[polygon] = 1;
      for (const std::uint32_t polygon : one.missing) missing[polygon] = 1;
      reaching += one.reaching, misses += one.misses;
    }
    std::uint64_t lacking = 0;
    for (std::size_t polygon = 0; polygon < in.size(); ++polygon) lacking += found[polygon] != 0 && in[polygon] == 0;
    const auto count = [](const std::vector<std::uint8_t>& marks) { return std::count(marks.begin(), marks.end(), 1); };
    std::uint32_t cells = 0;
    for (std::uint32_t cell = 0; cell < opened_.file().cell_count(); ++cell)
      cells += lights_.table().touches(cell, number) ? 1 : 0;
    return {{"lamp", number},
            {"kind", record.cone == 0.0f ? "point" : "spot"},
            {"range", record.range},
            {"in_set", set.size()},
            {"found", count(found)},
            {"not_in_set", lacking},
            {"missed", count(missing)},
            {"rays", how_.rays},
            {"rays_in_reach", reaching},
            {"misses", misses},
            {"error_bound", proof.upper_bound},
            {"bake_rays", proof.rays},
            {"cells_touched", cells}};
  }

  // By lamp: points that are visible from a cell and that the lamp lights.
  struct cell_part {
    std::uint64_t rays = 0;
    std::vector<std::uint64_t> lit;
  };

  nlohmann::ordered_json row_of_cell(std::uint32_t cell) {
    std::vector<scene::light> lamps;
    format::light_record record;
    for (std::uint32_t number = 0; number < lights_.table().light_count(); ++number) {
      require(lights_.table().light(number, record));
      lamps.push_back(bake::light_of(record));
    }
    const std::vector<cell_part> parts = bake::cast_lines<cell_part>(
        opened_, how_.seed, cell, how_.cell_rays,
        [&](const bake::sight_line& line, cell_part& part) { light_up(lamps, line, part); });
    std::vector<std::uint64_t> lit(lamps.size());
    std::uint64_t rays = 0, points = 0, points_missed = 0, found = 0, missed = 0, touched = 0;
    for (const cell_part& part : parts) {
      rays += part.rays;
      for (std::size_t lamp = 0; lamp < part.lit.size(); ++lamp) lit[lamp] += part.lit[lamp];
    }
    for (std::uint32_t lamp = 0; lamp < lamps.size(); ++lamp) {
      const bool listed = lights_.table().touches(cell, lamp);
      touched += listed ? 1 : 0, found += lit[lamp] > 0 ? 1 : 0, points += lit[lamp];
      if (!listed && lit[lamp] > 0) ++missed, points_missed += lit[lamp];
    }
    return {{"cell", cell},     {"rays", rays},         {"lamps_touching", touched},         {"lamps_found", found},
            {"missed", missed}, {"lit_points", points}, {"lit_points_missed", points_missed}};
  }

  void light_up(const std::vector<scene::light>& lamps, const bake::sight_line& line, cell_part& part) const {
    part.lit.resize(lamps.size());
    bake::sight seen, from_lamp;
    opened_.rays().trace(line.eye, line.direction, seen);
    if (seen.front == bake::no_polygon) return;
    const glm::vec3 point = line.eye + line.direction * seen.distance;
    for (std::size_t lamp = 0; lamp < lamps.size(); ++lamp) {
      if (!bake::is_in_reach(lamps[lamp], point)) continue;
      const glm::vec3 from = bake::position_of(lamps[lamp]), way = point - from;
      const float distance = glm::length(way);
      if (!(distance > 0.0f)) continue;
      opened_.rays().trace(from, way / distance, from_lamp);
      if (from_lamp.front == seen.front) ++part.lit[lamp];
    }
  }

  void cast(const scene::light& light, const std::vector<std::uint8_t>& in, std::uint64_t rays,
            bake::random_stream random, chunk_result& out) const {
    const bake::visibility_rules rules{.smallest_gap = opened_.rules().smallest_gap};
    const std::function<bool(std::uint32_t)> contains = [&in](std::uint32_t polygon) { return in[polygon] != 0; };
    bake::ray_trial trial(opened_.rays(), rules, contains);
    std::vector<bake::missed_polygon> lacking;
    std::vector<std::uint8_t> seen_before(in.size(), 0);
    bake::sight seen;
    for (std::uint64_t i = 0; i < rays; ++i) {
      const bake::sight_line line{bake::position_of(light), random.on_sphere()};
      opened_.rays().trace(line.eye, line.direction, seen);
      bool reaching = false;
      const auto note = [&](std::uint32_t polygon, float distance) {
        if (!bake::is_in_reach(light, line.eye + line.direction * distance)) return;
        reaching = true;
        if (seen_before[polygon] != 0) return;
        seen_before[polygon] = 1;
        out.found.push_back(polygon);
      };
      if (seen.front != bake::no_polygon) note(seen.front, seen.distance);
      for (const bake::passed_polygon& passed : seen.before) note(passed.polygon, passed.distance);
      out.reaching += reaching ? 1 : 0;
      lacking.clear();
      if (!reaching || !trial.test(line, seen, random, lacking)) continue;
      std::erase_if(lacking, [&](const bake::missed_polygon& one) {
        return !one.counts || !bake::is_in_reach(light, one.eye + one.direction * one.distance);
      });
      out.misses += lacking.empty() ? 0 : 1;
      for (const bake::missed_polygon& one : lacking) out.missing.push_back(one.polygon);
    }
  }

  lamp_options how_;
  bench::baked_scene baked_;
  bake::verified_file& opened_ = baked_.opened;
  bake::light_set_reader lights_;
};

}  // namespace

int main(int argc, char** argv) {
  lamp_options how;
  CLI::App program{"Lamps by brute force."};
  program.require_subcommand(1);
  CLI::App* placing = program.add_subcommand("place", "Finds places for lamps in streets.");
  placing->add_option("SCENE", how.scene)->required();
  placing->add_option("--within", how.within, "x0,y0,z0,x1,y1,z1 in meters.")->delimiter(',')->expected(6)->required();
  placing->add_option("--count", how.count);
  placing->add_option("--seed", how.seed);
  CLI::App* checking = program.add_subcommand("check", "Casts rays from the lamps of a file.");
  checking->add_option("SCENE", how.scene)->required();
  checking->add_option("FILE", how.file)->required();
  checking->add_option("--rays", how.rays, "Per lamp.")->check(CLI::Range(1u, 1u << 30));
  checking->add_option("--cell-rays", how.cell_rays, "Per cell.")->check(CLI::Range(1u, 1u << 30));
  checking->add_option("--seed", how.seed);
  CLI11_PARSE(program, argc, argv);
  try {
    std::printf("%s\n", (placing->parsed() ? place(how) : lamp_check(how).run()).dump().c_str());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "lamp_rays: %s\n", e.what());
    return 1;
  }
  return 0;
}
