#pragma once
// The importance section of a file whose sets are known: measured in the scene, or copied from the file that it was
// made from.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "file/pvs_output.h"
#include "sightcell/bake/progress.h"
#include "sightcell/bake/settings.h"
#include "sightcell/format/reader.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Receives the number of finished cells and of all cells. Returning false cancels.
using importance_progress = std::function<bool(std::uint32_t done, std::uint32_t total)>;

// Measures every polygon of every set of a file and writes the section into its bytes, replacing an earlier one.
// name: of the file, for errors.
// rays: of the scene that the file was baked from, with the rules in its settings.
// Returns false if it was canceled, with the file unchanged. Throws sightcell::error. Runs on the calling thread's
// TBB arena; the bytes do not depend on the number of threads. Takes half a byte of memory per polygon of each set,
// and twice the size of the file.
bool add_importance(std::vector<std::byte>& file, const std::string& name, const ray_scene& rays,
                    const importance_progress& on_progress);

// Returns the function that adds the section to the file of a bake; empty unless the settings ask for importance. All
// arguments must outlive it.
file_completion importance_of(const settings& how, const ray_scene& rays, const std::filesystem::path& output,
                              const callbacks& events);

// Copies the section from another file with the same cells and polygons into `file`, whose sets may be larger and
// stored in another order. Polygons that are not in the sets of `from` get the least important class. Does nothing if
// `from` has no section.
void carry_importance(const format::reader& from, std::vector<std::byte>& file, const std::string& name);

}  // namespace sightcell::bake
