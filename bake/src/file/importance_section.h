#pragma once
// The importance section of a file whose sets are known: measured in the scene, or taken over from the file that it was
// made of.
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

// Cells that are done, of how many; false cancels.
using importance_progress = std::function<bool(std::uint32_t done, std::uint32_t total)>;

// Measures every polygon of every set of a file and puts the section into its bytes, in place of one that it has. rays:
// of the scene that the file was baked from, as its settings say. Runs on the calling thread's TBB arena; the bytes do
// not depend on the number of threads. Takes half a byte for each polygon of each set, and the file twice. False when
// it was cancelled: the file is what it was. Throws sightcell::error, which names the file as `name`.
bool add_importance(std::vector<std::byte>& file, const std::string& name, const ray_scene& rays,
                    const importance_progress& on_progress);

// What a bake adds to its file: nothing unless how asks for it. All must outlive the answer.
file_completion importance_of(const settings& how, const ray_scene& rays, const std::filesystem::path& output,
                              const callbacks& tell);

// The section of another file of the same cells and polygons, for sets that may hold more and be stored in another
// order: what the other's sets do not hold is least important. Nothing where the other has none.
void carry_importance(const format::reader& from, std::vector<std::byte>& file, const std::string& name);

}  // namespace sightcell::bake
