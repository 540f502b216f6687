#include "order/stored_draws.h"

#include <algorithm>
#include <map>
#include <utility>

#include "order/polygon_order.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t not_named = UINT32_MAX;

// Appends ascending numbers as runs.
void append_runs(std::span<const std::uint32_t> set, std::vector<format::run>& runs) {
  for (const std::uint32_t id : set) {
    if (!runs.empty() && runs.back().first + runs.back().count == id)
      ++runs.back().count;
    else
      runs.push_back({.first = id, .count = 1});
  }
}

using set_source = std::function<void(std::uint32_t cell, std::vector<std::uint32_t>& set)>;

std::vector<format::draw_record> in_source_order(std::span<const format::draw_record> draws) {
  std::vector<format::draw_record> sorted(draws.begin(), draws.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return source_place(a) < source_place(b); });
  return sorted;
}

stored_draws store_instanced(std::span<const format::draw_record> draws, polygon_order_kind kind,
                             std::uint32_t cell_count, const set_source& set_of) {
  const std::vector<format::draw_record> source = in_source_order(draws);
  std::map<draw_unit, std::uint32_t> numbers;
  std::vector<ordered_draw> ordered;
  for (const format::draw_record& d : source) {
    const draw_unit key = unit_of(d, static_cast<std::uint32_t>(ordered.size()), kind);
    const std::uint32_t unit = numbers.try_emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second;
    ordered.push_back({.unit = unit, .first = d.first_source, .count = d.polygon_count});
  }
  order_input in;
  in.draws = ordered;
  in.unit_count = static_cast<std::uint32_t>(numbers.size());
  in.cell_count = cell_count;
  in.runs_of = [&](std::uint32_t cell, std::vector<format::run>& runs) {
    std::vector<std::uint32_t> set;
    set_of(cell, set);
    append_runs(set, runs);
  };
  polygon_order order = order_polygons(in, {});

  stored_draws out;
  std::vector<std::uint32_t> order_of_unit(order.units.size(), not_named);
  for (const std::uint32_t number : order.draws) {
    out.draws.push_back(source[number]);
    const std::uint32_t unit = ordered[number].unit;
    if (order_of_unit[unit] == not_named) {
      order_of_unit[unit] = static_cast<std::uint32_t>(out.orders.size());
      out.orders.push_back(std::move(order.units[unit]));
    }
    out.order_of_draw.push_back(order_of_unit[unit]);
  }
  lay_end_to_end(out.draws);
  return out;
}

// Numbers polygons as if every draw group were stored in source order.
class concatenation {
 public:
  // draws: from in_groups().
  explicit concatenation(std::span<const format::draw_record> draws) {
    for (const format::draw_record& d : draws)
      if (d.polygon_count > 0) stretches_.push_back({d.first_source, d.polygon_count, d.first_stored});
    std::sort(stretches_.begin(), stretches_.end(), [](const auto& a, const auto& b) { return a.source < b.source; });
  }

  // Appends ascending source ids as runs.
  void runs_of(std::span<const std::uint32_t> set, std::vector<format::run>& runs) const {
    std::vector<format::run> pieces;
    auto here = stretches_.begin();
    for (const std::uint32_t id : set) {
      while (id - here->source >= here->count) ++here;
      const std::uint32_t place = here->place + (id - here->source);
      if (!pieces.empty() && pieces.back().first + pieces.back().count == place)
        ++pieces.back().count;
      else
        pieces.push_back({.first = place, .count = 1});
    }
    std::sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const format::run& piece : pieces) {
      if (!runs.empty() && runs.back().first + runs.back().count == piece.first)
        runs.back().count += piece.count;
      else
        runs.push_back(piece);
    }
  }

 private:
  struct stretch {
    std::uint32_t source = 0, count = 0, place = 0;
  };
  std::vector<stretch> stretches_;  // in source order
};

stored_draws store_merged(std::span<const format::draw_record> draws, std::uint32_t cell_count,
                          const set_source& set_of) {
  const std::vector<format::draw_record> table = in_groups(draws);
  std::vector<ordered_draw> groups;
  for (const format::draw_record& d : table) {
    if (d.group == groups.size()) groups.push_back({.unit = d.group, .first = d.first_stored});
    groups.back().count += d.polygon_count;
  }
  order_input in;
  in.draws = groups;
  in.unit_count = static_cast<std::uint32_t>(groups.size());
  in.cell_count = cell_count;
  const concatenation numbers(table);
  in.runs_of = [&](std::uint32_t cell, std::vector<format::run>& runs) {
    std::vector<std::uint32_t> set;
    set_of(cell, set);
    numbers.runs_of(set, runs);
  };
  polygon_order order = order_polygons(in, {});

  stored_draws out;
  std::vector<std::uint32_t> new_number(groups.size());
  for (const std::uint32_t group : order.draws) {
    new_number[group] = static_cast<std::uint32_t>(out.orders.size());
    out.orders.push_back(std::move(order.units[group]));
  }
  out.draws = table;
  for (format::draw_record& d : out.draws) d.group = new_number[d.group];
  std::stable_sort(out.draws.begin(), out.draws.end(), [](const auto& a, const auto& b) { return a.group < b.group; });
  lay_end_to_end(out.draws);
  for (const format::draw_record& d : out.draws) out.order_of_draw.push_back(d.group);
  return out;
}

}  // namespace

draw_unit unit_of(const format::draw_record& d, std::uint32_t number, polygon_order_kind kind) {
  return {kind == polygon_order_kind::per_instance ? number : d.mesh, d.primitive, d.polygon_count};
}

void lay_end_to_end(std::span<format::draw_record> draws) {
  std::uint32_t next = 0;
  for (format::draw_record& d : draws) {
    d.first_stored = next;
    next += d.polygon_count;
  }
}

std::vector<format::draw_record> in_groups(std::span<const format::draw_record> draws) {
  std::vector<format::draw_record> table = in_source_order(draws);
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (format::draw_record& d : table)
    d.group = numbers.try_emplace(d.group, static_cast<std::uint32_t>(numbers.size())).first->second;
  std::stable_sort(table.begin(), table.end(), [](const auto& a, const auto& b) { return a.group < b.group; });
  lay_end_to_end(table);
  return table;
}

stored_draws store_draws(std::span<const format::draw_record> draws, format::host_layout layout,
                         polygon_order_kind kind, std::uint32_t cell_count, const set_source& set_of) {
  return layout == format::host_layout::merged ? store_merged(draws, cell_count, set_of)
                                               : store_instanced(draws, kind, cell_count, set_of);
}

}  // namespace sightcell::bake
