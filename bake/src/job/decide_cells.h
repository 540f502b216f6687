#pragma once
// Which cells a bake has: those that an earlier run of the same bake stored, or those that it makes and merges.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "cells/decided_cells.h"
#include "job/bake_device.h"
#include "job/bake_input.h"
#include "job/traced_scene.h"
#include "sightcell/bake/progress.h"
#include "sightcell/bake/settings.h"

namespace sightcell::bake {

// Returns the cells that an earlier run stored for these inputs; nothing if there are none.
using find_decided = std::function<std::optional<decided_cells>(const std::string& inputs)>;

// Returns the cells in bytes from a checkpoint if they are valid and were made from these inputs.
std::optional<decided_cells> decided_from(std::string_view bytes, const std::string& inputs);

// Returns the name of the device, as decided_cells has it.
std::string name_of(const bake_device& device);

// Merges the cells of all_cells() where settings ask for it.
// inputs: from inputs_of_cells() (bake_key.h).
// cubes: becomes the number of cubes that were rendered for this.
// Throws step_stopped if events.on_progress cancels.
decided_cells decide_cells(cell_list list, const std::string& inputs, const settings& how, const traced_scene& traced,
                           const bake_device& device, std::uint32_t own_polygons, const callbacks& events,
                           std::uint64_t& cubes);

}  // namespace sightcell::bake
