#pragma once
// Draws the visible clusters of the host's own meshes, and culls clusters by the frustum too. Index buffers keep their
// order. An engine that draws meshlets on the GPU uploads the row of bits instead of making an index list.
#include <cstdint>
#include <vector>

#include "culling.h"
#include "index_list.h"
#include "matched_scene.h"
#include "ogre_scene.h"

namespace ogre_host {

class cull_clusters final : public culling {
 public:
  static constexpr std::uint32_t triangles_per_cluster = 128;

  // with_pvs: false culls by the frustum alone, to see what the PVS adds to it.
  cull_clusters(const ogre_scene& scene, const matched_scene& matched, const imported_scene& host, bool with_pvs);
  void update(const Ogre::Camera& camera) override;

 private:
  const ogre_scene& scene_;
  const imported_scene& host_;
  bool with_pvs_;
  sightcell::view view_;
  sightcell::cluster_map map_;
  std::vector<std::uint32_t> first_cluster_;                // by entity, and one more
  std::vector<Ogre::AxisAlignedBox> entity_boxes_, boxes_;  // by entity and by cluster, in world space
  std::vector<std::uint32_t> visible_;                      // a bit per cluster
  index_list list_;
};

}  // namespace ogre_host
