#include "prefetch.h"

#include "way_ahead.h"

namespace sightcell::runtime {

void prefetch(const sightcell_db& db, const point& eye, const point& velocity, double seconds) noexcept {
  const way_ahead way(eye, velocity, seconds, static_cast<double>(db.file().facts().margin));
  first_wishes first;
  db.locator().for_each_group([&](const wide_box& bounds, std::uint32_t first_cell, std::uint32_t cells) {
    wish w;
    if (!way.reaches(bounds, w)) return;
    const std::uint32_t end = first_cell + cells;
    w.part = db.file().chunk_of(first_cell);
    if (w.part == db.file().chunk_of(end - 1)) return first.take(w);
    // Of a group in several chunks, those of the cells that are reached.
    for (std::uint32_t cell = first_cell; cell < end; ++cell) {
      format::box box;
      if (db.file().cell_box(cell, box) != format::status::ok || !way.reaches(widened(box), w)) continue;
      w.part = db.file().chunk_of(cell);
      first.take(w);
    }
  });
  chunk_cache::wish_list list(db.cache());
  for (const wish& w : first.wishes()) {
    if (!list.add(w.part)) return;
  }
}

}  // namespace sightcell::runtime
