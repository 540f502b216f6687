#include "prefetch.h"

#include "way_ahead.h"

namespace sightcell::runtime {

void prefetch(const sightcell_db& db, const point& eye, const point& velocity, double seconds) noexcept {
  const way_ahead way(eye, velocity, seconds, static_cast<double>(db.file().facts().margin));
  first_wishes first;
  db.locator().for_each_group([&](const wide_box& bounds, std::uint32_t first_cell, std::uint32_t cells) {
    wish w;
    if (!way.reaches(bounds, w)) return;
    for (w.part = format::reader::chunk_of(first_cell); w.part <= format::reader::chunk_of(first_cell + cells - 1);
         ++w.part) {
      first.take(w);
    }
  });
  chunk_cache::wish_list list(db.cache());
  for (const wish& w : first.wishes()) {
    if (!list.add(w.part)) return;
  }
}

}  // namespace sightcell::runtime
