#include "sightcell/format/file_parts.h"

#include <bit>
#include <span>
#include <string_view>
#include <utility>

#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/eye_table.h"
#include "sightcell/format/identity_table.h"

namespace sightcell::format {
namespace {

status read_orders(const reader& file, file_parts& out) {
  std::vector<std::uint32_t> all(file.order_begin(file.order_count()));
  if (const status s = file.orders(all); s != status::ok) return s;
  for (std::uint32_t number = 0; number < file.order_count(); ++number) {
    const std::uint32_t begin = file.order_begin(number);
    const std::uint32_t end = file.order_begin(number + 1);
    if (begin > end || end > all.size()) return status::corrupt;
    out.orders.emplace_back(all.begin() + begin, all.begin() + end);
  }
  const cluster_table& clusters = file.clusters();
  for (std::uint32_t number = 0; clusters.exists() && number < file.order_count(); ++number) {
    std::vector<std::uint32_t>& sizes = out.clusters.emplace_back();
    for (std::uint32_t i = 0; i < clusters.clusters_of(number); ++i) {
      sizes.push_back(clusters.polygons(clusters.first_cluster(number) + i));
    }
  }
  return status::ok;
}

status read_viewpoints(const reader& file, file_parts& out) {
  const viewpoint_table& table = file.viewpoints();
  out.player_radius = table.player_radius();
  if (!table.exists()) return status::ok;
  eye_table eyes;
  if (const status s = eye_table::open(file, eyes); s != status::ok && s != status::absent) return s;
  out.viewpoints.resize(file.cell_count());
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    const box grown = grown_box(out.cells[cell], out.facts.margin);
    if (const status s = table.parts(cell, grown, [](const region_part&) {}); s != status::ok) return s;
    const std::span<const std::byte> region = table.region_bytes(cell);
    viewpoint_record& v = out.viewpoints[cell];
    v.cell = cell;
    v.valid_share = table.valid_share(cell);
    v.outside_share = static_cast<double>(table.outside_share(cell));
    v.region.assign(region.begin(), region.end());
    v.eyes.resize(eyes.count(cell));
    for (std::uint32_t number = 0; number < v.eyes.size(); ++number) {
      if (const status s = eyes.eye(cell, number, v.eyes[number]); s != status::ok) return s;
    }
  }
  return status::ok;
}

void read_names(const std::vector<std::string>& names, std::uint32_t name, std::uint32_t number,
                std::vector<std::string>& out) {
  if (name == 0) return;
  if (number >= out.size()) out.resize(std::size_t{number} + 1);
  out[number] = names[name - 1];
}

// After the draws.
status read_identity(const reader& file, file_parts& out) {
  identity_table table;
  const status opened = identity_table::open(file, table);
  if (opened != status::ok) return opened == status::absent ? status::ok : opened;
  for (std::uint32_t place = 0; place < table.draw_count(); ++place) out.geometry_hashes.push_back(table.hash(place));
  std::vector<std::string> names;
  for (name_walk walk = table.names(); walk.next();) names.emplace_back(walk.name());
  if (names.size() != table.name_count()) return status::corrupt;
  for (const draw_record& d : out.draws) {
    read_names(names, table.name_of_node(d.node), d.node, out.node_names);
    read_names(names, table.name_of_mesh(d.mesh), d.mesh, out.mesh_names);
  }
  return status::ok;
}

std::vector<lattice_place> places_of(const cell_lattice& lattice) {
  std::vector<lattice_place> places;
  for (std::uint32_t number = 0; number < lattice.chunk_count(); ++number) {
    const lattice_chunk chunk = lattice.chunk(number);
    for (std::uint64_t left = chunk.mask; left != 0; left &= left - 1)
      places.push_back(place_of(chunk, static_cast<unsigned>(std::countr_zero(left))));
  }
  return places;
}

}  // namespace

file_contents file_parts::contents(cell_set_source sets) const {
  file_contents all;
  all.facts = facts;
  all.draws = draws;
  all.named_groups = named_groups;
  all.order = {order_of_draw, orders, clusters};
  if (lattice)
    all.lattice = lattice_cells{*lattice, places};
  else if (grid)
    all.grid = grid_cells{*grid, grid_places};
  else
    all.cells = cells;
  all.volumes = {volume_shape, volumes};
  all.cell_sets = std::move(sets);
  all.certificate = certificate;
  all.viewpoints = viewpoints;
  all.player_radius = player_radius;
  all.geometry_hashes = geometry_hashes;
  all.node_names = node_names;
  all.mesh_names = mesh_names;
  all.settings = settings;
  all.chunk_bytes = chunk_bytes;
  return all;
}

status take_apart(const reader& file, file_parts& out) {
  file_parts parts;
  parts.facts = file.facts();
  parts.draws.resize(file.draw_count());
  for (std::uint32_t i = 0; i < file.draw_count(); ++i) {
    if (const status s = file.draw(i, parts.draws[i]); s != status::ok) return s;
    parts.order_of_draw.push_back(file.order_of_draw(i));
  }
  for (std::uint32_t i = 0; i < file.named_groups().count(); ++i) {
    std::string_view name;
    if (!file.named_groups().name(i, name)) return status::corrupt;
    parts.named_groups.emplace_back(name);
  }
  if (const status s = read_orders(file, parts); s != status::ok) return s;
  parts.cells.resize(file.cell_count());
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    if (const status s = file.cell_box(cell, parts.cells[cell]); s != status::ok) return s;
  }
  if (file.lattice() != nullptr) {
    parts.lattice = file.lattice()->shape();
    parts.places = places_of(*file.lattice());
    if (parts.places.size() != parts.cells.size()) return status::corrupt;
  }
  if (file.grid() != nullptr) {
    parts.grid = file.grid()->step();
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
      parts.grid_places.push_back(file.grid()->place(cell));
    }
  }
  parts.volume_shape = file.volumes().shape();
  parts.volumes.resize(file.volumes().count());
  for (std::uint32_t volume = 0; volume < parts.volumes.size(); ++volume) {
    if (!file.volumes().place(volume, parts.volumes[volume])) return status::corrupt;
  }
  parts.certificate.resize(file.certificate_count());
  for (std::uint32_t i = 0; i < file.certificate_count(); ++i) {
    if (const status s = file.certificate(i, parts.certificate[i]); s != status::ok) return s;
  }
  if (const status s = read_viewpoints(file, parts); s != status::ok) return s;
  if (const status s = read_identity(file, parts); s != status::ok) return s;
  parts.settings = file.settings();
  out = std::move(parts);
  return status::ok;
}

}  // namespace sightcell::format
