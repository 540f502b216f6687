#pragma once
// The scene as rays and dilation use it.
#include <optional>

#include "search/near_polygons.h"
#include "sightcell/bake/settings.h"
#include "sightcell/base/stop_request.h"
#include "sightcell/scene/scene.h"
#include "trace/duplicates.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

struct traced_scene {
  // Builds the trees for rays, then the lists of neighbors and of duplicates. geometry must outlive the object.
  // before: as for coincident_partners.
  // stop: null for none. Throws step_stopped if it was asked.
  traced_scene(const scene::world_geometry& geometry, const settings& how, const partners_before* before = nullptr,
               const stop_request* stop = nullptr);
  traced_scene(const traced_scene&) = delete;  // neighbors may refer to rays
  traced_scene& operator=(const traced_scene&) = delete;

  const near_polygons* neighbors_or_null() const { return neighbors ? &*neighbors : nullptr; }

  ray_scene rays;
  std::optional<near_polygons> neighbors;  // only where needs_neighbors(how)
  duplicate_classes duplicates;
};

}  // namespace sightcell::bake
