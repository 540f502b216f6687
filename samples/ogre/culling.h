#pragma once
// The ways in which an OGRE host draws with Sightcell. Copy one of them. Each is called once per frame, before the
// scene is rendered, and leaves it to OGRE to cull whole entities by the frustum.
#include <Ogre.h>

#include <span>

#include "sightcell/sightcell.hpp"

namespace ogre_host {

// Moves a view to a camera, once per frame.
inline sightcell_frame move_view(sightcell::view& view, const Ogre::Camera& camera) {
  const Ogre::Vector3 eye = camera.getDerivedPosition();
  sightcell_frame frame{};
  static_cast<void>(view.move(std::span<const float, 3>(eye.ptr(), 3), frame));
  return frame;
}

class culling {
 public:
  virtual ~culling() = default;

  // Lets the scene draw what is visible from a camera.
  virtual void update(const Ogre::Camera& camera) = 0;
};

}  // namespace ogre_host
