#include "bench/samplers/ground.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "bench/hemicube/cache.h"
#include "sightcell/base/error.h"
#include "trace/viewpoints.h"

namespace sightcell::bench {
namespace {

constexpr std::uint64_t viewpoint_tries = 4096;  // as a bake has it

bool has_free_point(const bake::ray_scene& rays, const bake::view_cell& cell, float radius) {
  std::uint64_t tries = 0;
  bake::random_stream random(1, cell.place, bake::purpose::viewpoints);
  return !bake::draw_viewpoints(rays, {cell.min, cell.max}, radius, 1, viewpoint_tries, random, tries).empty();
}

}  // namespace

ground::ground(scene::scene from, std::vector<bake::view_cell> all, const seeing_rules& how, std::string content)
    : s(std::move(from)),
      geometry(scene::flatten(s)),
      rules(how),
      hash(std::move(content)),
      rays(geometry, false),
      duplicates(geometry, false),
      colors(s, geometry) {
  std::vector<std::uint8_t> free(all.size()), inside(all.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    free[i] = has_free_point(rays, all[i], rules.player_radius);
    const bake::box grown = bake::box{all[i].min, all[i].max}.grown(rules.margin);
    inside[i] = free[i] && !rays.touching(grown.min, grown.max).empty();
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::string name = all[i].name.empty() ? fmt::format("cell {}", i) : all[i].name;
    if (!free[i]) {
      left_out.push_back(std::move(name));
      continue;
    }
    cells.push_back(std::move(all[i]));
    names.push_back(std::move(name));
    geometry_inside.push_back(inside[i] != 0);
  }
}

std::size_t ground::cell_named(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw error(error_kind::wrong_use, "bench.no-cell", "the cell \"" + name + "\"",
                "is not there or has no free point", fmt::format("name one of: {}", fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

std::string ground::text_of(std::size_t cell) const {
  const bake::view_cell& c = cells[cell];
  std::string text = fmt::format("scene {} place {:016x} box", hash, c.place);
  for (const glm::vec3& corner : {c.min, c.max})
    for (int axis = 0; axis < 3; ++axis) text += fmt::format(" {:08x}", std::bit_cast<std::uint32_t>(corner[axis]));
  return text + fmt::format(" margin {} radius {} gap {}", rules.margin, rules.player_radius, rules.smallest_gap);
}

std::unique_ptr<ground> load_ground(const std::filesystem::path& file, const std::filesystem::path& cells,
                                    std::uint32_t limit, const seeing_rules& rules, std::string hash) {
  if (hash.empty()) hash = hash_of_file(file);
  scene::scene loaded = scene::load_gltf(file);
  bake::settings how;
  how.cell_limit = limit;
  if (!cells.empty()) how.cells_file = cells;
  bake::cell_list list = bake::make_cells(scene::flatten(loaded), how);
  say(fmt::format("{}: {} polygons, {}", file.filename().string(), loaded.polygon_count, list.how));
  auto made = std::make_unique<ground>(std::move(loaded), std::move(list.cells), rules, std::move(hash));
  if (!made->left_out.empty()) say(fmt::format("left out, without a free point: {}", fmt::join(made->left_out, ", ")));
  if (made->cells.empty())
    throw error(error_kind::bad_input, "bench.no-cell", file.string(), "has no cell with a free point",
                "name other cells");
  return made;
}

}  // namespace sightcell::bench
