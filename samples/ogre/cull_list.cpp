#include "cull_list.h"

#include <algorithm>

#include "host_error.h"

namespace ogre_host {
namespace {

// Instances share an index buffer in stored order, so their orders must be the same.
bool same_order(const sightcell_draw& a, const sightcell_draw& b, const std::vector<std::uint32_t>& order) {
  for (std::uint32_t i = 0; i < a.polygon_count; ++i) {
    if (order[a.first_stored + i] - a.first_source != order[b.first_stored + i] - b.first_source) return false;
  }
  return true;
}

}  // namespace

cull_list::cull_list(const ogre_scene& scene, const matched_scene& matched, const imported_scene& host)
    : scene_(scene),
      matched_(matched),
      view_(matched.make_view()),
      stored_indices_(matched.triangles.size()),
      ranges_(matched.info.range_bound) {
  std::vector<std::uint32_t> order(matched.info.polygon_count);
  static_cast<void>(matched.db.order(order));
  std::vector<const sightcell_draw*> draw_of_list(stored_indices_.size(), nullptr);
  for (std::size_t e = 0; e < host.draws.size(); ++e) {
    is_blended_.push_back(scene.entities()[e]->getSubEntity(0)->getTechnique()->isTransparent());
    const sightcell_draw& draw = matched.draws[matched.draw_of_entity[e]];
    const std::uint32_t list = matched.triangles_of_entity[e];
    if (draw_of_list[list] == nullptr) {
      draw_of_list[list] = &draw;
      stored_indices_[list] =
          sightcell::hosts::permuted_indices(draw, order, matched.triangles[list], host.indices[host.draws[e].mesh]);
    } else if (!same_order(*draw_of_list[list], draw, order)) {
      throw host_error("ogre.per-instance", matched.file, "orders the triangles of each instance by themselves",
                       "bake it with --order per-mesh, or use the mode clusters");
    }
  }
}

void cull_list::update(const Ogre::Camera& camera) {
  const sightcell_frame frame = move_view(view_, camera);
  if ((frame.flags & SIGHTCELL_FRAME_CHANGED) == 0) return;
  if ((frame.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0) return scene_.draw_everything();
  const std::size_t count = view_.ranges(ranges_).count;
  list_.clear();
  for (const sightcell_range& r : std::span(ranges_).first(count)) {
    const std::uint32_t e = matched_.entity_of_draw[r.draw];
    const std::span<const std::uint32_t> indices = stored_indices_[matched_.triangles_of_entity[e]];
    list_.add(e, indices.subspan(3 * std::size_t{r.first}, 3 * std::size_t{r.count}));
  }
  list_.draw(scene_);
  // Blended triangles are drawn in the order of their mesh, so they stay together.
  for (std::size_t e = 0; e < is_blended_.size(); ++e) {
    if (is_blended_[e] && scene_.entities()[e]->isVisible()) scene_.draw_whole(e);
  }
}

}  // namespace ogre_host
