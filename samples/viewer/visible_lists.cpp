#include "visible_lists.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "sightcell/base/error.h"

namespace viewer {
namespace {

constexpr glm::vec4 left_out_color(1.0f, 0.0f, 0.0f, 1.0f);

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void require(sightcell_status status) {
  if (status == SIGHTCELL_OK) return;
  throw sightcell::error(sightcell::error_kind::failed, "viewer.runtime", "runtime", sightcell_status_text(status),
                         "report this");
}

}  // namespace

visible_lists::visible_lists(const baked_scene& baked, const draw_groups& groups, std::span<const glm::vec3> positions)
    : baked_(baked),
      groups_(groups),
      blocks_(baked.draws, positions, baked.stored_indices),
      blended_(groups, baked.draws, positions, baked.stored_indices) {
  const std::vector<std::uint32_t>& indices = baked_.stored_indices;
  all_.fill(indices.size(),
            [&](std::span<std::uint32_t> to) { std::copy(indices.begin(), indices.end(), to.begin()); });
  all_.set_ranges(all_ranges(baked_.draws));
  here_.cell = shown_.cell = SIGHTCELL_NO_CELL;
  here_.flags = shown_.flags = SIGHTCELL_FRAME_DRAW_ALL;
  if (!baked_.db) return;
  auto created = sightcell::view::create(*baked_.db);
  require(created.status());
  view_ = std::move(*created);
}

void visible_lists::move(const glm::vec3& eye, bool frozen) {
  if (!view_) return;
  const auto start = std::chrono::steady_clock::now();
  // The only failure, a position that is no number, says DRAW_ALL in the frame.
  (void)view_->move(std::array<float, 3>{eye.x, eye.y, eye.z}, here_);
  move_milliseconds_ = milliseconds_since(start);
  if (frozen) return;
  shown_from_ = eye;
  // Not only where CHANGED is set: a change may have passed while the lists were frozen.
  if (here_.revision != shown_.revision) {
    shown_ = here_;
    rebuild();
    change_milliseconds_ = milliseconds_since(start);
  }
  shown_ = here_;
}

void visible_lists::rebuild() {
  objects_are_current_ = rest_is_current_ = object_rest_is_current_ = false;
  ranges_.clear();
  // Everything: the list is on the device already, so the copy that the runtime would make can be spared.
  if ((shown_.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0) return;
  ranges_.resize(baked_.range_bound);
  const sightcell::list_result got = view_->ranges(ranges_);
  require(got.status);
  ranges_.resize(got.count);
  set_.fill(3 * std::size_t{shown_.polygon_count},
            [&](std::span<std::uint32_t> to) { require(view_->indices(baked_.stored_indices, to).status); });
  set_.set_ranges(ranges_);
}

void visible_lists::fill_with(index_list& list, std::span<const sightcell_range> ranges) {
  std::vector<std::uint32_t> indices;
  gather_indices(baked_.draws, ranges, baked_.stored_indices, indices);
  list.fill(indices.size(),
            [&](std::span<std::uint32_t> to) { std::copy(indices.begin(), indices.end(), to.begin()); });
  list.set_ranges(ranges);
}

index_list& visible_lists::rest_of(bool objects) {
  bool& current = objects ? object_rest_is_current_ : rest_is_current_;
  index_list& list = objects ? object_rest_ : rest_;
  if (!current) fill_with(list, complement(baked_.draws, objects ? whole_draws(baked_.draws, ranges_) : ranges_));
  current = true;
  return list;
}

chosen_lists visible_lists::choose(const list_choice& what, const glm::vec3& eye) {
  std::vector<index_list*> lists;
  const bool everything = !what.pvs || (shown_.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0;
  if (everything) {
    lists.push_back(&all_);
  } else {
    if (what.objects && !objects_are_current_) fill_with(objects_, whole_draws(baked_.draws, ranges_));
    objects_are_current_ |= what.objects;
    lists.push_back(what.objects ? &objects_ : &set_);
    if (what.tint) lists.push_back(&rest_of(what.objects));
  }
  chosen_lists out;
  blended_.clear();
  for (std::uint32_t i = 0; i < lists.size(); ++i) {
    lists[i]->clip(groups_, blocks_, what.volume);
    blended_.add(lists[i]->parts(), i);
    out.lists.push_back({lists[i], i == 0 ? glm::vec4(0.0f) : left_out_color});
  }
  out.blended = blended_.sorted(eye);
  out.polygons = lists.front()->polygons();
  out.ranges = lists.front()->parts().size();
  return out;
}

}  // namespace viewer
