#include "order/file_order.h"

#include <optional>
#include <span>
#include <utility>

#include "order/find_lattice.h"

namespace sightcell::bake {
namespace {

template <class Item>
void permute(std::vector<Item>& items, std::span<const std::uint32_t> order) {
  std::vector<Item> permuted;
  permuted.reserve(items.size());
  for (const std::uint32_t i : order) permuted.push_back(std::move(items[i]));
  items = std::move(permuted);
}

}  // namespace

std::vector<std::uint32_t> order_cells(format::file_parts& parts) {
  std::optional<cells_on_lattice> found = find_lattice(parts.cells, parts.settings);
  if (!found) {
    put_on_grid(parts);
    return {};
  }
  permute(parts.cells, found->cells);
  if (!parts.certificate.empty()) permute(parts.certificate, found->cells);
  for (std::uint32_t i = 0; i < parts.certificate.size(); ++i) parts.certificate[i].cell = i;
  if (!parts.viewpoints.empty()) permute(parts.viewpoints, found->cells);
  for (std::uint32_t i = 0; i < parts.viewpoints.size(); ++i) parts.viewpoints[i].cell = i;
  parts.lattice = found->shape;
  parts.places = std::move(found->places);
  return std::move(found->cells);
}

void put_on_grid(format::file_parts& parts) {
  if (parts.lattice || parts.grid) return;
  std::optional<cells_on_grid> found = find_grid(parts.cells, parts.settings);
  if (!found) return;
  parts.grid = found->step;
  parts.grid_places = std::move(found->places);
}

void put(stored_draws stored, format::file_parts& parts) {
  parts.draws = std::move(stored.draws);
  parts.order_of_draw = std::move(stored.order_of_draw);
  parts.orders = std::move(stored.orders);
}

void order_polygons_of(format::file_parts& parts, polygon_order_kind kind, const set_source& set_of) {
  const auto cells = static_cast<std::uint32_t>(parts.cells.size());
  put(store_draws(parts.draws, parts.facts.layout, kind, cells, set_of), parts);
}

}  // namespace sightcell::bake
