#include "db.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <new>

using sightcell::runtime::box_tree;
using sightcell::runtime::cached_chunk;
using sightcell::runtime::carver;
using sightcell::runtime::chunk_presence;
using sightcell::runtime::chunk_state;
using sightcell::runtime::lattice_index;
using sightcell::runtime::row_outcome;
namespace format = sightcell::format;

bool sightcell_db::is_merged() const noexcept {
  return file_.facts().layout == format::host_layout::merged;
}

// The size of room_ is set before.
std::uint64_t sightcell_db::carve(void* block) noexcept {
  carver space(block);
  space.take<sightcell_db>(1);
  const auto give = [&]<class T>(std::span<T>& target, std::uint64_t count) {
    T* first = space.take<T>(count);
    if (first == nullptr) return;
    sightcell::runtime::construct(first, count);
    target = {first, static_cast<std::size_t>(count)};
  };
  const format::cell_lattice* lattice = file_.lattice();
  const std::uint32_t boxes = lattice == nullptr ? file_.cell_count() : 0;
  give(cells_.slots, lattice == nullptr ? 0 : lattice_index::slot_count(lattice->chunk_count()));
  give(cells_.cells, boxes);
  give(cells_.nodes, box_tree::node_count(boxes));
  give(range_borders_, std::uint64_t{file_.range_unit_count()} + 1);
  give(range_sources_, file_.range_unit_count());
  give(orders_, is_merged() ? file_.polygon_count() : file_.order_begin(file_.order_count()));
  give(group_draws_, is_merged() ? std::uint64_t{file_.range_unit_count()} + 1 : 0);
  give(draw_sources_, is_merged() ? file_.draw_count() : 0);
  give(named_groups_, file_.named_groups().count() > 0 ? file_.range_unit_count() : 0);
  give(chunks_, is_paged() ? 0 : std::uint64_t{has_importance() ? 2u : 1u} * file_.chunk_count());
  give(cached_, is_paged() ? file_.chunk_count() : 0);
  give(cached_order_, is_paged() ? file_.chunk_count() : 0);
  std::span<std::uint64_t> codes;  // for their alignment of 8
  give(codes, (file_.codes_size() + 7) / 8);
  codes_memory_ = std::as_writable_bytes(codes);
  volumes_.carve(space);
  give(room_, room_.size());
  return space.used();
}

