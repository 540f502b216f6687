#pragma once
// Everything a bake has at hand before its first cell, in the order in which it is built.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "bound/metric.h"
#include "cells/cell_blocks.h"
#include "cells/overrides.h"
#include "cells/view_cell.h"
#include "checkpoint/checkpoint.h"
#include "hemicube/choice/choose_source.h"
#include "hemicube/surface_colors.h"
#include "misses/reported_misses.h"
#include "sampler/cell_sampler.h"
#include "search/near_polygons.h"
#include "sightcell/bake/progress.h"
#include "sightcell/bake/settings.h"
#include "trace/ray_scene.h"
#include "volumes/volume_grid.h"

namespace sightcell::bake {

struct bake_context {
  // References must outlive the bake_context. Works on the calling thread's TBB arena; tells of device and cells.
  // Throws sightcell::error.
  bake_context(const scene::scene& s, const settings& how, const callbacks& tell);
  bake_context(const bake_context&) = delete;  // its parts know each other
  bake_context& operator=(const bake_context&) = delete;

  // Do rays bound what is missing? Then cells share what they saw.
  bool bounds() const { return how.max_pixel_error > 0.0; }
  // Goes on with bakes that knew other misses, but for the blocks that these are in.
  stale_key_test judge() const;

  const scene::scene& s;
  const settings& how;
  overrides given;
  reported_misses misses;
  scene::world_geometry geometry;
  std::optional<ray_scene> rays;
  std::optional<near_polygons> neighbors;  // where something is looked for, or taken, beside what is known
  chosen_source eyes;
  cell_list list;
  std::optional<volume_grid> volumes;  // of all cells, also those that --cell-limit leaves out
  std::optional<cell_blocks> blocks;
  std::optional<surface_colors> colors;  // where the sampler or the metric looks at them
  error_metric metric;
  std::unique_ptr<cell_sampler> sampler;
  std::string settings_text;  // the file's has the overrides besides
  // Names all that decides a byte: scene with the textures that decide alpha, cells, settings, device, version.
  std::string key;
};

// Times a few hemicubes, or the sampler's own rays, and fresh rays in cells spread over the list, and says how long so
// many cells will take. Returns how many polygons a trial saw; 0 where no cell is left.
double print_estimate(const bake_context& context, std::size_t cells_left, const callbacks& tell);

}  // namespace sightcell::bake
