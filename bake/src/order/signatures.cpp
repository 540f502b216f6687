#include "order/signatures.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "sightcell/base/in_blocks.h"
#include "sightcell/base/random.h"
#include "sightcell/format/draw_ranges.h"

namespace sightcell::bake {
namespace {

using runs_type = std::vector<format::run>;

// Calls visit(cell, runs) on this thread for each cell, ascending. Decoding the sets takes longer than most visits, so
// it uses all threads.
template <class Visit>
void for_each_cell(const order_input& in, const Visit& visit) {
  constexpr std::uint32_t most_at_once = 64;
  std::vector<runs_type> sets(std::min(most_at_once, in.cell_count));
  for (std::uint32_t first = 0; first < in.cell_count; first += most_at_once) {
    const std::uint32_t count = std::min(most_at_once, in.cell_count - first);
    tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t i) {
      sets[i].clear();
      in.runs_of(first + i, sets[i]);
    });
    for (std::uint32_t i = 0; i < count; ++i) visit(first + i, std::as_const(sets[i]));
  }
}

// Calls visit(draw, pieces) for each draw of which a set with these runs has some polygons and not all, ascending.
// pieces: runs relative to the first polygon of the draw.
// scratch: storage to reuse.
template <class Visit>
void for_each_cut_draw(const order_input& in, const runs_type& runs, runs_type& scratch, const Visit& visit) {
  if (in.draws.empty()) return;
  const std::uint32_t polygon_count = in.draws.back().first + in.draws.back().count;
  std::uint32_t current = 0, seen = 0;
  scratch.clear();
  const auto finish = [&] {
    if (seen != 0 && seen < in.draws[current].count) visit(current, std::span<const format::run>(scratch));
    scratch.clear();
    seen = 0;
  };
  format::for_each_draw_range(
      std::span(runs), static_cast<std::uint32_t>(in.draws.size()), polygon_count,
      [&](std::uint32_t d) { return in.draws[d].first; },
      [&](std::uint32_t draw, std::uint32_t first, std::uint32_t count) {
        if (draw != current) finish();
        current = draw;
        seen += count;
        scratch.push_back({.first = first, .count = count});
      });
  finish();
}

bool contains(const runs_type& runs, std::uint32_t polygon) {
  const auto after = std::ranges::upper_bound(runs, polygon, {}, &format::run::first);
  return after != runs.begin() && polygon - (after - 1)->first < (after - 1)->count;
}

// Zobrist hash of a set of (draw, cell).
struct signature_hash {
  std::uint64_t low = 0, high = 0;
  signature_hash& operator^=(const signature_hash& other) {
    low ^= other.low;
    high ^= other.high;
    return *this;
  }
  auto operator<=>(const signature_hash&) const = default;
};

signature_hash hash_of(std::uint32_t draw, std::uint32_t cell) {
  const std::uint64_t key = std::uint64_t{draw} << 32 | cell;
  return {mix_bits(key + 0x9E3779B97F4A7C15ull), mix_bits(mix_bits(key ^ 0xD1B54A32D192ED03ull) + key)};
}

// Returns the hash of the signature of each polygon, per unit. Counts the columns of each unit.
std::vector<std::vector<signature_hash>> read_hashes(const order_input& in, std::vector<unit_signatures>& units) {
  // Hashes are first written as differences between consecutive polygons, and then summed.
  std::vector<std::vector<signature_hash>> hashes(units.size());
  for (std::size_t u = 0; u < units.size(); ++u) hashes[u].resize(std::size_t{units[u].polygon_count} + 1);
  runs_type scratch;
  for_each_cell(in, [&](std::uint32_t cell, const runs_type& runs) {
    for_each_cut_draw(in, runs, scratch, [&](std::uint32_t draw, std::span<const format::run> pieces) {
      const std::uint32_t unit = in.draws[draw].unit;
      const signature_hash hash = hash_of(draw, cell);
      for (const format::run& piece : pieces) {
        hashes[unit][piece.first] ^= hash;
        hashes[unit][piece.first + piece.count] ^= hash;
      }
      ++units[unit].column_count;
    });
  });
  for (std::vector<signature_hash>& of_unit : hashes) {
    signature_hash sum;
    for (signature_hash& hash : of_unit) hash = sum ^= hash;
    of_unit.pop_back();
  }
  return hashes;
}

// Groups the polygons with equal hashes into atoms.
void find_atoms(std::span<const signature_hash> hashes, unit_signatures& unit) {
  std::vector<std::uint32_t> by_hash(hashes.size());
  std::iota(by_hash.begin(), by_hash.end(), 0u);
  sort_without_ties(by_hash,
                    [&](std::uint32_t a, std::uint32_t b) { return std::tie(hashes[a], a) < std::tie(hashes[b], b); });
  // first[p] is the first polygon of p's atom. Atoms are sorted by it.
  std::vector<std::uint32_t> first(hashes.size());
  for (std::size_t i = 0; i < by_hash.size(); ++i)
    first[by_hash[i]] = i > 0 && hashes[by_hash[i]] == hashes[by_hash[i - 1]] ? first[by_hash[i - 1]] : by_hash[i];
  unit.members = std::move(by_hash);
  std::iota(unit.members.begin(), unit.members.end(), 0u);
  sort_without_ties(unit.members,
                    [&](std::uint32_t a, std::uint32_t b) { return std::tie(first[a], a) < std::tie(first[b], b); });
  for (std::uint32_t i = 0; i < unit.members.size(); ++i)
    if (first[unit.members[i]] == unit.members[i]) unit.begins.push_back(i);
  unit.begins.push_back(unit.polygon_count);
}

