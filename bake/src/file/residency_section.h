#pragma once
// The texture residency section of a file whose sets are known: computed from the scene, or copied from the file that
// it was made from.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "file/pvs_output.h"
#include "sightcell/bake/progress.h"
#include "sightcell/bake/settings.h"
#include "sightcell/format/reader.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Receives the number of finished cells and of all cells. Returning false cancels.
using residency_progress = std::function<bool(std::uint32_t done, std::uint32_t total)>;

// Computes the levels of every cell of a file and writes the section into its bytes, replacing an earlier one.
// name: of the file, for errors.
// s: the scene that the file was baked from, with its textures.
// rays: of this scene, with the rules in the settings of the file.
// anisotropy: the largest one of the filter, 1 .. 16.
// Returns false if it was canceled, with the file unchanged. Throws sightcell::error. Runs on the calling thread's TBB
// arena; the bytes do not depend on the number of threads.
bool add_residency(std::vector<std::byte>& file, const std::string& name, const scene::scene& s, const ray_scene& rays,
                   float anisotropy, const residency_progress& on_progress);

// Returns the function that adds the section to the file of a bake; empty unless the settings ask for it. All arguments
// must outlive it.
file_completion residency_of(const settings& how, const scene::scene& s, const ray_scene& rays,
                             const std::filesystem::path& output, const callbacks& events);

// Copies the section from another file with the same cells into `file`. Does nothing if `from` has none.
// grown: cells whose sets have polygons that can be visible and that the cells of `from` lack. All textures of these
//   cells get the finest level, because a file does not have the textures of polygons.
void carry_residency(const format::reader& from, std::vector<std::byte>& file, const std::string& name,
                     std::span<const std::uint32_t> grown);

}  // namespace sightcell::bake
