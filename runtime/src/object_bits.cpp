#include "object_bits.h"

#include <algorithm>

namespace sightcell::runtime {
namespace {

void set_bit(std::span<std::uint64_t> words, std::uint32_t draw) noexcept {
  words[draw / 64] |= std::uint64_t{1} << draw % 64;
}

// The polygons of the draws of a group are mixed, so the draw of each polygon is looked up.
void write_bits_of_groups(const sightcell_view& view, std::span<std::uint64_t> words) noexcept {
  std::uint32_t draw = 0;
  for (const sightcell_range& r : view.ranges()) {
    for (const std::uint32_t source : view.db().sources_in(r.draw, r.first, r.count)) {
      view.db().find_draw(r.draw, source, draw);
      set_bit(words, draw);
    }
  }
}

// Sets the bits of draws without polygons too: the host may have points or lines in them.
void write_all_bits(const sightcell_view& view, std::span<std::uint64_t> words) noexcept {
  const sightcell_db& db = view.db();
  for (std::uint32_t unit = 0; unit + 1 < db.range_borders().size(); ++unit) {
    if (view.is_hidden(unit)) continue;
    const std::uint32_t end = db.is_merged() ? db.draws_begin(unit + 1) : unit + 1;
    for (std::uint32_t draw = db.is_merged() ? db.draws_begin(unit) : unit; draw < end; ++draw) set_bit(words, draw);
  }
}

}  // namespace

void write_object_bits(const sightcell_view& view, std::span<std::uint64_t> words) noexcept {
  std::fill(words.begin(), words.end(), 0);
  if (view.draws_all()) {
    write_all_bits(view, words);
  } else if (view.db().is_merged()) {
    write_bits_of_groups(view, words);
  } else {
    for (const sightcell_range& r : view.ranges()) set_bit(words, r.draw);
  }
}

}  // namespace sightcell::runtime
