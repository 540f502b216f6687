#include "residency.h"

#include <algorithm>
#include <bit>
#include <new>

#include "cell_box.h"

using namespace sightcell::runtime;
namespace format = sightcell::format;

namespace {

// Returns ceil(4 log2(ratio)). ratio: above 0, its fourth power a normal number.
int quarters_finer(double ratio) noexcept {
  const double power = ratio * ratio * ratio * ratio;
  const auto bits = std::bit_cast<std::uint64_t>(power);
  const int exponent = static_cast<int>(bits >> 52 & 0x7FFu) - 1023;
  return (bits & ((std::uint64_t{1} << 52) - 1)) != 0 ? exponent + 1 : exponent;
}

// number: of a level, not no_level. finer: in quarters.
std::uint8_t whole_level(std::uint8_t number, int finer, const format::texture_record& texture) noexcept {
  // The finest number may stand for any finer one.
  if (number == format::finest_level) return 0;
  const int quarters = number - format::level_zero - finer;
  const int last = (format::coarsest_level(texture) - format::level_zero) / format::quarters_of_level;
  return static_cast<std::uint8_t>(std::clamp(quarters / format::quarters_of_level, 0, last));
}

bool is_density(float pixels_per_radian) noexcept {
  return pixels_per_radian > 0.0f && pixels_per_radian <= format::layout::max_pixels_per_radian;
}

}  // namespace

std::uint64_t sightcell_residency::carve(void* block) noexcept {
  carver space(block);
  space.take<sightcell_residency>(1);
  const auto take = [&]<class T>(std::span<T>& out, std::uint64_t count) {
    T* first = space.take<T>(count);
    if (first == nullptr) return;
    construct(first, count);
    out = {first, static_cast<std::size_t>(count)};
  };
  static_cast<void>(space.take<std::uint64_t>(0));
  take(codes_memory_, format::residency_table::codes_size());
  take(of_cell_, table_.texture_count());
  take(finest_, table_.texture_count());
  return space.used();
}

sightcell_status sightcell_residency::create(const sightcell_db& db, sightcell_residency** out) noexcept {
  sightcell_residency plan;
  plan.db_ = &db;
  const format::status opened = format::residency_table::open(db.file(), plan.table_);
  if (opened != format::status::ok) return static_cast<sightcell_status>(opened);
  const std::uint64_t size = plan.carve(nullptr);
  void* block = allocate(db.allocator(), size);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* residency = new (block) sightcell_residency(plan);
  residency->block_size_ = size;
  static_cast<void>(residency->carve(block));
  format::status made = residency->table_.make_codes(residency->codes_memory_, residency->codes_);
  if (made == format::status::ok) made = residency->table_.check(residency->codes_, residency->of_cell_);
  if (made != format::status::ok) {
    destroy(residency);
    return static_cast<sightcell_status>(made);
  }
  *out = residency;
  return SIGHTCELL_OK;
}

void sightcell_residency::destroy(sightcell_residency* residency) noexcept {
  if (residency != nullptr) release(residency->db_->allocator(), residency, residency->block_size_);
}

// False if the levels of the cell are damaged.
bool sightcell_residency::add(std::uint32_t cell) noexcept {
  if (table_.decode(cell, codes_, of_cell_) != format::status::ok) return false;
  for (std::size_t i = 0; i < finest_.size(); ++i) {
    if (of_cell_[i] == format::no_level) continue;
    if (finest_[i] == format::no_level || of_cell_[i] < finest_[i]) finest_[i] = of_cell_[i];
  }
  return true;
}

// known: the cells were added; else everything is needed.
void sightcell_residency::write(bool known, float pixels_per_radian, std::uint8_t* dst) const noexcept {
  const int finer =
      quarters_finer(static_cast<double>(pixels_per_radian) / static_cast<double>(table_.pixels_per_radian()));
  for (std::uint32_t i = 0; i < finest_.size(); ++i) {
    if (!known)
      dst[i] = 0;
    else if (finest_[i] == format::no_level)
      dst[i] = SIGHTCELL_NO_LEVEL;
    else
      dst[i] = whole_level(finest_[i], finer, table_.texture(i));
  }
}

void sightcell_residency::levels_of(std::uint32_t cell, float pixels_per_radian, std::uint8_t* dst) noexcept {
  std::fill(finest_.begin(), finest_.end(), format::no_level);
  write(add(cell), pixels_per_radian, dst);
}

// Where a paged view still shows other cells, the camera is in its own one.
void sightcell_residency::levels_of(const sightcell_view& view, float pixels_per_radian, std::uint8_t* dst) noexcept {
  std::fill(finest_.begin(), finest_.end(), format::no_level);
  bool known = !view.shown_cells().empty();
  for (const std::uint32_t cell : view.shown_cells()) known = known && add(cell);
  if (known && view.cell() != no_cell) known = add(view.cell());
  write(known, pixels_per_radian, dst);
}

namespace {

// Checks what both lists of levels take, and sets count.
sightcell_status check_levels(const sightcell_residency* residency, float pixels_per_radian, const std::uint8_t* dst,
                              std::size_t capacity, std::size_t* count) noexcept {
  if (residency == nullptr || count == nullptr || (dst == nullptr && capacity > 0) || !is_density(pixels_per_radian))
    return SIGHTCELL_ERR_ARGUMENT;
  *count = residency->table().texture_count();
  return *count > capacity ? SIGHTCELL_ERR_CAPACITY : SIGHTCELL_OK;
}

}  // namespace

sightcell_status sightcell_residency_create(const sightcell_db* db, sightcell_residency** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  if (db == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  if (!db->is_open()) return SIGHTCELL_PENDING;
  return sightcell_residency::create(*db, out);
}

void sightcell_residency_destroy(sightcell_residency* residency) {
  sightcell_residency::destroy(residency);
}

sightcell_status sightcell_residency_textures(const sightcell_residency* residency, sightcell_texture* dst,
                                              size_t capacity, size_t* count) {
  if (residency == nullptr || count == nullptr || (dst == nullptr && capacity > 0)) return SIGHTCELL_ERR_ARGUMENT;
  *count = residency->table().texture_count();
  if (*count > capacity) return SIGHTCELL_ERR_CAPACITY;
  for (std::uint32_t i = 0; i < *count; ++i) {
    const format::texture_record texture = residency->table().texture(i);
    dst[i] = {texture.image, texture.width, texture.height};
  }
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view_texture_levels(const sightcell_view* view, sightcell_residency* residency,
                                               float pixels_per_radian, uint8_t* dst, size_t capacity, size_t* count) {
  if (view == nullptr || residency == nullptr || &residency->db() != &view->db()) return SIGHTCELL_ERR_ARGUMENT;
  const sightcell_status s = check_levels(residency, pixels_per_radian, dst, capacity, count);
  if (s == SIGHTCELL_OK) residency->levels_of(*view, pixels_per_radian, dst);
  return s;
}

sightcell_status sightcell_residency_cell_levels(sightcell_residency* residency, uint32_t cell, float pixels_per_radian,
                                                 uint8_t* dst, size_t capacity, size_t* count) {
  if (residency == nullptr || cell >= residency->db().file().cell_count()) return SIGHTCELL_ERR_ARGUMENT;
  const sightcell_status s = check_levels(residency, pixels_per_radian, dst, capacity, count);
  if (s == SIGHTCELL_OK) residency->levels_of(cell, pixels_per_radian, dst);
  return s;
}
