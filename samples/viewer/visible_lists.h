#pragma once
// The host's side of the runtime: one view that follows the camera, and the index lists on the device that follow it.
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "baked_scene.h"
#include "blended_order.h"
#include "scene_renderer.h"
#include "view_volume.h"

namespace viewer {

// Which lists to draw.
struct list_choice {
  bool pvs = true;                      // false: the whole scene
  bool objects = false;                 // all of each draw that has a polygon in the set
  bool tint = false;                    // beside it, marked, all that it leaves out
  const view_volume* volume = nullptr;  // leave out what it does not touch
};

struct chosen_lists {
  std::vector<painted_list> lists;
  std::span<const blended_run> blended;
  std::uint64_t polygons = 0;  // of the first list
  std::size_t ranges = 0;      // of the first list
};

class visible_lists {
 public:
  // References must outlive the object. positions: of the flattened scene; read during the call.
  visible_lists(const baked_scene& baked, const draw_groups& groups, std::span<const glm::vec3> positions);

  // Every frame: where the camera is. The lists follow unless they are frozen.
  void move(const glm::vec3& eye, bool frozen);

  // eye: from which blended polygons are sorted. Valid until the next call.
  chosen_lists choose(const list_choice& what, const glm::vec3& eye);
  const index_list& everything() const { return all_; }

  const sightcell_frame& here() const { return here_; }    // of the last move
  const sightcell_frame& shown() const { return shown_; }  // that the lists belong to
  const glm::vec3& shown_from() const { return shown_from_; }
  std::size_t range_count() const { return ranges_.size(); }
  double move_milliseconds() const { return move_milliseconds_; }      // of the last move
  double change_milliseconds() const { return change_milliseconds_; }  // of the last change: move, ranges, index list

 private:
  void rebuild();
  void fill_with(index_list& list, std::span<const sightcell_range> ranges);
  index_list& rest_of(bool objects);

  const baked_scene& baked_;
  const draw_groups& groups_;
  polygon_blocks blocks_;
  blended_order blended_;
  std::optional<sightcell::view> view_;
  index_list all_, set_, objects_, rest_, object_rest_;
  std::vector<sightcell_range> ranges_;
  sightcell_frame here_{}, shown_{};
  glm::vec3 shown_from_{0.0f};
  bool objects_are_current_ = false, rest_is_current_ = false, object_rest_is_current_ = false;
  double move_milliseconds_ = 0.0, change_milliseconds_ = 0.0;
};

}  // namespace viewer
