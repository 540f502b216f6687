#pragma once
// From the ranges that the runtime hands out to as few draw calls as there are kinds of surfaces. No OpenGL here.
//
// The viewer keeps the scene flattened into world space, so a cell set is one index list: sightcell_view_indices copies
// it in the order of the ranges. What is left is to say which stretches of that list are drawn with which state: one
// per visible draw at most, however many thousand ranges there are, and one glMultiDrawElements per group of them.
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.h"

namespace viewer {

// All draws that are drawn with one state.
struct draw_group {
  sightcell::scene::alpha_mode alpha = sightcell::scene::alpha_mode::opaque;
  bool double_sided = false;
  std::uint32_t material = 0;  // into scene::materials; one behind the last: glTF's default material
};

class draw_groups {
 public:
  // draws: the draw table of the file, which has an order of its own.
  draw_groups(const sightcell::scene::scene& s, std::span<const sightcell_draw> draws);
  // Opaque groups first, then mask, then blend, which needs all others behind it.
  const std::vector<draw_group>& groups() const { return groups_; }
  std::uint32_t group_of_draw(std::uint32_t draw) const { return group_of_draw_[draw]; }

 private:
  std::vector<draw_group> groups_;
  std::vector<std::uint32_t> group_of_draw_;
};

// Stretches of an index list that are drawn with the state of one group, as glMultiDrawElements takes them.
struct group_stretches {
  std::vector<std::int32_t> counts;  // indices
  std::vector<const void*> offsets;  // bytes from the list's start
};

// A range and where its indices begin in an index list.
struct list_part {
  sightcell_range range;
  std::uint64_t at = 0;  // in polygons
};

// The parts of a list that holds the indices of ranges, as sightcell_view_ranges gives them, back to back.
std::vector<list_part> parts_of(std::span<const sightcell_range> ranges);

// One element per group. Parts that follow each other in the list and have one state are joined.
void make_stretches(const draw_groups& groups, std::span<const list_part> parts, std::vector<group_stretches>& out);

// All polygons of each draw that has a range: what a host draws that culls whole objects.
std::vector<sightcell_range> whole_draws(std::span<const sightcell_draw> draws,
                                         std::span<const sightcell_range> ranges);

// The ranges of all that the given ranges leave out, in the same order.
std::vector<sightcell_range> complement(std::span<const sightcell_draw> draws, std::span<const sightcell_range> ranges);

// What sightcell_view_indices would copy for these ranges.
void gather_indices(std::span<const sightcell_draw> draws, std::span<const sightcell_range> ranges,
                    std::span<const std::uint32_t> stored_indices, std::vector<std::uint32_t>& out);

std::uint64_t polygons_in(std::span<const sightcell_range> ranges);
std::uint64_t polygons_in(std::span<const list_part> parts);

}  // namespace viewer
