#include "slack.h"

#include <algorithm>
#include <array>

#include "number_symbols.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

// Stored polygons that are equal for every cell of a chunk: a bit for each cell.
struct stretch {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::uint64_t drawn = 0;
  std::uint32_t borders = 0;  // draws, or draw groups, that begin after its first polygon
  bool begins_draw = false;
};

std::vector<stretch> stretches_of(std::span<const std::vector<run>> sets) {
  std::vector<std::uint64_t> borders;  // polygon and cell
  std::size_t count = 0;
  for (const auto& set : sets) count += 2 * set.size();
  borders.reserve(count);
  for (std::uint64_t cell = 0; cell < sets.size(); ++cell) {
    for (const run& r : sets[cell]) {
      borders.push_back(std::uint64_t{r.first} << 6 | cell);
      borders.push_back((std::uint64_t{r.first} + r.count) << 6 | cell);
    }
  }
  std::sort(borders.begin(), borders.end());
  std::vector<stretch> all;
  std::uint64_t drawn = 0;
  std::uint32_t begin = 0;
  for (const std::uint64_t border : borders) {
    const auto place = static_cast<std::uint32_t>(border >> 6);
    if (place != begin) all.push_back({begin, place, drawn, 0, false});
    begin = place;
    drawn ^= std::uint64_t{1} << (border & 63);
  }
  return all;
}

void find_draws(std::span<const std::uint32_t> borders, std::vector<stretch>& all) {
  std::size_t draw = 0;
  for (stretch& s : all) {
    for (; draw + 1 < borders.size() && borders[draw] < s.end; ++draw) {
      if (borders[draw] == borders[draw + 1]) continue;  // without polygons
      if (borders[draw] == s.begin) {
        s.begins_draw = true;
      } else {
        ++s.borders;
      }
    }
  }
}

std::uint64_t polygons_of(std::span<const run> set) {
  std::uint64_t sum = 0;
  for (const run& r : set) sum += r.count;
  return sum;
}

class chunk_slack {
 public:
  chunk_slack(std::span<std::vector<run>> sets, const chunk_plan& plan, std::span<const std::uint32_t> borders,
              const slack_prices& prices, std::uint64_t share)
      : sets_(sets), plan_(plan), share_(share), path_(prices), all_(stretches_of(sets)) {
    find_draws(borders, all_);
    for (std::size_t cell = 0; cell < sets.size(); ++cell) {
      if (plan.same[cell] == cell && !is_alone(cell)) heirs_[plan.reference[cell]] |= std::uint64_t{1} << cell;
    }
  }

  [[nodiscard]] bool is_alone(std::size_t cell) const { return plan_.reference[cell] == chunk_plan::alone; }
  [[nodiscard]] unsigned depth(std::size_t cell) const {
    unsigned steps = 0;
    for (; !is_alone(cell); cell = plan_.reference[cell]) ++steps;
    return steps;
  }

  // References first, because cells with differences depend on their gains.
  void widen(std::size_t cell) {
    const std::uint64_t budget = polygons_of(sets_[cell]) * share_ / slack_share_unit;
    if (budget == 0) return;
    make_columns(cell);
    path_.choose(columns_, is_alone(cell), budget, drawn_);
    take(cell);
  }

 private:
  // Joins stretches that are equal for the cell, its reference and its heirs into one column.
  void make_columns(std::size_t cell) {
    columns_.clear();
    column_of_.resize(all_.size());
    const std::uint64_t own = std::uint64_t{1} << cell;
    const std::uint64_t reference = is_alone(cell) ? 0 : std::uint64_t{1} << plan_.reference[cell];
    const std::uint64_t relevant = own | reference | heirs_[cell];
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const stretch& s = all_[i];
      if (i == 0 || ((s.drawn ^ all_[i - 1].drawn) & relevant) != 0) {
        columns_.emplace_back();
        columns_.back().heirs = s.drawn & heirs_[cell];
        columns_.back().seen = (s.drawn & own) != 0;
        columns_.back().in_reference = (s.drawn & reference) != 0;
      }
      slack_column& c = columns_.back();
      c.borders += s.borders;
      if (c.size == 0) {
        c.begins_draw = s.begins_draw;
      } else if (s.begins_draw) {
        ++c.borders;
      }
      c.size += s.end - s.begin;
      column_of_[i] = static_cast<std::uint32_t>(columns_.size() - 1);
    }
  }

  // Stores the chosen set, also for the cells that refer to it.
  void take(std::size_t cell) {
    std::vector<run>& set = sets_[cell];
    set.clear();
    for (std::size_t i = 0; i < all_.size(); ++i) {
      stretch& s = all_[i];
      if (!drawn_[column_of_[i]]) continue;
      s.drawn |= std::uint64_t{1} << cell;
      if (!set.empty() && set.back().first + set.back().count == s.begin) {
        set.back().count += s.end - s.begin;
      } else {
        set.push_back({s.begin, s.end - s.begin});
      }
    }
  }

  std::span<std::vector<run>> sets_;
  const chunk_plan& plan_;
  std::uint64_t share_;
  slack_path path_;
  std::vector<stretch> all_;
  std::array<std::uint64_t, layout::cells_per_block> heirs_{};  // of each cell: the cells whose reference it is
  std::vector<slack_column> columns_;
  std::vector<std::uint32_t> column_of_;
  std::vector<bool> drawn_;
};

std::uint32_t price_of(const run_counts& counts, const run_encoder& encoder) {
  std::uint64_t bits = 0;
  std::uint64_t runs = 0;
  for (std::uint32_t symbol = 0; symbol < symbol_count; ++symbol) {
    bits += counts.gap[symbol] * (encoder.gap_lengths()[symbol] + raw_bits_of(symbol));
    bits += counts.more[symbol] * (encoder.more_lengths()[symbol] + raw_bits_of(symbol));
    runs += counts.gap[symbol];
  }
  return static_cast<std::uint32_t>(slack_price_unit * bits / std::max<std::uint64_t>(runs, 1));
}

// The price of a range in bits. Half of it gives 2 % more ranges and a 1 % smaller file.
constexpr std::uint32_t range_price = 16 * slack_price_unit;

}  // namespace

slack_prices slack_prices_of(const row_counts& counts, const row_encoders& encoders) {
  return {price_of(counts.own, encoders.own), price_of(counts.removed, encoders.removed),
          price_of(counts.added, encoders.added), range_price};
}

void add_slack(std::span<std::vector<run>> sets, const chunk_plan& plan, std::span<const std::uint32_t> borders,
               const slack_prices& prices, std::uint64_t share, slack_sums& sums) {
  std::uint64_t seen = 0;
  for (const auto& set : sets) seen += polygons_of(set);
  chunk_slack chunk(sets, plan, borders, prices, share);
  for (unsigned depth = 0; depth <= layout::max_reference_depth; ++depth) {
    for (std::size_t cell = 0; cell < sets.size(); ++cell) {
      if (plan.same[cell] == cell && chunk.depth(cell) == depth) chunk.widen(cell);
    }
  }
  std::uint64_t drawn = 0;
  for (std::size_t cell = 0; cell < sets.size(); ++cell) {
    if (plan.same[cell] != cell) sets[cell] = sets[plan.same[cell]];
    drawn += polygons_of(sets[cell]);
  }
  sums.seen += seen;
  sums.added += drawn - seen;
}

}  // namespace sightcell::format
