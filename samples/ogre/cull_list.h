#pragma once
// Draws the visible triangles alone: an index list per entity, in one dynamic buffer that is filled where the set
// changes. Triangles keep the order of the host's mesh. So the vertex cache works as before, blended triangles blend as
// before, and of coincident ones the same is in front.
#include <cstdint>
#include <span>
#include <vector>

#include "culling.h"
#include "index_list.h"
#include "matched_scene.h"
#include "ogre_scene.h"

namespace ogre_host {

class cull_list final : public culling {
 public:
  cull_list(const ogre_scene& scene, const matched_scene& matched, const imported_scene& host);
  void update(const Ogre::Camera& camera) override;

 private:
  void add_draw(std::span<const sightcell_range> ranges);

  const ogre_scene& scene_;
  const matched_scene& matched_;
  const imported_scene& host_;
  sightcell::view view_;
  std::vector<std::uint32_t> source_of_stored_;
  std::vector<sightcell_range> ranges_;
  std::vector<std::uint8_t> visible_;  // by triangle of one mesh
  index_list list_;
};

}  // namespace ogre_host
