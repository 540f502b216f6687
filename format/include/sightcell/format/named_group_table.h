#pragma once
// The named groups of a file (SPEC.md, "Named groups"): draws that a host shows and hides by name, such as a door. The
// counterpart for writing is named_group_table_writer.h.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// A view of the section: cheap to copy, valid as long as the bytes are. Default-constructed: no group.
class named_group_table {
 public:
  // Opens a section. bytes: the section and nothing after it. draws: of the file. out: set only on ok. limit: names
  // longer than the limit of layout.h; corrupt. O(groups + draws).
  [[nodiscard]] static status open(std::span<const std::byte> bytes, std::uint32_t draws,
                                   named_group_table& out) noexcept;

  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }

  // The name of a group as in the scene, in UTF-8 without a zero at the end; points into the bytes. A damaged file may
  // have any bytes here, and two groups with one name. False if there is no such group, or the bytes changed since
  // open.
  [[nodiscard]] bool name(std::uint32_t group, std::string_view& out) const noexcept;

  // The group of a draw, no_named_group if it is in none. False if the bytes changed since open.
  [[nodiscard]] bool of_draw(std::uint32_t draw, std::uint32_t& group) const noexcept;

 private:
  std::span<const std::byte> names_;
  packed_column name_ends_, group_of_draw_;
  std::uint32_t count_ = 0;
};

}  // namespace sightcell::format
