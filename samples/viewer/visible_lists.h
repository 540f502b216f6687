#pragma once
// The host's side of the runtime: one view that follows the camera, and the index lists on the device that follow it.
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "baked_scene.h"
#include "scene_renderer.h"

namespace viewer {

class visible_lists {
 public:
  // References must outlive the object.
  visible_lists(const baked_scene& baked, const draw_groups& groups);

  // Every frame: where the camera is. The lists follow unless they are frozen.
  void move(const glm::vec3& eye, bool frozen);

  // What to draw: the whole scene, the cell set, or the cell set and beside it, marked, all that it leaves out.
  std::vector<painted_list> lists(bool pvs, bool tint);

  const sightcell_frame& here() const { return here_; }    // of the last move
  const sightcell_frame& shown() const { return shown_; }  // that the lists belong to
  const glm::vec3& shown_from() const { return shown_from_; }
  std::size_t range_count() const { return ranges_.size(); }
  double move_milliseconds() const { return move_milliseconds_; }      // of the last move
  double change_milliseconds() const { return change_milliseconds_; }  // of the last change: move, ranges, index list

 private:
  void rebuild();

  const baked_scene& baked_;
  const draw_groups& groups_;
  std::optional<sightcell::view> view_;
  index_list all_, set_, rest_;
  std::vector<sightcell_range> ranges_;
  sightcell_frame here_{}, shown_{};
  glm::vec3 shown_from_{0.0f};
  bool rest_is_current_ = false;
  double move_milliseconds_ = 0.0, change_milliseconds_ = 0.0;
};

}  // namespace viewer
