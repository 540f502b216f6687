#include "sightcell/format/named_group_table.h"

#include "checked_reader.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {

status named_group_table::open(std::span<const std::byte> bytes, std::uint32_t draws, named_group_table& out) noexcept {
  named_group_table made;
  const checked_reader in(bytes);
  std::uint32_t names_size = 0;
  if (!in.read_u32(0, made.count_) || !in.read_u32(4, names_size)) return status::corrupt;
  if (names_size > layout::max_names_size) return status::limit;
  std::span<const std::byte> left = bytes.subspan(layout::named_groups_head_size);
  // A name has at least one byte: a small file cannot claim many groups.
  if (made.count_ == 0 || made.count_ > names_size || names_size > left.size()) return status::corrupt;
  made.names_ = left.first(names_size);
  left = left.subspan(names_size);
  packed_columns ends;
  packed_columns groups;
  std::uint64_t size = 0;
  if (!packed_columns::size_of(left, 1, made.count_, size) ||
      !ends.open(left.first(static_cast<std::size_t>(size)), 1, made.count_) ||
      !groups.open(left.subspan(static_cast<std::size_t>(size)), 1, draws)) {
    return status::corrupt;
  }
  made.name_ends_ = packed_column(ends, 0);
  made.group_of_draw_ = packed_column(groups, 0);
  std::string_view unused;
  for (std::uint32_t group = 0; group < made.count_; ++group) {
    if (!made.name(group, unused)) return status::corrupt;
  }
  if (made.name_ends_[made.count_ - 1] != names_size) return status::corrupt;
  for (std::uint32_t draw = 0; draw < draws; ++draw) {
    if (std::uint32_t group = 0; !made.of_draw(draw, group)) return status::corrupt;
  }
  out = made;
  return status::ok;
}

bool named_group_table::name(std::uint32_t group, std::string_view& out) const noexcept {
  if (group >= count_) return false;
  const std::uint32_t begin = group == 0 ? 0 : name_ends_[group - 1];
  const std::uint32_t end = name_ends_[group];
  if (begin >= end || end > names_.size()) return false;
  out = {reinterpret_cast<const char*>(names_.data()) + begin, end - begin};
  return true;
}

bool named_group_table::of_draw(std::uint32_t draw, std::uint32_t& group) const noexcept {
  const std::uint32_t value = count_ == 0 ? 0 : group_of_draw_[draw];  // 0: none
  if (value > count_) return false;
  group = value - 1;  // no_named_group is one below the first
  return true;
}

}  // namespace sightcell::format
