#include "cull_clusters.h"

#include <algorithm>

namespace ogre_host {
namespace {

constexpr std::size_t indices_per_cluster = 3 * std::size_t{cull_clusters::triangles_per_cluster};

std::span<const std::uint32_t> cluster_of(std::span<const std::uint32_t> mesh, std::size_t number) {
  const std::size_t first = number * indices_per_cluster;
  return mesh.subspan(first, std::min(indices_per_cluster, mesh.size() - first));
}

Ogre::AxisAlignedBox box_of(std::span<const std::uint32_t> indices, const aiMesh& mesh, const Ogre::Affine3& to_world) {
  Ogre::AxisAlignedBox box;
  for (const std::uint32_t i : indices) {
    const aiVector3D& p = mesh.mVertices[i];
    box.merge(to_world * Ogre::Vector3(p.x, p.y, p.z));
  }
  return box;
}

}  // namespace

cull_clusters::cull_clusters(const ogre_scene& scene, const matched_scene& matched, const imported_scene& host,
                             bool with_pvs)
    : scene_(scene), host_(host), with_pvs_(with_pvs), view_(matched.make_view()) {
  std::vector<std::uint32_t> cluster_of_source(matched.info.polygon_count, SIGHTCELL_NO_CLUSTER);
  for (std::size_t e = 0; e < host.draws.size(); ++e) {
    const std::uint32_t mesh = host.draws[e].mesh;
    const auto first = static_cast<std::uint32_t>(boxes_.size());
    first_cluster_.push_back(first);
    const Ogre::Affine3& to_world = scene.entities()[e]->getParentNode()->_getFullTransform();
    Ogre::AxisAlignedBox& whole = entity_boxes_.emplace_back();
    for (std::size_t i = 0; i < host.indices[mesh].size(); i += indices_per_cluster) {
      const auto cluster = cluster_of(host.indices[mesh], i / indices_per_cluster);
      boxes_.push_back(box_of(cluster, *host.scene->mMeshes[mesh], to_world));
      whole.merge(boxes_.back());
    }
    std::uint32_t source = matched.draws[matched.draw_of_entity[e]].first_source;
    for (const auto& triangle : matched.triangles[matched.triangles_of_entity[e]].of_source) {
      if (triangle.exists()) cluster_of_source[source] = first + triangle.triangle / triangles_per_cluster;
      ++source;
    }
  }
  const auto clusters = static_cast<std::uint32_t>(boxes_.size());
  first_cluster_.push_back(clusters);
  map_ = std::move(*sightcell::cluster_map::create(matched.db, cluster_of_source, clusters));
  visible_.assign(clusters / 32 + 1, ~0u);
}

void cull_clusters::update(const Ogre::Camera& camera) {
  const sightcell_frame frame = move_view(view_, camera);
  if (with_pvs_ && (frame.flags & SIGHTCELL_FRAME_CHANGED) != 0) static_cast<void>(view_.clusters(map_, visible_));
  list_.clear();
  for (std::size_t e = 0; e < scene_.entities().size(); ++e) {
    if (!camera.isVisible(entity_boxes_[e])) continue;
    for (std::uint32_t c = first_cluster_[e]; c < first_cluster_[e + 1]; ++c) {
      if ((visible_[c / 32] >> (c % 32) & 1) == 0 || !camera.isVisible(boxes_[c])) continue;
      list_.add(e, cluster_of(host_.indices[host_.draws[e].mesh], c - first_cluster_[e]));
    }
  }
  list_.draw(scene_);
}

}  // namespace ogre_host
