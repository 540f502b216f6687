#include "golden_contents.h"

#include <algorithm>
#include <cstdlib>

#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/grid_boxes.h"
#include "unit/format/cluster_samples.h"
#include "unit/format/viewpoint_samples.h"

namespace sightcell::test {
namespace {

// Steps of seven around a circle.
std::vector<std::uint32_t> stepping_order(std::uint32_t polygons) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < polygons; ++i) order.push_back(7 * i % polygons);
  return order;
}

// What nearly all cells of small_contents() see comes first, so that runs get long; the others come last to first.
std::vector<std::uint32_t> gathered_order(std::uint32_t polygons) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < polygons; ++i) {
    if (i % 12 < 5) order.push_back(i);
  }
  for (std::uint32_t i = polygons; i-- > 0;) {
    if (i % 12 >= 5) order.push_back(i);
  }
  return order;
}

// What the contents with cells on a lattice have in common.
sample_contents forty_polygons() {
  sample_contents contents;
  contents.facts.polygon_count = 40;
  contents.facts.margin = 0.125f;
  contents.facts.slack = 0.0625f;
  for (std::uint8_t i = 0; i < 16; ++i) contents.facts.scene_fingerprint[i] = static_cast<std::uint8_t>(0xF0 - i);
  contents.draws = {{.node = 1, .polygon_count = 20},
                    {.node = 2, .first_source = 20, .polygon_count = 20, .first_stored = 20, .base_vertex = 24}};
  return contents;
}

// Adds a cell for each place. sees(place, polygon): whether the cell there sees the polygon.
template <class Place, class Sees>
void add_cells_at(sample_contents& contents, const format::lattice_shape& shape, const std::vector<Place>& places,
                  const Sees& sees) {
  for (const Place& place : places) {
    contents.cells.push_back(format::box_of(shape, place));
    std::vector<std::uint32_t>& set = contents.sets.emplace_back();
    for (std::int32_t polygon = 0; polygon < 40; ++polygon) {
      if (sees(place, polygon)) set.push_back(static_cast<std::uint32_t>(polygon));
    }
  }
}

// Adds the cells of a column that is `width` steps wide, or of its quarters, which are divided likewise. Some cells
// contain one of a step in a corner, because the tests look for a cell at its center.
void add_column(std::int32_t x, std::int32_t z, std::uint32_t width, std::vector<format::grid_box>& places) {
  const auto steps = static_cast<std::int32_t>(width);
  const std::int32_t turn = 5 * (x / steps) + 3 * (z / steps) + steps;
  if (width > 1 && turn % 3 == 0) {
    for (std::int32_t part = 0; part < 4; ++part)
      add_column(x + part % 2 * steps / 2, z + part / 2 * steps / 2, width / 2, places);
    return;
  }
  const auto height = static_cast<std::uint32_t>(4 + (turn & 3));
  places.push_back({x, turn % 5 - 7, z, width, height, width});
  if (turn % 2 == 0) places.push_back({x, 3, z, width, 2 * height, width});
  if (width == 4 && turn % 5 == 1) places.push_back({x, turn % 5 - 7, z, 1, 1, 1});
}

}  // namespace

sample_contents ordered_contents() {
  sample_contents contents = small_contents();
  const format::draw_record first = contents.draws[0];
  const format::draw_record none = contents.draws[1];
  format::draw_record instance = contents.draws[2];
  instance.polygon_count = 90;
  format::draw_record other_instance = instance;
  other_instance.instance = 10;
  other_instance.first_source = 210;
  other_instance.base_vertex = 500;
  other_instance.host_tag = 78;
  contents.draws = {other_instance, first, none, instance};
  std::uint32_t next = 0;
  for (format::draw_record& d : contents.draws) {
    d.first_stored = next;
    next += d.polygon_count;
  }
  contents.orders = {stepping_order(90), gathered_order(120), {}};
  contents.order_of_draw = {0, 1, 2, 0};
  return contents;
}

sample_contents lattice_contents() {
  sample_contents contents = forty_polygons();
  contents.lattice = format::lattice_shape{0.75, 1.5};
  for (std::int32_t z = -4; z <= 4; ++z) {
    for (std::int32_t x = -5; x <= 3; ++x) {
      // One cell is cut into eight.
      for (std::int32_t part = 0; part < 8 && x == 1 && z == -2; ++part) {
        contents.places.push_back({2 * x + part % 2, -2 + part / 4, 2 * z + part / 2 % 2, 1});
      }
      if (x != 1 || z != -2) contents.places.push_back({x, -1, z, 0});
    }
  }
  std::sort(contents.places.begin(), contents.places.end(), format::lattice_comes_before);
  const auto sees = [](const format::lattice_place& place, std::int32_t polygon) {
    const std::int32_t far = 4 * (1 - static_cast<std::int32_t>(place.level)) + 3;
    return std::abs(polygon - 20 - 3 * place.x) <= far || (polygon + place.z) % 13 == 0;
  };
  add_cells_at(contents, *contents.lattice, contents.places, sees);
  return contents;
}

// No size is a float, so that every border is rounded.
sample_contents grid_contents() {
  sample_contents contents = forty_polygons();
  contents.grid = format::lattice_shape{0.7, 0.0875};
  for (std::int32_t z = -16; z < 12; z += 4)
    for (std::int32_t x = -12; x < 16; x += 4) add_column(x, z, 4, contents.grid_places);
  const auto sees = [](const format::grid_box& place, std::int32_t polygon) {
    const auto width = static_cast<std::int32_t>(place.steps_x);
    return std::abs(polygon - 20 - place.x) <= width + 3 || (polygon + place.z + 5 * place.y) % 13 == 0;
  };
  add_cells_at(contents, *contents.grid, contents.grid_places, sees);
  return contents;
}

