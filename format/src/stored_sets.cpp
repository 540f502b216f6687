#include "stored_sets.h"

#include <algorithm>
#include <bit>

namespace sightcell::format {
namespace {

std::uint32_t polygon_count_of(std::span<const draw_record> draws) {
  return draws.empty() ? 0 : draws.back().first_stored + draws.back().polygon_count;
}

}  // namespace

stored_sets::stored_sets(std::span<const draw_record> draws, std::span<const std::uint32_t> order_of_draw,
                         std::span<const std::vector<std::uint32_t>> orders)
    : draws_(draws.begin(), draws.end()),
      order_of_draw_(order_of_draw.begin(), order_of_draw.end()),
      stored_of_source_(polygon_count_of(draws)),
      members_(polygon_count_of(draws) / 64 + 1),
      first_atom_(draws.size() + 1, 0) {
  for (const std::vector<std::uint32_t>& order : orders) {
    orders_.push_back({order, std::vector<bool>(order.size(), false)});
    if (!order.empty()) orders_.back().begins_atom[0] = true;
  }
  for (std::size_t d = 0; d < draws_.size(); ++d) {
    const std::vector<std::uint32_t>& order = orders_[order_of_draw_[d]].source_of_stored;
    for (std::uint32_t i = 0; i < draws_[d].polygon_count; ++i) {
      stored_of_source_[draws_[d].first_source + order[i]] = draws_[d].first_stored + i;
    }
  }
}

// Through a bit for each polygon, and at least one behind the last: sorting the stored numbers takes several times as
// long.
void stored_sets::polygon_runs(std::span<const std::uint32_t> source_ids, std::vector<run>& runs) {
  runs.clear();
  for (const std::uint32_t id : source_ids) {
    const std::uint32_t stored = stored_of_source_[id];
    members_[stored / 64] |= std::uint64_t{1} << (stored % 64);
  }
  std::uint64_t before = 0;  // the bit of the polygon in front of the word
  const auto border = [&](std::uint64_t at) {
    if (runs.empty() || runs.back().count != 0) {
      runs.push_back({static_cast<std::uint32_t>(at), 0});
    } else {
      runs.back().count = static_cast<std::uint32_t>(at) - runs.back().first;
    }
  };
  for (std::size_t word = 0; word < members_.size(); ++word) {
    const std::uint64_t bits = members_[word];
    for (std::uint64_t left = bits ^ (bits << 1 | before); left != 0; left &= left - 1) {
      border(64 * std::uint64_t{word} + static_cast<unsigned>(std::countr_zero(left)));
    }
    before = bits >> 63;
    members_[word] = 0;
  }
}

void stored_sets::find_place(std::uint32_t polygon, place& at) const {
  const auto begin = draws_.begin() + static_cast<std::ptrdiff_t>(at.draw);
  const auto after = std::upper_bound(begin, draws_.end(), polygon,
                                      [](std::uint32_t p, const draw_record& d) { return p < d.first_stored; });
  at.draw = static_cast<std::size_t>(after - draws_.begin()) - 1;
  at.local = polygon - draws_[at.draw].first_stored;
}

void stored_sets::mark(std::span<const run> polygons) {
  place at;
  const auto mark_border = [&](std::uint32_t polygon) {
    if (polygon == polygon_count_of(draws_)) return;
    find_place(polygon, at);
    orders_[order_of_draw_[at.draw]].begins_atom[at.local] = true;
  };
  for (const run& r : polygons) {
    mark_border(r.first);
    mark_border(r.first + r.count);
  }
}

void stored_sets::find_atoms() {
  atoms_before_.clear();
  for (polygon_order& order : orders_) {
    sort_atoms(order);
    std::vector<std::uint32_t> before;
    before.reserve(order.begins_atom.size() + 1);
    std::uint32_t atoms = 0;
    for (const bool begins : order.begins_atom) {
      before.push_back(atoms);
      atoms += begins ? 1 : 0;
    }
    before.push_back(atoms);
    atoms_before_.push_back(std::move(before));
  }
  for (std::size_t d = 0; d < draws_.size(); ++d) {
    first_atom_[d + 1] = first_atom_[d] + atoms_before_[order_of_draw_[d]].back();
  }
}

void stored_sets::to_atoms(std::vector<run>& polygons) const {
  place at;
  const auto atom_of = [&](std::uint32_t polygon) {
    if (polygon == polygon_count_of(draws_)) return atom_count();
    find_place(polygon, at);
    return first_atom_[at.draw] + atoms_before_[order_of_draw_[at.draw]][at.local];
  };
  for (run& r : polygons) {
    const std::uint32_t first = atom_of(r.first);
    r = {first, atom_of(r.first + r.count) - first};
  }
}

}  // namespace sightcell::format
