#include "lights.h"

#include <algorithm>
#include <new>

#include "index_list.h"
#include "ranges.h"

using namespace sightcell::runtime;
namespace format = sightcell::format;

std::uint64_t sightcell_lights::carve(void* block) noexcept {
  carver space(block);
  space.take<sightcell_lights>(1);
  const auto take = [&]<class T>(std::span<T>& out, std::uint64_t count) {
    T* first = space.take<T>(count);
    if (first == nullptr) return;
    construct(first, count);
    out = {first, static_cast<std::size_t>(count)};
  };
  const std::uint64_t runs = std::max<std::uint64_t>(table_.sets().run_bound(), 1);  // one has everything
  take(row_, runs);
  take(hidden_, db_->named_range_count());
  take(runs_, runs + db_->named_range_count());  // a hidden run splits one run at most
  static_cast<void>(space.take<std::uint64_t>(0));
  take(codes_memory_, db_->file().codes_size());
  static_cast<void>(space.take<std::uint32_t>(0));
  take(scratch_, table_.sets().scratch_size());
  return space.used();
}

sightcell_status sightcell_lights::create(const sightcell_db& db, sightcell_lights** out) noexcept {
  if (db.is_paged()) return SIGHTCELL_ERR_ABSENT;
  sightcell_lights plan;
  plan.db_ = &db;
  const format::status opened = format::light_table::open(db.file(), plan.table_);
  if (opened != format::status::ok) return static_cast<sightcell_status>(opened);
  const std::uint64_t size = plan.carve(nullptr);
  void* block = allocate(db.allocator(), size);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* lights = new (block) sightcell_lights(plan);
  lights->block_size_ = size;
  static_cast<void>(lights->carve(block));
  const format::status made = lights->table_.sets().make_codes(lights->codes_memory_, lights->codes_);
  if (made != format::status::ok) {
    destroy(lights);
    return static_cast<sightcell_status>(made);
  }
  *out = lights;
  return SIGHTCELL_OK;
}

void sightcell_lights::destroy(sightcell_lights* lights) noexcept {
  if (lights != nullptr) release(lights->db_->allocator(), lights, lights->block_size_);
}

bool sightcell_lights::touches(const sightcell_view& view, std::uint32_t light) const noexcept {
  const std::span<const std::uint32_t> cells = view.shown_cells();  // none: everything is shown
  return cells.empty() ||
         std::any_of(cells.begin(), cells.end(), [&](std::uint32_t cell) { return table_.touches(cell, light); });
}

// Runs that touch are one.
std::span<const format::run> sightcell_lights::hidden_in(const sightcell_view& view) noexcept {
  if (hidden_.empty()) return {};
  const range_borders borders = db_->range_borders();
  std::size_t count = 0;
  for (std::uint32_t draw = 0; draw + 1 < borders.size() && count < hidden_.size(); ++draw) {
    const format::run whole{borders[draw], borders[draw + 1] - borders[draw]};
    if (whole.count > 0 && view.is_hidden(draw)) hidden_[count++] = whole;
  }
  return hidden_.first(count);
}

std::span<const format::run> sightcell_lights::lit_set(const sightcell_view& view, std::uint32_t light) noexcept {
  std::size_t count = 0;
  if (table_.sets().decode(light, codes_, row_, scratch_, count) != format::status::ok) {
    row_[0] = {0, db_->polygon_count()};
    count = row_[0].count > 0 ? 1 : 0;
  }
  return runs_.first(write_difference(row_.first(count), hidden_in(view), runs_));
}

namespace {

// Checks what all outputs of lights take.
bool can_list(const sightcell_view* view, const sightcell_lights* lights, const void* dst, std::size_t capacity,
              const std::size_t* count) noexcept {
  return view != nullptr && lights != nullptr && &lights->db() == &view->db() && count != nullptr &&
         (dst != nullptr || capacity == 0);
}

}  // namespace

sightcell_status sightcell_lights_create(const sightcell_db* db, sightcell_lights** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  return sightcell_lights::create(*db, out);
}

void sightcell_lights_destroy(sightcell_lights* lights) {
  sightcell_lights::destroy(lights);
}

sightcell_status sightcell_lights_list(const sightcell_lights* lights, sightcell_light* dst, size_t capacity,
                                       size_t* count) {
  if (lights == nullptr || count == nullptr || (dst == nullptr && capacity > 0)) return SIGHTCELL_ERR_ARGUMENT;
  *count = lights->table().light_count();
  if (*count > capacity) return SIGHTCELL_ERR_CAPACITY;
  for (std::uint32_t i = 0; i < *count; ++i) {
    format::light_record light;
    format::certificate_record proof;
    proof.upper_bound = 1.0;
    static_cast<void>(lights->table().light(i, light));  // these fail if the bytes changed since open
    static_cast<void>(lights->table().sets().certificate(i, i, proof));
    dst[i].node = light.node;
    std::copy(light.position.begin(), light.position.end(), dst[i].position);
    std::copy(light.direction.begin(), light.direction.end(), dst[i].direction);
    dst[i].range = light.range;
    dst[i].cone = light.cone;
    dst[i].error_bound = static_cast<float>(proof.upper_bound);
  }
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_lights(const sightcell_view* view, const sightcell_lights* lights, uint32_t* dst,
                                       size_t capacity, size_t* count) {
  if (!can_list(view, lights, dst, capacity, count)) return SIGHTCELL_ERR_ARGUMENT;
  *count = 0;
  for (std::uint32_t i = 0; i < lights->table().light_count(); ++i) {
    if (!lights->touches(*view, i)) continue;
    if (*count < capacity) dst[*count] = i;
    ++*count;
  }
  return *count > capacity ? SIGHTCELL_ERR_CAPACITY : SIGHTCELL_OK;
}

sightcell_status sightcell_view_light_ranges(const sightcell_view* view, sightcell_lights* lights, uint32_t light,
                                             sightcell_range* dst, size_t capacity, size_t* count) {
  if (!can_list(view, lights, dst, capacity, count) || light >= lights->table().light_count())
    return SIGHTCELL_ERR_ARGUMENT;
  *count = write_ranges(lights->lit_set(*view, light), view->db().range_borders(), {dst, capacity});
  return *count > capacity ? SIGHTCELL_ERR_CAPACITY : SIGHTCELL_OK;
}

sightcell_status sightcell_view_light_indices(const sightcell_view* view, sightcell_lights* lights, uint32_t light,
                                              const uint32_t* stored_indices, uint32_t* dst, size_t capacity,
                                              size_t* count) {
  if (!can_list(view, lights, dst, capacity, count) || light >= lights->table().light_count())
    return SIGHTCELL_ERR_ARGUMENT;
  return write_indices(lights->lit_set(*view, light), stored_indices, dst, capacity, count);
}