// Copies what every frame needs. Checks each value again: the bytes may have changed since they were opened.
sightcell_status sightcell_db::fill() noexcept {
  if (!locator_.build(file_, cells_)) return SIGHTCELL_ERR_CORRUPT;
  if (!fill_ranges() || !fill_draws_of_groups() || !fill_named_groups()) return SIGHTCELL_ERR_CORRUPT;
  if (!volumes_.build(file_.volumes())) return SIGHTCELL_ERR_CORRUPT;
  return static_cast<sightcell_status>(file_.make_codes(codes_memory_, codes_));
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

bool sightcell_db::fill_draws_of_groups() noexcept {
  if (!is_merged()) return true;
  std::uint32_t group = 0;  // the next group to begin
  for (std::uint32_t number = 0; number < draw_sources_.size(); ++number) {
    format::draw_record draw;
    if (file_.draw(number, draw) != format::status::ok || draw.group >= range_sources_.size()) return false;
    if (draw.group == group) group_draws_[group++] = number;
    if (draw.group + 1 != group) return false;
    draw_sources_[number] = draw.first_source;
  }
  group_draws_.back() = static_cast<std::uint32_t>(draw_sources_.size());
  return group == range_sources_.size();
}

// All draws of a draw group are in the same named group.
bool sightcell_db::fill_named_groups() noexcept {
  for (std::uint32_t number = 0; number < named_groups_.size(); ++number) {
    std::uint32_t& group = named_groups_[number];
    if (!file_.named_groups().of_draw(is_merged() ? group_draws_[number] : number, group)) return false;
    if (group != format::no_named_group) ++named_ranges_;
  }
  return true;
}

// Tests near first, since consecutive polygons mostly belong to one draw. A draw without polygons begins where the next
// one does, and is skipped.
void sightcell_db::find_draw(std::uint32_t group, std::uint32_t source, std::uint32_t& near) const noexcept {
  const std::uint32_t begin = group_draws_[group];
  const std::uint32_t end = group_draws_[group + 1];
  const auto begins_late = [&](std::uint32_t draw) { return draw == end || draw_sources_[draw] > source; };
  if (near >= begin && near < end && draw_sources_[near] <= source && begins_late(near + 1)) return;
  const auto* first = draw_sources_.data();
  near = static_cast<std::uint32_t>(std::upper_bound(first + begin, first + end, source) - first);
  near -= near > begin ? 1 : 0;
}

sightcell_status sightcell_db::open(std::span<const std::byte> bytes, const sightcell_allocator& mem, void* owned_bytes,
                                    sightcell_db** out) noexcept {
  sightcell_db plan;
  const format::status opened = format::reader::open(bytes, plan.file_);
  if (opened != format::status::ok) return static_cast<sightcell_status>(opened);
  plan.volumes_.measure(plan.file_.volumes());
  const std::uint64_t size = plan.carve(nullptr);
  void* block = sightcell::runtime::allocate(mem, size);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* db = new (block) sightcell_db;
  db->file_ = plan.file_;
  db->volumes_ = plan.volumes_;
  db->mem_ = mem;
  db->block_size_ = size;
  static_cast<void>(db->carve(block));
  if (const sightcell_status s = db->fill(); s != SIGHTCELL_OK) {
    close(db);
    return s;
  }
  // Only now: if open fails, the caller keeps the bytes.
  db->owned_bytes_ = owned_bytes;
  db->owned_size_ = bytes.size();
  db->step_.store(opening_step::open, std::memory_order_relaxed);
  *out = db;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db::begin_source(const sightcell_source& source, const sightcell_allocator& mem,
                                            std::uint64_t resident_bytes, sightcell_db** out) noexcept {
  void* block = sightcell::runtime::allocate(mem, sizeof(sightcell_db));
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* db = new (block) sightcell_db;
  db->mem_ = mem;
  db->block_size_ = sizeof(sightcell_db);
  db->source_ = source;
  db->resident_bytes_ = resident_bytes;
  *out = db;
  const sightcell_status s = db->continue_opening();
  if (s == SIGHTCELL_OK || s == SIGHTCELL_PENDING) return s;
  *out = nullptr;
  close(db);
  return s;
}

sightcell_status sightcell_db::continue_opening() noexcept {
  for (;;) {
    const opening_step step = step_.load(std::memory_order_relaxed);
    if (step == opening_step::open) return SIGHTCELL_OK;
    sightcell_status s = SIGHTCELL_OK;
    if (step == opening_step::header) {
      step_.store(opening_step::header_awaited, std::memory_order_relaxed);
      const std::uint64_t size = std::min<std::uint64_t>(header_.size(), source_.size);
      s = ask({header_.data(), static_cast<std::size_t>(size)});
    } else {
      const delivery state = opening_.state.load(std::memory_order_acquire);
      if (state == delivery::awaited || state == delivery::arriving) return SIGHTCELL_PENDING;
      if (state != delivery::arrived) return SIGHTCELL_ERR_IO;
      s = step == opening_step::header_awaited ? take_header() : take_front();
    }
    if (s != SIGHTCELL_OK) {
      opening_.state.store(delivery::none, std::memory_order_relaxed);
      return s;
    }
  }
}

// Requests the first bytes of the file.
sightcell_status sightcell_db::ask(std::span<std::byte> target) noexcept {
  opening_.target = target;
  ++opening_.ticket;
  opening_.state.store(delivery::awaited, std::memory_order_release);
  return source_.request(source_.user, 0, static_cast<std::uint32_t>(target.size()), opening_.ticket);
}

sightcell_status sightcell_db::take_header() noexcept {
  std::uint64_t front = 0;
  const format::status sized = format::reader::front_size(opening_.target, source_.size, front);
  if (sized != format::status::ok) return static_cast<sightcell_status>(sized);
  if (front > std::numeric_limits<std::uint32_t>::max()) return SIGHTCELL_ERR_LIMIT;  // one request
  owned_bytes_ = sightcell::runtime::allocate(mem_, front);
  if (owned_bytes_ == nullptr) return SIGHTCELL_ERR_MEMORY;
  owned_size_ = front;
  step_.store(opening_step::front_awaited, std::memory_order_relaxed);
  return ask({static_cast<std::byte*>(owned_bytes_), static_cast<std::size_t>(front)});
}

sightcell_status sightcell_db::take_front() noexcept {
  const format::status opened = format::reader::open_front(opening_.target, source_.size, file_);
  if (opened != format::status::ok) return static_cast<sightcell_status>(opened);

  std::uint64_t all = 0;
  std::uint64_t largest = 0;
  for (std::uint32_t chunk = 0; chunk < file_.chunk_count(); ++chunk) {
    std::uint64_t offset = 0;
    std::uint32_t size = 0;
    if (file_.chunk_place(chunk, offset, size) != format::status::ok) return SIGHTCELL_ERR_CORRUPT;
    all += size;
    largest = std::max<std::uint64_t>(largest, size);
  }
  if (resident_bytes_ < largest) return SIGHTCELL_ERR_CAPACITY;
  const std::uint64_t room = std::min(resident_bytes_, all);
  if (room > std::numeric_limits<std::size_t>::max()) return SIGHTCELL_ERR_MEMORY;
  room_ = {static_cast<std::byte*>(nullptr), static_cast<std::size_t>(room)};
  volumes_.measure(file_.volumes());
  tables_size_ = carve(nullptr);
  tables_ = sightcell::runtime::allocate(mem_, tables_size_);
  if (tables_ == nullptr) return SIGHTCELL_ERR_MEMORY;
  static_cast<void>(carve(tables_));
  if (const sightcell_status s = fill(); s != SIGHTCELL_OK) return s;
  if (!cache_.open(file_, source_, cached_, cached_order_, room_)) return SIGHTCELL_ERR_CORRUPT;
  step_.store(opening_step::open, std::memory_order_release);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_db::deliver(std::uint32_t ticket, const void* bytes, std::uint32_t size) noexcept {
  if (!is_paged()) return SIGHTCELL_ERR_ARGUMENT;
  return is_open() ? cache_.deliver(ticket, bytes, size) : deliver_opening(ticket, bytes, size);
}

sightcell_status sightcell_db::deliver_opening(std::uint32_t ticket, const void* bytes, std::uint32_t size) noexcept {
  delivery state = delivery::awaited;
  if (!opening_.state.compare_exchange_strong(state, delivery::arriving, std::memory_order_acquire))
    return SIGHTCELL_ERR_STALE;
  sightcell_status s = SIGHTCELL_OK;
  state = delivery::awaited;
  if (ticket != opening_.ticket) {
    s = SIGHTCELL_ERR_STALE;
  } else if (bytes == nullptr) {
    state = delivery::unreadable;
  } else if (size != opening_.target.size()) {
    s = size < opening_.target.size() ? SIGHTCELL_ERR_TRUNCATED : SIGHTCELL_ERR_CORRUPT;
  } else {
    std::copy_n(static_cast<const std::byte*>(bytes), size, opening_.target.data());
    state = delivery::arrived;
  }
  opening_.state.store(state, std::memory_order_release);
  return s;
}

void sightcell_db::close(sightcell_db* db) noexcept {
  if (db == nullptr) return;
  const sightcell_allocator mem = db->mem_;
  sightcell::runtime::release(mem, db->owned_bytes_, db->owned_size_);
  sightcell::runtime::release(mem, db->tables_, db->tables_size_);
  sightcell::runtime::release(mem, db, db->block_size_);
}

std::uint32_t sightcell_db::range_bound() const noexcept {
  return std::max(file_.range_bound(), whole_ranges_);
}

namespace {

// Returns whether a chunk is good. check() returns the status of its checksum; it is called at the first use only.
template <class Check>
bool is_sound(std::atomic<chunk_state>& state, const Check& check) noexcept {
  chunk_state known = state.load(std::memory_order_relaxed);
  if (known == chunk_state::unknown) {
    known = check() == format::status::ok ? chunk_state::good : chunk_state::damaged;
    state.store(known, std::memory_order_relaxed);
  }
  return known == chunk_state::good;
}

}  // namespace

bool sightcell_db::cell_is_sound(std::uint32_t cell) const noexcept {
  const std::uint32_t chunk = file_.chunk_of(cell);
  return is_sound(chunks_[chunk], [&] { return file_.check_chunk(chunk); });
}

sightcell_status sightcell_db::open_importance(std::uint32_t cell, format::importance_classes& out) const noexcept {
  if (const format::status s = file_.importance(out); s != format::status::ok) return static_cast<sightcell_status>(s);
  const std::uint32_t chunk = file_.chunk_of(cell);
  const bool sound = is_sound(chunks_[file_.chunk_count() + chunk], [&] { return out.check_chunk(chunk); });
  return sound ? SIGHTCELL_OK : SIGHTCELL_ERR_CHECKSUM;
}

row_outcome sightcell_db::decode(std::uint32_t cell, std::span<format::run> out, std::span<std::byte> scratch,
                                 format::row_parts& parts) const noexcept {
  if (!is_paged()) {
    if (!cell_is_sound(cell)) return row_outcome::damaged;
    const format::status s = file_.decode_row(cell, codes_, out, scratch, parts);
    return s == format::status::ok ? row_outcome::good : row_outcome::damaged;
  }
  const std::uint32_t chunk = file_.chunk_of(cell);
  std::span<const std::byte> bytes;
  chunk_presence presence = cache_.pin(chunk, bytes);
  if (presence == chunk_presence::absent) {
    cache_.request(chunk);
    presence = cache_.pin(chunk, bytes);  // a host that reads at once has delivered it
  }
  if (presence == chunk_presence::damaged) return row_outcome::damaged;
  if (presence != chunk_presence::resident) return row_outcome::pending;
  const format::status s = file_.decode_row(cell, bytes, codes_, out, scratch, parts);
  cache_.release(chunk);
  return s == format::status::ok ? row_outcome::good : row_outcome::damaged;
}

sightcell_status sightcell_db::check() const noexcept {
  if (is_paged()) return SIGHTCELL_ERR_IO;
  const auto carve_check = [this](void* block, std::span<format::run>& runs, std::span<std::byte>& scratch,
                                  std::span<std::uint32_t>& stored) {
    carver space(block);
    auto* first_run = space.take<format::run>(file_.run_bound());
    auto* first_number = space.take<std::uint32_t>(file_.check_room());
    auto* first_byte = space.take<std::byte>(file_.scratch_size());
    if (block == nullptr) return space.used();
    sightcell::runtime::construct(first_run, file_.run_bound());
    sightcell::runtime::construct(first_number, file_.check_room());
    sightcell::runtime::construct(first_byte, file_.scratch_size());
    runs = {first_run, file_.run_bound()};
    stored = {first_number, file_.check_room()};
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