sample_contents merged_contents() {
  sample_contents contents = small_contents();
  contents.facts.layout = format::host_layout::merged;
  // Group 0: two draws and an empty one between them; 1: one that moves; 2: two draws.
  contents.draws = {
      {.node = 6, .mesh = 1, .material = 1, .first_source = 50, .polygon_count = 70, .base_vertex = 90},
      {.node = 7, .mesh = 2, .material = 1, .first_source = 120, .base_vertex = 200},
      {.node = 9,
       .mesh = 4,
       .material = 1,
       .first_source = 260,
       .polygon_count = 40,
       .base_vertex = 420,
       .host_tag = 7},
      {.node = 8, .mesh = 3, .material = 1, .first_source = 200, .polygon_count = 60, .base_vertex = 333, .flags = 1},
      {.node = 5, .mesh = 0, .material = 0xFFFFFFFFu, .polygon_count = 50},
      {.node = 5,
       .mesh = 0,
       .primitive = 2,
       .material = 0xFFFFFFFFu,
       .first_source = 120,
       .polygon_count = 80,
       .base_vertex = 200}};
  contents.order_of_draw = {0, 0, 0, 1, 2, 2};
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < contents.draws.size(); ++i) {
    contents.draws[i].group = contents.order_of_draw[i];
    contents.draws[i].first_stored = next;
    next += contents.draws[i].polygon_count;
  }
  contents.orders = {gathered_order(110), stepping_order(60), stepping_order(130)};
  return contents;
}

// Row by row, forwards and backwards in turn. One cell sees no polygon, and one sees all, as they do volumes.
sample_contents volume_contents() {
  sample_contents contents = ordered_contents();
  contents.facts.slack = 0.03125f;
  contents.volume_shape = {1.25, 2.5};
  for (std::int32_t row = 0; row < 10; ++row) {
    for (std::int32_t i = 0; i < 6; ++i) {
      contents.volumes.push_back({(row % 2 == 0 ? i : 5 - i) - 3, row / 5 - 1, row % 5 - 2, 0});
    }
  }
  for (std::uint32_t cell = 0; cell < contents.sets.size(); ++cell) {
    for (std::uint32_t volume = 0; volume < contents.volumes.size(); ++volume) {
      const bool seen = volume / 7 % 9 == cell % 9 || (volume + cell / 8) % 20 < 9;
      if (cell == 12 || (cell != 11 && seen)) contents.sets[cell].push_back(300 + volume);
    }
  }
  return contents;
}

// A door of three draws, one of which is empty, and a switch of two: each is a draw group. A name may have no draw.
sample_contents named_contents() {
  sample_contents contents = merged_contents();
  contents.named_groups = {"Schalter \xC3\xBC", "nothing", "door"};
  for (format::draw_record& d : contents.draws) {
    if (d.group != 1) d.named_group = d.group == 0 ? 2 : 0;
  }
  return contents;
}

sample_contents viewpoint_contents() {
  sample_contents contents = lattice_contents();
  add_viewpoints(contents, 7);
  return contents;
}

// Cells with no eye and up to as many as there may be; eyes at both ends of a box. All regions are whole boxes.
sample_contents eye_contents() {
  sample_contents contents = lattice_contents();
  contents.player_radius = 0.125f;
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell)
    contents.viewpoints.push_back({.cell = cell, .valid_share = 0.75f, .region = {}});
  add_eyes(contents, 9);
  return contents;
}

// Two draws of one geometry, an empty draw, a node and meshes without names, a name of a node and a mesh.
sample_contents identity_contents() {
  sample_contents contents = merged_contents();
  constexpr std::uint64_t shared = 0x0123456789ABCDEFu;
  contents.geometry_hashes = {shared, 0xFEDCBA9876543210u, 1, std::uint64_t{1} << 63, shared};
  contents.node_names = {"", "", "", "", "", "", "Cube.001", "Cube.0015", "T\xC3\xBCr", "Cube"};
  contents.mesh_names = {"Cube", "", "Cube.001", "Cube.00"};
  return contents;
}

// Two instances that share clusters, an empty draw, volumes, and clusters of one polygon up to the most.
sample_contents cluster_contents() {
  sample_contents contents = volume_contents();
  put_in_clusters(contents, 11, 24);
  return contents;
}

sample_contents merged_cluster_contents() {
  sample_contents contents = named_contents();
  put_in_clusters(contents, 13, 40);
  return contents;
}

std::vector<golden_file_contents> golden_files() {
  return {{"v1_tiny", tiny_contents()},
          {"v1_small", ordered_contents()},
          {"v1_lattice", lattice_contents()},
          {"v1_merged", merged_contents()},
          {"v1_volumes", volume_contents()},
          {"v1_groups", named_contents()},
          {"v1_viewpoints", viewpoint_contents()},
          {"v1_grid", grid_contents()},
          {"v1_eyes", eye_contents()},
          {"v1_identity", identity_contents()},
          {"v1_clusters", cluster_contents()},
          {"v1_merged_clusters", merged_cluster_contents()}};
}

}  // namespace sightcell::test
