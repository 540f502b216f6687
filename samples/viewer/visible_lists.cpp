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

visible_lists::visible_lists(const baked_scene& baked, const draw_groups& groups) : baked_(baked), groups_(groups) {
  const std::vector<std::uint32_t>& indices = baked_.stored_indices;
  all_.fill(indices.size(),
            [&](std::span<std::uint32_t> to) { std::copy(indices.begin(), indices.end(), to.begin()); });
  all_.set_ranges(groups_, all_ranges(baked_.draws));
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
  rest_is_current_ = false;
  ranges_.clear();
  // Everything: the list is on the device already, so the copy that the runtime would make can be spared.
  if ((shown_.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0) return;
  ranges_.resize(baked_.range_bound);
  const sightcell::list_result got = view_->ranges(ranges_);
  require(got.status);
  ranges_.resize(got.count);
  set_.fill(3 * std::size_t{shown_.polygon_count},
            [&](std::span<std::uint32_t> to) { require(view_->indices(baked_.stored_indices, to).status); });
  set_.set_ranges(groups_, ranges_);
}

std::vector<painted_list> visible_lists::lists(bool pvs, bool tint) {
  const bool everything = !pvs || (shown_.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0;
  if (everything) return {{&all_}};
  if (!tint) return {{&set_}};
  if (!rest_is_current_) {
    const std::vector<sightcell_range> left_out = complement(baked_.draws, ranges_);
    std::vector<std::uint32_t> indices;
    gather_indices(baked_.draws, left_out, baked_.stored_indices, indices);
    rest_.fill(indices.size(),
               [&](std::span<std::uint32_t> to) { std::copy(indices.begin(), indices.end(), to.begin()); });
    rest_.set_ranges(groups_, left_out);
    rest_is_current_ = true;
  }
  return {{&set_}, {&rest_, left_out_color}};
}

}  // namespace viewer
