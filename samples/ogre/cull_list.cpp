#include "cull_list.h"

#include <algorithm>

namespace ogre_host {

cull_list::cull_list(const ogre_scene& scene, const matched_scene& matched, const imported_scene& host)
    : scene_(scene),
      matched_(matched),
      host_(host),
      view_(matched.make_view()),
      source_of_stored_(matched.info.polygon_count),
      ranges_(matched.info.range_bound) {
  static_cast<void>(matched.db.order(source_of_stored_));
}

void cull_list::update(const Ogre::Camera& camera) {
  const sightcell_frame frame = move_view(view_, camera);
  if ((frame.flags & SIGHTCELL_FRAME_CHANGED) == 0) return;
  if ((frame.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0) return scene_.draw_everything();
  const auto ranges = std::span<const sightcell_range>(ranges_).first(view_.ranges(ranges_).count);
  list_.clear();
  for (auto first = ranges.begin(); first != ranges.end();) {
    const auto last =
        std::find_if(first, ranges.end(), [draw = first->draw](const sightcell_range& r) { return r.draw != draw; });
    add_draw({first, last});
    first = last;
  }
  list_.draw(scene_);
}

// ranges: all those of one draw.
void cull_list::add_draw(std::span<const sightcell_range> ranges) {
  const sightcell_draw& draw = matched_.draws[ranges[0].draw];
  const std::uint32_t e = matched_.entity_of_draw[ranges[0].draw];
  const auto& triangle_of_source = matched_.triangles[matched_.triangles_of_entity[e]].of_source;
  const std::span<const std::uint32_t> indices = host_.indices[host_.draws[e].mesh];
  visible_.assign(indices.size() / 3, 0);
  for (const sightcell_range& r : ranges) {
    for (std::uint32_t i = draw.first_stored + r.first; i < draw.first_stored + r.first + r.count; ++i) {
      const auto triangle = triangle_of_source[source_of_stored_[i] - draw.first_source];
      if (triangle.exists()) visible_[triangle.triangle] = 1;
    }
  }
  for (auto first = visible_.begin(); (first = std::find(first, visible_.end(), 1)) != visible_.end();) {
    const auto last = std::find(first, visible_.end(), 0);
    list_.add(e, indices.subspan(3 * static_cast<std::size_t>(first - visible_.begin()),
                                 3 * static_cast<std::size_t>(last - first)));
    first = last;
  }
}

}  // namespace ogre_host
