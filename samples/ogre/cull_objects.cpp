#include "cull_objects.h"

namespace ogre_host {

cull_objects::cull_objects(const ogre_scene& scene, const matched_scene& matched)
    : scene_(scene), matched_(matched), view_(matched.make_view()), visible_(matched.draws.size() / 64 + 1) {}

void cull_objects::update(const Ogre::Camera& camera) {
  const sightcell_frame frame = move_view(view_, camera);
  if ((frame.flags & SIGHTCELL_FRAME_CHANGED) == 0) return;
  static_cast<void>(view_.objects(visible_));
  for (std::size_t e = 0; e < scene_.entities().size(); ++e) {
    const std::uint32_t draw = matched_.draw_of_entity[e];
    scene_.entities()[e]->setVisible((visible_[draw / 64] >> (draw % 64) & 1) != 0);
  }
}

}  // namespace ogre_host
