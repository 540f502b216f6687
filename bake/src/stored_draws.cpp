#include "stored_draws.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "order/polygon_order.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t not_named = UINT32_MAX;

// Runs of ascending numbers.
void append_runs(std::span<const std::uint32_t> set, std::vector<format::run>& runs) {
  for (const std::uint32_t id : set) {
    if (!runs.empty() && runs.back().first + runs.back().count == id)
      ++runs.back().count;
    else
      runs.push_back({.first = id, .count = 1});
  }
}

}  // namespace

stored_draws store_draws(std::span<const format::draw_record> draws, polygon_order_kind kind, std::uint32_t cell_count,
                         const std::function<void(std::uint32_t cell, std::vector<std::uint32_t>& set)>& set_of) {
  std::vector<format::draw_record> source(draws.begin(), draws.end());
  // Draws without polygons begin where the next one does.
  const auto place = [](const format::draw_record& d) { return std::tuple(d.first_source, d.polygon_count > 0); };
  std::stable_sort(source.begin(), source.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });

  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
  std::vector<ordered_draw> ordered;
  for (const format::draw_record& d : source) {
    const bool alone = kind == polygon_order_kind::per_instance;
    const std::tuple key(alone ? static_cast<std::uint32_t>(ordered.size()) : d.mesh, d.primitive, d.polygon_count);
    const std::uint32_t unit = numbers.try_emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second;
    ordered.push_back({.unit = unit, .first = d.first_source, .count = d.polygon_count});
  }
  order_input in;
  in.draws = ordered;
  in.unit_count = static_cast<std::uint32_t>(numbers.size());
  in.cell_count = cell_count;
  std::vector<std::uint32_t> set;
  in.runs_of = [&](std::uint32_t cell, std::vector<format::run>& runs) {
    set.clear();
    set_of(cell, set);
    append_runs(set, runs);
  };
  polygon_order order = order_polygons(in, {});

  stored_draws out;
  std::vector<std::uint32_t> order_of_unit(order.units.size(), not_named);
  std::uint32_t next = 0;
  for (const std::uint32_t number : order.draws) {
    format::draw_record& d = out.draws.emplace_back(source[number]);
    d.first_stored = next;
    next += d.polygon_count;
    const std::uint32_t unit = ordered[number].unit;
    if (order_of_unit[unit] == not_named) {
      order_of_unit[unit] = static_cast<std::uint32_t>(out.orders.size());
      out.orders.push_back(std::move(order.units[unit]));
    }
    out.order_of_draw.push_back(order_of_unit[unit]);
  }
  return out;
}

}  // namespace sightcell::bake
