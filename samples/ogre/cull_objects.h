#pragma once
// Shows and hides whole entities. For scenes of many objects; needs nothing of their meshes.
#include <cstdint>
#include <vector>

#include "culling.h"
#include "matched_scene.h"
#include "ogre_scene.h"

namespace ogre_host {

class cull_objects final : public culling {
 public:
  cull_objects(const ogre_scene& scene, const matched_scene& matched);
  void update(const Ogre::Camera& camera) override;

 private:
  const ogre_scene& scene_;
  const matched_scene& matched_;
  sightcell::view view_;
  std::vector<std::uint64_t> visible_;  // a bit per draw of the file
};

}  // namespace ogre_host
