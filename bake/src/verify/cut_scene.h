#pragma once
// A scene with the levels of detail of its clusters (cluster_dag.h), and what of it a host draws at an error in pixels
// (docs/meshlets.md): the cut.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sightcell/scene/cluster_dag.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

class cut_scene {
 public:
  // Adds coarser clusters to a flattened scene. Draws have leaves only where may_have_levels() is false, or where
  // overrides are for some of their polygons alone.
  // s: the scene that was flattened.
  // world: with the overrides of the file.
  // Threads: runs in the TBB arena of the calling thread. The result does not depend on the number of threads.
  cut_scene(const scene::scene& s, const scene::world_geometry& world);

  // The polygons of the scene, which those of coarser clusters follow.
  const scene::world_geometry& geometry() const { return geometry_; }
  // By polygon: its cluster. Clusters are numbered draw by draw.
  std::uint32_t cluster_of(std::uint32_t polygon) const { return cluster_of_[polygon]; }
  std::uint32_t cluster_count() const { return static_cast<std::uint32_t>(clusters_.size()); }
  std::uint32_t leaf_count() const { return leaves_; }  // Returns how many clusters have polygons of the scene.
  std::uint32_t triangles_of(std::uint32_t cluster) const { return clusters_[cluster].triangles; }
  std::uint32_t draw_of(std::uint32_t cluster) const { return clusters_[cluster].draw; }
  std::uint32_t number_in_draw(std::uint32_t cluster) const { return clusters_[cluster].number; }
  // Returns whether a cluster has polygons of the scene.
  bool is_leaf(std::uint32_t cluster) const { return clusters_[cluster].made_by == scene::no_index; }

  // Returns whether a host draws a cluster.
  // error_at_1: greatest error of what is drawn at a distance of 1 m, in meters.
  bool in_cut(std::uint32_t cluster, const glm::vec3& eye, float error_at_1) const;

  // Finds the visible clusters: leaves with a polygon in a set, and coarse ones with such a leaf below them.
  // has: whether a polygon of the scene is in the set.
  // visible: receives 0 or 1 by cluster.
  void find_visible(const std::function<bool(std::uint32_t)>& has, std::vector<std::uint8_t>& visible) const;

 private:
  struct placed_cluster {
    std::uint32_t made_by = scene::no_index, group = scene::no_index;  // in groups_
    std::uint32_t triangles = 0, draw = 0, number = 0;
  };
  struct placed_group {
    glm::vec3 center{0.0f};  // world space, meters
    float radius = 0.0f, error = 0.0f;
  };
  void place(const scene::draw& d, std::uint32_t draw, const scene::cluster_dag& dag);
  bool is_fine(std::uint32_t group, const glm::vec3& eye, float error_at_1) const;

  scene::world_geometry geometry_;
  std::uint32_t polygons_ = 0;  // of the scene
  std::vector<std::uint32_t> cluster_of_;
  std::vector<placed_cluster> clusters_;
  std::vector<placed_group> groups_;
  std::uint32_t leaves_ = 0;
};

}  // namespace sightcell::bake
