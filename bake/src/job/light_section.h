#pragma once
// The lights section of a file whose sets are known (docs/lights.md).
#include <filesystem>
#include <optional>

#include "file/pvs_output.h"
#include "job/bake_context.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/progress.h"

namespace sightcell::bake {

// Returns the function that finds the polygons that each light of the scene reaches, and adds the section to the file
// of a bake; empty unless the settings request lights. The search is that for a view cell, in a small box around the
// light. It runs on the calling thread's TBB arena; the bytes do not depend on the number of threads.
// found: receives what was found. All arguments must outlive the function.
file_completion lights_of(const bake_context& context, const std::filesystem::path& output, const callbacks& events,
                          std::optional<light_summary>& found);

}  // namespace sightcell::bake
