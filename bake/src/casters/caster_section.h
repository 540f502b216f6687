#pragma once
// The casters section of a file whose sets are known (docs/shadows.md).
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "file/pvs_output.h"
#include "search/near_polygons.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/progress.h"
#include "sightcell/bake/settings.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Receives the number of finished cells and of all cells, each counted once per sun. Returning false cancels.
using caster_progress = std::function<bool(std::uint32_t done, std::uint32_t total)>;

// Finds the casters of every cell of a file for each sun of the settings, and writes the section into its bytes,
// replacing an earlier one.
// name: of the file, for errors.
// rays: of the scene that the file was baked from, with the rules in its settings.
// neighbors: as for find_casters().
// found: receives what was found for each sun.
// Returns false if it was canceled, with the file unchanged. Throws sightcell::error. Runs on the calling thread's
// TBB arena; the bytes do not depend on the number of threads.
bool add_casters(std::vector<std::byte>& file, const std::string& name, const ray_scene& rays,
                 const near_polygons* neighbors, const settings& how, const caster_progress& on_progress,
                 std::vector<sun_summary>& found);

// Returns the function that adds the section to the file of a bake; empty unless the settings have suns. All arguments
// must outlive it.
file_completion casters_of(const settings& how, const ray_scene& rays, const near_polygons* neighbors,
                           const std::filesystem::path& output, const callbacks& events,
                           std::vector<sun_summary>& found);

}  // namespace sightcell::bake