// Calls visit(draw, column, pieces) for each column, with folded columns. The sequence of columns is the same for every
// reading of an input.
class column_reader {
 public:
  column_reader(const order_input& in, std::span<const unit_signatures> units)
      : in_(in), units_(units), next_(units.size()) {}

  template <class Visit>
  void read(const runs_type& runs, const Visit& visit) {
    for_each_cut_draw(in_, runs, scratch_, [&](std::uint32_t draw, std::span<const format::run> pieces) {
      const std::uint32_t unit = in_.draws[draw].unit;
      visit(draw, folded_column(next_[unit]++, units_[unit].column_count, units_[unit].rows), pieces);
    });
  }

 private:
  const order_input& in_;
  std::span<const unit_signatures> units_;
  std::vector<std::uint64_t> next_;
  runs_type scratch_;
};

// Atoms whose first polygons are in one piece are consecutive. So bits are first written as differences between
// consecutive atoms, and then summed.
void read_rows(const order_input& in, std::span<unit_signatures> units) {
  // For each polygon of a unit, and for its end, the number of atoms that begin before it.
  std::vector<std::vector<std::uint32_t>> atoms_before(units.size());
  for (std::size_t u = 0; u < units.size(); ++u) {
    std::vector<std::uint32_t>& before = atoms_before[u];
    before.resize(std::size_t{units[u].polygon_count} + 1);
    for (std::uint32_t a = 0; a < units[u].atom_count(); ++a) ++before[units[u].members[units[u].begins[a]] + 1];
    std::partial_sum(before.begin(), before.end(), before.begin());
  }
  column_reader columns(in, units);
  for_each_cell(in, [&](std::uint32_t, const runs_type& runs) {
    columns.read(runs, [&](std::uint32_t draw, std::uint32_t column, std::span<const format::run> pieces) {
      const std::uint32_t unit = in.draws[draw].unit;
      for (const format::run& piece : pieces) {
        units[unit].rows.toggle(atoms_before[unit][piece.first], column);
        units[unit].rows.toggle(atoms_before[unit][piece.first + piece.count], column);
      }
    });
  });
  for (unit_signatures& unit : units)
    for (std::uint32_t a = 1; a <= unit.atom_count(); ++a) {
      const std::span<const std::uint64_t> before = std::as_const(unit.rows).row(a - 1);
      const std::span<std::uint64_t> row = unit.rows.row(a);
      for (std::size_t word = 0; word < row.size(); ++word) row[word] ^= before[word];
    }
}

}  // namespace

std::vector<std::uint32_t> unit_signatures::polygons_of(std::span<const std::uint32_t> atoms) const {
  std::vector<std::uint32_t> polygons;
  polygons.reserve(polygon_count);
  for (const std::uint32_t a : atoms)
    polygons.insert(polygons.end(), members.begin() + begins[a], members.begin() + begins[a + 1]);
  return polygons;
}

std::vector<unit_signatures> read_signatures(const order_input& in, std::uint32_t sketch_bits) {
  std::vector<unit_signatures> units(in.unit_count);
  for (const ordered_draw& draw : in.draws) units[draw.unit].polygon_count = draw.count;
  std::vector<std::vector<signature_hash>> hashes = read_hashes(in, units);
  for (std::size_t u = 0; u < units.size(); ++u) {
    find_atoms(hashes[u], units[u]);
    hashes[u] = {};
    const std::uint64_t columns = std::min<std::uint64_t>(units[u].column_count, sketch_bits);
    units[u].rows = bit_matrix(units[u].atom_count() + 2, static_cast<std::uint32_t>(columns));
  }
  read_rows(in, units);
  return units;
}

void set_surroundings(const order_input& in, std::span<const surroundings> by_draw, std::span<unit_signatures> units) {
  for (unit_signatures& unit : units)
    for (std::uint32_t side = 0; side < 2; ++side) unit.rows.clear(unit.atom_count() + side);
  column_reader columns(in, units);
  for_each_cell(in, [&](std::uint32_t, const runs_type& runs) {
    columns.read(runs, [&](std::uint32_t draw, std::uint32_t column, std::span<const format::run>) {
      unit_signatures& unit = units[in.draws[draw].unit];
      const auto& [before, after] = by_draw[draw];
      if (contains(runs, before)) unit.rows.toggle(unit.atom_count(), column);
      if (contains(runs, after)) unit.rows.toggle(unit.atom_count() + 1, column);
    });
  });
}

bit_matrix cells_that_see(const order_input& in, std::span<const std::uint32_t> polygons, std::uint32_t sketch_bits) {
  bit_matrix cells(static_cast<std::uint32_t>(polygons.size()), std::min(sketch_bits, in.cell_count));
  std::vector<std::uint32_t> ascending(polygons.size());
  std::iota(ascending.begin(), ascending.end(), 0u);
  std::sort(ascending.begin(), ascending.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::tie(polygons[a], a) < std::tie(polygons[b], b); });
  for_each_cell(in, [&](std::uint32_t cell, const runs_type& runs) {
    const std::uint32_t column = folded_column(cell, in.cell_count, cells);
    auto run = runs.begin();
    for (const std::uint32_t row : ascending) {
      while (run != runs.end() && run->first + run->count <= polygons[row]) ++run;
      if (run == runs.end()) break;
      if (run->first <= polygons[row]) cells.toggle(row, column);
    }
  });
  return cells;
}

}  // namespace sightcell::bake
