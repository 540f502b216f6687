#pragma once
// Draws the visible triangles alone: an index list per entity, in one dynamic buffer that is filled where the set
// changes.
#include <cstdint>
#include <vector>

#include "culling.h"
#include "index_list.h"
#include "matched_scene.h"
#include "ogre_scene.h"

namespace ogre_host {

class cull_list final : public culling {
 public:
  // Throws host_error for a file that orders the triangles of each instance differently.
  cull_list(const ogre_scene& scene, const matched_scene& matched, const imported_scene& host);
  void update(const Ogre::Camera& camera) override;

 private:
  const ogre_scene& scene_;
  const matched_scene& matched_;
  sightcell::view view_;
  std::vector<std::vector<std::uint32_t>> stored_indices_;  // by element of matched_scene::triangles: in stored order
  std::vector<bool> is_blended_;                            // by entity
  std::vector<sightcell_range> ranges_;
  index_list list_;
};

}  // namespace ogre_host
