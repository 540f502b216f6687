#include "sightcell/bake/strip.h"

#include <algorithm>
#include <utility>

#include "sightcell/base/error.h"
#include "sightcell/format/writer.h"
#include "sightcell/scene/strip.h"

namespace sightcell::bake {

strip_result strip(const std::filesystem::path& scene_path, int scene_index, std::span<const std::byte> file,
                   const std::string& name, const std::filesystem::path& output) {
  scene::gltf_stripper stripper(scene_path, scene_index);
  strip_result result;
  result.unseen = find_unseen(stripper.content(), file, name);
  result.warnings = stripper.content().warnings;
  if (output.empty()) return result;
  std::vector<std::string> warnings;
  const scene::stripped_scene stripped = stripper.strip(result.unseen.is_unseen, warnings);
  for (std::string& warning : warnings)  // missing base colors are among those of the scene
    if (std::find(result.warnings.begin(), result.warnings.end(), warning) == result.warnings.end())
      result.warnings.push_back(std::move(warning));
  const std::string path = output.string();
  format::remove_unfinished(path.c_str());
  if (format::write_file(path.c_str(), stripped.glb) != format::status::ok)
    throw error(error_kind::failed, "strip.not-written", path, "cannot be written", "free space or choose another -o");
  result.polygons = stripped.polygons;
  result.bytes_before = stripped.source_bytes;
  result.bytes = stripped.glb.size();
  return result;
}

}  // namespace sightcell::bake
