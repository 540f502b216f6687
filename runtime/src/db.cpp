#include "db.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <new>

using sightcell::runtime::carver;
using sightcell::runtime::chunk_state;
using sightcell::runtime::located_cell;
using sightcell::runtime::locator_node;
namespace format = sightcell::format;

bool sightcell_db::is_merged() const noexcept {
  return file_.facts().layout == format::host_layout::merged;
}

std::uint64_t sightcell_db::carve(void* block) noexcept {
  carver space(block);
  space.take<sightcell_db>(1);
  const auto give = [&]<class T>(std::span<T>& target, std::uint64_t count) {
    T* place = space.take<T>(count);
    if (place == nullptr) return;
    std::uninitialized_value_construct_n(place, static_cast<std::size_t>(count));
    target = {place, static_cast<std::size_t>(count)};
  };
  give(cells_, file_.cell_count());
  give(nodes_, sightcell::runtime::cell_locator::node_count(file_.cell_count()));
  give(range_borders_, std::uint64_t{file_.range_unit_count()} + 1);
  give(range_sources_, file_.range_unit_count());
  give(orders_, is_merged() ? file_.polygon_count() : file_.order_begin(file_.order_count()));
  give(chunks_, file_.chunk_count());
  std::span<std::uint64_t> codes;  // so that they lie at a multiple of 8
  give(codes, (file_.codes_size() + 7) / 8);
  codes_memory_ = std::as_writable_bytes(codes);
  return space.used();
}

// Copies what every frame needs, checking each value again: the bytes may have changed since they were opened.
bool sightcell_db::fill() noexcept {
  for (std::uint32_t cell = 0; cell < file_.cell_count(); ++cell) {
    if (file_.cell_box(cell, cells_[cell].bounds) != format::status::ok) return false;
    cells_[cell].cell = cell;
  }
  locator_.build(cells_, nodes_);
  return fill_ranges() && file_.make_codes(codes_memory_, codes_) == format::status::ok;
}

bool sightcell_db::fill_ranges() noexcept {
  std::uint32_t next = 0;
  for (std::uint32_t number = 0; number < range_sources_.size(); ++number) {
    range_borders_[number] = next;
    if (file_.range_unit_begin(number) != next) return false;
    const std::uint32_t end = file_.range_unit_begin(number + 1);
    if (end < next || end > file_.polygon_count()) return false;
    range_sources_[number] = {0, next, 0};
    if (!is_merged()) {
      format::draw_record draw;
      const std::uint32_t order_begin = file_.order_begin(file_.order_of_draw(number));
      if (file_.draw(number, draw) != format::status::ok || draw.polygon_count != end - next) return false;
      if (order_begin > orders_.size() || draw.polygon_count > orders_.size() - order_begin) return false;
      range_sources_[number] = {draw.first_source, order_begin, draw.base_vertex};
    }
    if (end > next) ++whole_ranges_;
    next = end;
  }
  range_borders_.back() = next;
  const format::status read = is_merged() ? file_.source_of_stored(orders_) : file_.orders(orders_);
  return next == file_.polygon_count() && read == format::status::ok;
}

sightcell_status sightcell_db::open(std::span<const std::byte> bytes, const sightcell_allocator& mem, void* owned_bytes,
                                    sightcell_db** out) noexcept {
  sightcell_db plan;
  const format::status opened = format::reader::open(bytes, plan.file_);
  if (opened != format::status::ok) return static_cast<sightcell_status>(opened);
  const std::uint64_t size = plan.carve(nullptr);
  void* block = sightcell::runtime::allocate(mem, size);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* db = new (block) sightcell_db(plan);
  db->mem_ = mem;
  db->block_size_ = size;
  static_cast<void>(db->carve(block));
  if (!db->fill()) {
    close(db);
    return SIGHTCELL_ERR_CORRUPT;
  }
  // Only now: a failed open leaves the bytes to the caller.
  db->owned_bytes_ = owned_bytes;
  db->owned_size_ = bytes.size();
  *out = db;
  return SIGHTCELL_OK;
}

void sightcell_db::close(sightcell_db* db) noexcept {
  if (db == nullptr) return;
  const sightcell_allocator mem = db->mem_;
  sightcell::runtime::release(mem, db->owned_bytes_, db->owned_size_);
  sightcell::runtime::release(mem, db, db->block_size_);
}

std::uint32_t sightcell_db::range_bound() const noexcept {
  return std::max(file_.range_bound(), whole_ranges_);
}

bool sightcell_db::cell_is_sound(std::uint32_t cell) const noexcept {
  const std::uint32_t chunk = format::reader::chunk_of(cell);
  std::atomic<chunk_state>& state = chunks_[chunk];
  chunk_state known = state.load(std::memory_order_relaxed);
  if (known == chunk_state::unknown) {
    known = file_.check_chunk(chunk) == format::status::ok ? chunk_state::good : chunk_state::damaged;
    state.store(known, std::memory_order_relaxed);
  }
  return known == chunk_state::good;
}

sightcell_status sightcell_db::check() const noexcept {
  const auto carve_check = [this](void* block, std::span<format::run>& runs, std::span<std::byte>& scratch,
                                  std::span<std::uint32_t>& stored) {
    carver space(block);
    auto* first_run = space.take<format::run>(file_.run_bound());
    auto* first_number = space.take<std::uint32_t>(file_.polygon_count());
    auto* first_byte = space.take<std::byte>(file_.scratch_size());
    if (block == nullptr) return space.used();
    std::uninitialized_value_construct_n(first_run, file_.run_bound());
    std::uninitialized_value_construct_n(first_number, file_.polygon_count());
    std::uninitialized_value_construct_n(first_byte, file_.scratch_size());
    runs = {first_run, file_.run_bound()};
    stored = {first_number, file_.polygon_count()};
    scratch = {first_byte, file_.scratch_size()};
    return space.used();
  };
  std::span<format::run> runs;
  std::span<std::byte> scratch;
  std::span<std::uint32_t> stored;
  const std::uint64_t size = std::max<std::uint64_t>(carve_check(nullptr, runs, scratch, stored), 1);
  void* block = sightcell::runtime::allocate(mem_, size);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  static_cast<void>(carve_check(block, runs, scratch, stored));
  const format::status s = file_.check(codes_, runs, scratch, stored);
  sightcell::runtime::release(mem_, block, size);
  return static_cast<sightcell_status>(s);
}
