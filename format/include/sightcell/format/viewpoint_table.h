#pragma once
// The viewpoints of a file (SPEC.md, "Viewpoints"): the camera positions of each cell that its certificate is about.
// The counterpart for writing is viewpoint_table_writer.h.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/layout.h"
#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// A part of the grown box of a cell: a leaf of the tree of its region. The parts of a cell are disjoint and fill the
// grown box.
struct region_part {
  box bounds;
  bool inside = false;  // whether it belongs to the region
};

// The box of a cell grown by margin meters on all sides, in f32.
[[nodiscard]] box grown_box(const box& cell, float margin) noexcept;

// Lists the parts of one region in the order of its bytes. It reads each node once, and keeps at most 19 nodes.
//
//   region_walk walk(bytes, grown);
//   for (region_part part; walk.next(part);) use(part);
//   if (walk.result() != status::ok) return walk.result();
class region_walk {
 public:
  // bytes: the region of a cell and nothing after it. Without bytes, the region is the whole box. grown: grown_box() of
  // the cell.
  region_walk(std::span<const std::byte> bytes, const box& grown) noexcept;

  // False after the last part, and at the first fault of the bytes. The parts before a fault have been returned then.
  [[nodiscard]] bool next(region_part& out) noexcept;

  // After next returned false. ok; corrupt: no valid tree; limit: more bytes than the limit of layout.h.
  [[nodiscard]] status result() const noexcept { return result_; }

 private:
  struct node {
    box bounds;
    std::uint32_t depth = 0;
  };

  [[nodiscard]] bool read_kind(std::uint32_t& out) noexcept;
  [[nodiscard]] bool split(const node& parent) noexcept;
  [[nodiscard]] bool ends_well() const noexcept;
  bool stop(status result) noexcept;

  std::span<const std::byte> bytes_;
  std::array<node, layout::max_region_depth + 1> waiting_;  // the next one is the last
  std::size_t waiting_count_ = 0;
  std::uint64_t nodes_ = 0;  // that were read
  bool any_inside_ = false;
  status result_ = status::ok;
};

// A view of the section: cheap to copy, valid as long as the bytes are. Default-constructed: a file without it.
class viewpoint_table {
 public:
  // Opens a section. bytes: the section and nothing after it. cells: of the file. out: set only on ok. limit: a region
  // larger than the limit of layout.h; corrupt. O(cells): it does not check the trees of the regions.
  [[nodiscard]] static status open(std::span<const std::byte> bytes, std::uint32_t cells,
                                   viewpoint_table& out) noexcept;

  // Whether the file has the section.
  [[nodiscard]] bool exists() const noexcept { return player_radius_ > 0.0f; }

  // The distance in meters that valid viewpoints keep from surfaces. 0 without the section.
  [[nodiscard]] float player_radius() const noexcept { return player_radius_; }

  // The estimated share of the region of a cell that is valid viewpoints, in (0, 1]. 1 without the section; any value
  // for a cell that does not exist, or if the bytes changed since open.
  [[nodiscard]] float valid_share(std::uint32_t cell) const noexcept;

  // The upper limit, at 95 % confidence, of the share of the valid viewpoints of a cell that are outside its region,
  // 0 .. 1. 0 without the section; else as valid_share.
  [[nodiscard]] float outside_share(std::uint32_t cell) const noexcept;

  // The bytes of the region of a cell, for region_walk. Empty: the region is the whole grown box. Empty also for a cell
  // that does not exist, and if the bytes changed since open: parts() returns a status for these.
  [[nodiscard]] std::span<const std::byte> region_bytes(std::uint32_t cell) const noexcept;

  // Calls take(const region_part&) for each part of the grown box of a cell. grown: grown_box() of the cell. argument:
  // no such cell, or no section; corrupt: no valid tree, and take has had the parts before the fault. O(bytes of the
  // region).
  template <class Take>
  [[nodiscard]] status parts(std::uint32_t cell, const box& grown, const Take& take) const noexcept {
    return walk_parts(
        cell, grown, [](const void* caller, const region_part& part) { (*static_cast<const Take*>(caller))(part); },
        &take);
  }

 private:
  // Not a template, so that a module for web pages has the walk once.
  [[nodiscard]] status walk_parts(std::uint32_t cell, const box& grown,
                                  void (*take)(const void* caller, const region_part& part),
                                  const void* caller) const noexcept;
  [[nodiscard]] status find(std::uint32_t cell, std::span<const std::byte>& out) const noexcept;

  std::span<const std::byte> regions_;
  packed_column valid_, outside_, region_ends_;
  float player_radius_ = 0.0f;
  std::uint32_t cells_ = 0;
};

}  // namespace sightcell::format
