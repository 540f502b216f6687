#include "casters.h"

#include <algorithm>
#include <bit>
#include <new>

#include "index_list.h"
#include "ranges.h"

using namespace sightcell::runtime;
namespace format = sightcell::format;

namespace {

// The number of zeros below the lowest one. word: not 0.
std::uint32_t lowest_bit(std::uint64_t word) noexcept {
  return static_cast<std::uint32_t>(std::countr_zero(word));
}

std::uint64_t bits_from(std::uint32_t bit) noexcept {
  return ~std::uint64_t{0} << bit;
}

}  // namespace

std::uint64_t sightcell_casters::carve(void* block) noexcept {
  carver space(block);
  space.take<sightcell_casters>(1);
  const auto take = [&]<class T>(std::span<T>& out, std::uint64_t count) {
    T* first = space.take<T>(count);
    if (first == nullptr) return;
    construct(first, count);
    out = {first, static_cast<std::size_t>(count)};
  };
  const std::uint64_t polygons = db_->polygon_count();
  take(bits_, polygons / 64 + 1);
  take(row_, table_.run_bound());
  take(runs_, polygons / 2 + 1);  // runs do not touch
  static_cast<void>(space.take<std::uint64_t>(0));
  take(codes_memory_, db_->file().codes_size());
  static_cast<void>(space.take<std::uint32_t>(0));
  take(scratch_, table_.scratch_size());
  return space.used();
}

sightcell_status sightcell_casters::create(const sightcell_db& db, sightcell_casters** out) noexcept {
  if (db.is_paged()) return SIGHTCELL_ERR_ABSENT;
  sightcell_casters plan;
  plan.db_ = &db;
  const format::status opened = format::caster_table::open(db.file(), plan.table_);
  if (opened != format::status::ok) return static_cast<sightcell_status>(opened);
  const std::uint64_t size = plan.carve(nullptr);
  void* block = allocate(db.allocator(), size);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* casters = new (block) sightcell_casters(plan);
  casters->block_size_ = size;
  static_cast<void>(casters->carve(block));
  const format::status made = casters->table_.make_codes(casters->codes_memory_, casters->codes_);
  if (made != format::status::ok) {
    destroy(casters);
    return static_cast<sightcell_status>(made);
  }
  *out = casters;
  return SIGHTCELL_OK;
}

void sightcell_casters::destroy(sightcell_casters* casters) noexcept {
  if (casters != nullptr) release(casters->db_->allocator(), casters, casters->block_size_);
}

// runs: inside the polygons of the file.
void sightcell_casters::mark(std::span<const format::run> runs, bool in) noexcept {
  for (const format::run& r : runs) {
    const std::uint32_t end = r.first + r.count;
    for (std::uint32_t place = r.first; place < end;) {
      const std::uint32_t word = place / 64;
      std::uint64_t some = bits_from(place % 64);
      const std::uint64_t word_end = std::uint64_t{64} * word + 64;
      if (end < word_end) some &= ~bits_from(end % 64);
      bits_[word] = in ? bits_[word] | some : bits_[word] & ~some;
      place = static_cast<std::uint32_t>(std::min<std::uint64_t>(word_end, end));
    }
  }
}

// False if the casters of a cell are damaged.
bool sightcell_casters::mark_casters(const sightcell_view& view, std::uint32_t sun) noexcept {
  for (const std::uint32_t cell : view.shown_cells()) {
    std::size_t count = 0;
    if (table_.decode(cell, sun, codes_, row_, scratch_, count) != format::status::ok) return false;
    mark(row_.first(count), true);
  }
  return true;
}

std::span<const format::run> sightcell_casters::marked() noexcept {
  std::size_t count = 0;
  std::uint64_t before = 0;  // the bit of the polygon before the word
  for (std::size_t word = 0; word < bits_.size(); ++word) {
    const std::uint64_t bits = bits_[word];
    for (std::uint64_t left = bits ^ (bits << 1 | before); left != 0; left &= left - 1) {
      const std::uint32_t border = static_cast<std::uint32_t>(64 * word) + lowest_bit(left);
      if (count > 0 && runs_[count - 1].count == 0) {
        runs_[count - 1].count = border - runs_[count - 1].first;
      } else {
        runs_[count++] = {border, 0};
      }
    }
    before = bits >> 63;
  }
  return runs_.first(count);
}

std::span<const format::run> sightcell_casters::shadow_set(const sightcell_view& view, std::uint32_t sun) noexcept {
  if (view.draws_all()) return view.runs();
  std::fill(bits_.begin(), bits_.end(), std::uint64_t{0});
  mark(view.runs(), true);
  if (!mark_casters(view, sun)) {
    const format::run all{0, db_->polygon_count()};
    if (all.count > 0) mark({&all, 1}, true);
  }
  const range_borders borders = db_->range_borders();
  for (std::uint32_t draw = 0; draw + 1 < borders.size() && db_->named_range_count() > 0; ++draw) {
    const format::run whole{borders[draw], borders[draw + 1] - borders[draw]};
    if (view.is_hidden(draw)) mark({&whole, 1}, false);
  }
  return marked();
}

namespace {

// Checks what all outputs of casters take.
bool can_show(const sightcell_view* view, const sightcell_casters* casters, std::uint32_t sun, const void* dst,
              std::size_t capacity, const std::size_t* count) noexcept {
  return view != nullptr && casters != nullptr && &casters->db() == &view->db() && sun < casters->table().sun_count() &&
         count != nullptr && (dst != nullptr || capacity == 0);
}

}  // namespace

sightcell_status sightcell_casters_create(const sightcell_db* db, sightcell_casters** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  return sightcell_casters::create(*db, out);
}

void sightcell_casters_destroy(sightcell_casters* casters) {
  sightcell_casters::destroy(casters);
}

sightcell_status sightcell_casters_suns(const sightcell_casters* casters, sightcell_sun* dst, size_t capacity,
                                        size_t* count) {
  if (casters == nullptr || count == nullptr || (dst == nullptr && capacity > 0)) return SIGHTCELL_ERR_ARGUMENT;
  *count = casters->table().sun_count();
  if (*count > capacity) return SIGHTCELL_ERR_CAPACITY;
  for (std::uint32_t i = 0; i < *count; ++i) {
    format::sun_record sun;
    static_cast<void>(casters->table().sun(i, sun));  // fails for a number that does not exist
    std::copy(sun.from.begin(), sun.from.end(), dst[i].from);
    std::copy(sun.to.begin(), sun.to.end(), dst[i].to);
  }
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_casters(const sightcell_view* view, sightcell_casters* casters, uint32_t sun,
                                        sightcell_range* dst, size_t capacity, size_t* count) {
  if (!can_show(view, casters, sun, dst, capacity, count)) return SIGHTCELL_ERR_ARGUMENT;
  *count = write_ranges(casters->shadow_set(*view, sun), view->db().range_borders(), {dst, capacity});
  return *count > capacity ? SIGHTCELL_ERR_CAPACITY : SIGHTCELL_OK;
}

sightcell_status sightcell_view_caster_indices(const sightcell_view* view, sightcell_casters* casters, uint32_t sun,
                                               const uint32_t* stored_indices, uint32_t* dst, size_t capacity,
                                               size_t* count) {
  if (!can_show(view, casters, sun, dst, capacity, count)) return SIGHTCELL_ERR_ARGUMENT;
  return write_indices(casters->shadow_set(*view, sun), stored_indices, dst, capacity, count);
}
