#pragma once
// The named groups of a file (SPEC.md, "Named groups"): what a host shows and hides by name, as a door or a switch.
// named_group_table_writer.h is the way back.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// A view of the section: cheap to copy, valid as long as the bytes are. Default-made: no group.
class named_group_table {
 public:
  // bytes: the section; draws: of the file. limit: names longer than layout.h has room for; corrupt. out is set only on
  // ok. O(groups + draws).
  [[nodiscard]] static status open(std::span<const std::byte> bytes, std::uint32_t draws,
                                   named_group_table& out) noexcept;

  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  // UTF-8 as the scene had it, without a zero at the end; points into the bytes. Any bytes may be in a damaged file,
  // and two groups may have one name there. False when there is no such group, or the bytes changed since open.
  [[nodiscard]] bool name(std::uint32_t group, std::string_view& out) const noexcept;
  // Which group a draw is in, no_named_group for none. False when the bytes changed since open.
  [[nodiscard]] bool of_draw(std::uint32_t draw, std::uint32_t& group) const noexcept;

 private:
  std::span<const std::byte> names_;
  packed_column name_ends_, group_of_draw_;
  std::uint32_t count_ = 0;
};

}  // namespace sightcell::format
