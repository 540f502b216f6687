#include "sightcell/bake/meshlets.h"

#include <algorithm>
#include <utility>

#include "sightcell/base/error.h"
#include "sightcell/format/writer.h"
#include "sightcell/scene/meshlets.h"

namespace sightcell::bake {

meshlet_result pack_meshlets(const std::filesystem::path& scene_path, int scene_index,
                             const std::filesystem::path& output, bool levels,
                             const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  scene::gltf_meshlet_packer packer(scene_path, scene_index);
  meshlet_result result;
  result.polygons = packer.content().polygon_count;
  result.warnings = packer.content().warnings;
  std::vector<std::string> warnings;
  const scene::meshlet_scene packed = packer.pack(progress, warnings, levels);
  for (std::string& warning : warnings)  // missing base colors are among those of the scene
    if (std::find(result.warnings.begin(), result.warnings.end(), warning) == result.warnings.end())
      result.warnings.push_back(std::move(warning));
  const std::string path = output.string();
  format::remove_unfinished(path.c_str());
  if (format::write_file(path.c_str(), packed.glb) != format::status::ok)
    throw error(error_kind::failed, "pack.not-written", path, "cannot be written", "free space or choose another -o");
  result.triangles = packed.triangles;
  result.primitives = packed.primitives;
  result.meshlets = packed.meshlets;
  result.coarse_meshlets = packed.coarse_meshlets;
  result.drawn_meshlets = packed.drawn_meshlets;
  result.table_bytes = packed.table_bytes;
  result.bytes = packed.glb.size();
  return result;
}

}  // namespace sightcell::bake
