#pragma once
// Rule 3 of seeing for hemicubes: what a hemicube sees only through cracks is taken out of its answer.
#include <string>

#include "cell_set/cell_set.h"
#include "hemicube/hemicube_source.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// A source in front of another. Of every polygon that is new to the set and covers no more pixels than a line over
// front and side faces has, four times the hemicube's width, the sight line through one of them is tested; through a
// crack the polygon is dropped from this view. Of several views in one call the answer is as if each had joined the set
// before the next was tested, so a polygon is tested only until one of them really sees it. Importance stays as it was.
// Tests run on the calling thread's TBB arena; the set must not change meanwhile. References must outlive it.
class gap_filter final : public hemicube_source {
 public:
  gap_filter(hemicube_source& behind, const ray_scene& rays, const cell_set& set, float smallest_gap)
      : behind_(behind), rays_(rays), set_(set), smallest_gap_(smallest_gap) {}

  using hemicube_source::render;
  void render(std::span<const pose> poses, std::span<hemicube_view> views) override;
  void render_image(const pose& where, hemicube_image& image) override { behind_.render_image(where, image); }
  bool shared() const override { return behind_.shared(); }
  std::uint32_t resolution() const override { return behind_.resolution(); }
  std::string device() const override { return behind_.device(); }

 private:
  bool through_gap(const pose& where, const seen_polygon& seen) const;

  hemicube_source& behind_;
  const ray_scene& rays_;
  const cell_set& set_;
  float smallest_gap_;
};

}  // namespace sightcell::bake
