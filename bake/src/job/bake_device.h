#pragma once
// What a bake samples with: the source of hemicubes, surface colors and the metric.
#include <optional>

#include "bound/metric.h"
#include "hemicube/choice/choose_source.h"
#include "hemicube/surface_colors.h"
#include "job/traced_scene.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

struct bake_device {
  // Makes all of it by the settings. All arguments must outlive the object.
  // Threads: an OpenGL context belongs to the calling thread.
  // Throws sightcell::error "gl.no-context" if OpenGL was asked for and is not there; what the sources throw.
  bake_device(const scene::scene& s, const settings& how, const scene::world_geometry& geometry,
              const traced_scene& traced);
  bake_device(const bake_device&) = delete;  // the metric refers to the other members
  bake_device& operator=(const bake_device&) = delete;

  hemicube_source& source() const { return *chosen.source; }
  const surface_colors* colors_or_null() const { return colors ? &*colors : nullptr; }

  chosen_source chosen;
  std::optional<surface_colors> colors;  // only where the sampler or the metric reads them
  error_metric metric;
};

}  // namespace sightcell::bake
