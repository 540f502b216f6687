#pragma once
// Visibility rule 3 for hemicubes: removes polygons that a hemicube shows only through light leaks.
#include <string>

#include "cell_set/cell_set.h"
#include "hemicube/hemicube_source.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Filters the results of another source. It tests the sight line through one pixel of each polygon that is not in the
// set and covers up to 4 S pixels, S being the resolution, which is what a line across the front face and the side
// faces covers. If that line passes a gap narrower than the tolerance, the polygon is removed from the view. With
// several views in one call the result is as if each view had joined the set before the next one was tested, so a
// polygon is tested only until one view shows it properly. Importance is not changed. Tests run on the calling
// thread's TBB arena. The set must not change during a call. References must outlive the filter.
class gap_filter final : public hemicube_source {
 public:
  gap_filter(hemicube_source& behind, const ray_scene& rays, const cell_set& set, float smallest_gap)
      : behind_(behind), rays_(rays), set_(set), smallest_gap_(smallest_gap) {}

  using hemicube_source::render;
  void render(std::span<const pose> poses, std::span<hemicube_view> views) override;
  void render_image(const pose& where, hemicube_image& image) override { behind_.render_image(where, image); }
  std::optional<double> device_seconds() const override { return behind_.device_seconds(); }
  std::uint32_t resolution() const override { return behind_.resolution(); }
  std::string device() const override { return behind_.device(); }

 private:
  // Returns whether the sight line through the polygon's pixel passes a light leak.
  bool through_gap(const pose& where, const seen_polygon& seen) const;

  hemicube_source& behind_;
  const ray_scene& rays_;
  const cell_set& set_;
  float smallest_gap_;
};

}  // namespace sightcell::bake
