#include "sightcell/format/identity_table.h"

#include <algorithm>

#include "checked_reader.h"

namespace sightcell::format {
namespace {

bool all_at_most(const packed_column& values, std::uint32_t rows, std::uint32_t most) noexcept {
  for (std::uint32_t row = 0; row < rows; ++row) {
    if (values[row] > most) return false;
  }
  return true;
}

status draws_with_polygons(const reader& file, std::uint32_t& count) noexcept {
  count = 0;
  for (std::uint32_t number = 0; number < file.draw_count(); ++number) {
    draw_record draw;
    if (const status s = file.draw(number, draw); s != status::ok) return s;
    count += draw.polygon_count > 0 ? 1 : 0;
  }
  return status::ok;
}

}  // namespace

bool name_walk::next() noexcept {
  if (done_ == names_) return false;
  const std::uint32_t shared = shared_[done_];
  const std::uint32_t further = further_[done_];
  if (shared > size_ || further == 0 || further > layout::max_draw_name - shared || further > texts_.size()) {
    done_ = names_;
    return false;
  }
  std::transform(texts_.begin(), texts_.begin() + further, text_.begin() + shared,
                 [](std::byte b) { return static_cast<char>(b); });
  texts_ = texts_.subspan(further);
  size_ = shared + further;
  ++done_;
  return true;
}

status identity_table::open(const reader& file, identity_table& out) noexcept {
  std::span<const std::byte> bytes;
  if (const status s = file.skipped_section(layout::section_identity, bytes); s != status::ok) return s;
  identity_table made;
  if (const status s = draws_with_polygons(file, made.draws_); s != status::ok) return s;
  const checked_reader in(bytes);
  std::uint32_t nodes = 0;
  std::uint32_t meshes = 0;
  if (!in.read_u32(0, made.hash_count_) || !in.read_u32(4, made.name_count_) || !in.read_u32(8, nodes) ||
      !in.read_u32(12, meshes)) {
    return status::corrupt;
  }
  // A small file cannot claim large tables: columns may have no bits.
  const std::uint64_t most = 8 * static_cast<std::uint64_t>(bytes.size());
  if (made.hash_count_ > made.draws_ || made.name_count_ > most || nodes > most || meshes > most) {
    return status::corrupt;
  }
  std::span<const std::byte> left = bytes.subspan(layout::identity_head_size);
  std::array<packed_column, 2> halves;
  std::array<packed_column, 2> sizes;
  if (!take_columns(left, made.draws_, {&made.hash_of_draw_, 1}) || !take_columns(left, made.hash_count_, halves) ||
      !take_columns(left, nodes, {&made.node_names_, 1}) || !take_columns(left, meshes, {&made.mesh_names_, 1}) ||
      !take_columns(left, made.name_count_, sizes)) {
    return status::corrupt;
  }
  made.low_ = halves[0];
  made.high_ = halves[1];
  made.shared_ = sizes[0];
  made.further_ = sizes[1];
  made.texts_ = left;
  if ((made.draws_ > 0 &&
       (made.hash_count_ == 0 || !all_at_most(made.hash_of_draw_, made.draws_, made.hash_count_ - 1))) ||
      !all_at_most(made.node_names_, nodes, made.name_count_) ||
      !all_at_most(made.mesh_names_, meshes, made.name_count_)) {
    return status::corrupt;
  }
  name_walk names = made.names();
  std::uint32_t read = 0;
  std::uint64_t size = 0;
  for (; names.next(); ++read) {
    size += made.further_[read];
    if (names.name().find('\0') != std::string_view::npos) return status::corrupt;
  }
  if (read != made.name_count_ || size != left.size()) return status::corrupt;
  out = made;
  return status::ok;
}

std::uint64_t identity_table::hash(std::uint32_t place) const noexcept {
  if (place >= draws_) return 0;
  const std::uint32_t number = hash_of_draw_[place];
  return low_[number] | std::uint64_t{high_[number]} << 32;
}

}  // namespace sightcell::format
