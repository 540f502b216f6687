#include "baked_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/vector_relational.hpp>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>

#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace viewer {
namespace {

namespace scene = sightcell::scene;
using sightcell::error;
using sightcell::error_kind;

void require(sightcell_status status, const std::string& subject) {
  if (status == SIGHTCELL_OK) return;
  const bool bad_file = status >= SIGHTCELL_ERR_IO;
  throw error(bad_file ? error_kind::bad_input : error_kind::failed, "viewer.runtime", subject,
              sightcell_status_text(status), bad_file ? "bake the scene again" : "report this");
}

glm::vec3 vec3_of(const std::array<float, 3>& v) {
  return {v[0], v[1], v[2]};
}

void open_file(const scene::scene& s, const std::string& path, baked_scene& out) {
  auto opened = sightcell::db::open_file(path.c_str());
  require(opened.status(), path);
  const auto info = opened->info();
  require(info.status(), path);
  if (!std::equal(s.fingerprint.begin(), s.fingerprint.end(), info->scene_fingerprint) ||
      info->polygon_count != s.polygon_count || info->draw_count != s.draws.size()) {
    throw error(error_kind::bad_input, other_scene, path, "was baked from another scene than " + s.name,
                "bake this scene, or name the one it was baked from");
  }
  out.pvs_name = std::filesystem::path(path).filename().string();
  out.margin = info->margin;
  out.range_bound = info->range_bound;
  out.draws.resize(info->draw_count);
  require(opened->draws(out.draws).status, path);
  constexpr std::uint32_t merged = 1;
  if (info->layout == merged) out.draws = joined_groups(out.draws);
  for (std::uint32_t i = 0; i < opened->cell_count(); ++i) {
    const auto box = opened->cell_box(i);
    require(box.status(), path);
    const glm::vec3 min = vec3_of(box->min), max = vec3_of(box->max);
    const auto eye = opened->cell_eye(i);
    out.cells.push_back({min, max, {}, eye ? vec3_of(*eye) : 0.5f * (min + max)});
  }
  out.bounds.resize(out.cells.size());
  if (opened->error_bounds(out.bounds).status != SIGHTCELL_OK) out.bounds.clear();
  out.db = std::move(*opened);
}

void make_draws(const scene::scene& s, baked_scene& out) {
  for (const scene::draw& d : s.draws) {
    sightcell_draw made{};
    made.first_source = made.first_stored = d.first_source;
    made.polygon_count = d.polygon_count;
    made.material = d.material;
    out.draws.push_back(made);
  }
}

// Absent polygons become three times one corner: nothing is drawn, and every polygon keeps its place.
void blank_absent(const scene::world_geometry& world, std::vector<std::uint32_t>& indices) {
  for (std::size_t p = 0; p < world.kinds.size(); ++p) {
    if (world.kinds[p].absent) std::fill_n(indices.begin() + static_cast<std::ptrdiff_t>(3 * p), 3, 0u);
  }
}

std::vector<std::uint32_t> in_stored_order(std::vector<std::uint32_t> indices, const sightcell::db& db,
                                           const std::string& path) {
  std::vector<std::uint32_t> order(db.polygon_count());
  require(db.order(order).status, path);
  const auto in_place = [&] {
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      if (order[i] != i) return false;
    }
    return true;
  };
  if (in_place()) return indices;
  std::vector<std::uint32_t> stored(indices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) stored[3 * i + k] = indices[3 * std::size_t{order[i]} + k];
  }
  return stored;
}

// A .pvs file holds no names: they come from the cells file of the bake, by place. A bake may leave cells out.
void name_cells(const std::string& path, std::vector<cell>& cells) {
  const auto broken = [&](const std::string& cause) {
    return error(error_kind::bad_input, "viewer.cells", path, cause, "name the cells file of the bake");
  };
  std::ifstream in(path);
  if (!in) throw broken("cannot be read");
  const nlohmann::json text = scene::parse_json(std::string(std::istreambuf_iterator<char>(in), {}), false);
  if (!text.is_object() || !text.contains("cells") || !text["cells"].is_array()) throw broken("holds no cells");
  const auto corner = [&](const nlohmann::json& box, const char* key) {
    if (!box.is_object() || !box.contains(key) || !box[key].is_array() || box[key].size() != 3) {
      throw broken("has a cell without a box");
    }
    glm::vec3 v{0.0f};
    for (int i = 0; i < 3; ++i) {
      const nlohmann::json& number = box[key][static_cast<std::size_t>(i)];
      if (!number.is_number()) throw broken("has a cell without a box");
      v[i] = number.get<float>();
    }
    return v;
  };
  for (const nlohmann::json& named : text["cells"]) {
    const glm::vec3 min = corner(named, "min"), max = corner(named, "max");
    if (!named.contains("name") || !named["name"].is_string()) continue;
    for (cell& c : cells) {
      if (c.min == min && c.max == max) c.name = named["name"].get<std::string>();
    }
  }
}

}  // namespace

baked_scene open_baked(const scene::scene& s, const scene::world_geometry& world, const std::string& pvs_file,
                       const std::string& cells_file) {
  baked_scene out;
  out.scene_name = s.name;
  out.polygon_count = s.polygon_count;
  out.min = world.min;
  out.max = world.max;
  if (pvs_file.empty()) {
    make_draws(s, out);
  } else {
    open_file(s, pvs_file, out);
  }
  if (!cells_file.empty()) name_cells(cells_file, out.cells);
  out.stored_indices = world.indices;
  blank_absent(world, out.stored_indices);
  if (out.db) out.stored_indices = in_stored_order(std::move(out.stored_indices), *out.db, pvs_file);
  return out;
}

std::uint32_t cell_after(std::span<const cell> cells, std::uint32_t visited, std::uint32_t here, const glm::vec3& eye,
                         int steps) {
  const cell& last = cells[visited];
  const bool still_there = glm::all(glm::greaterThanEqual(eye, last.min)) && glm::all(glm::lessThan(eye, last.max));
  const std::int64_t from = still_there || here >= cells.size() ? visited : here;
  const auto count = static_cast<std::int64_t>(cells.size());
  return static_cast<std::uint32_t>(((from + steps) % count + count) % count);
}

std::vector<sightcell_draw> joined_groups(std::span<const sightcell_draw> draws) {
  std::vector<sightcell_draw> out;
  for (const sightcell_draw& d : draws) {
    if (d.group == out.size()) {
      out.push_back(d);
    } else {
      out.back().polygon_count += d.polygon_count;
    }
  }
  return out;
}

std::vector<sightcell_range> all_ranges(std::span<const sightcell_draw> draws) {
  std::vector<sightcell_range> out;
  for (std::uint32_t d = 0; d < draws.size(); ++d) {
    if (draws[d].polygon_count > 0) out.push_back({d, 0, draws[d].polygon_count});
  }
  return out;
}

std::string flags_text(std::uint32_t flags) {
  std::string text;
  const auto add = [&](std::uint32_t flag, const char* word) {
    if ((flags & flag) == 0) return;
    if (!text.empty()) text += ' ';
    text += word;
  };
  add(SIGHTCELL_FRAME_CHANGED, "CHANGED");
  add(SIGHTCELL_FRAME_DRAW_ALL, "DRAW_ALL");
  add(SIGHTCELL_FRAME_OUTSIDE, "OUTSIDE");
  add(SIGHTCELL_FRAME_PENDING, "PENDING");
  add(SIGHTCELL_FRAME_DAMAGED, "DAMAGED");
  return text.empty() ? "-" : text;
}

}  // namespace viewer
