#include "opened_gltf.h"

#include <new>
#include <utility>

#include "sightcell/base/json_text.h"

namespace sightcell::scene {

opened_gltf::opened_gltf(const std::filesystem::path& path, int scene_index) : source(source_of(path)) {
  try {
    gltf_file file = split_gltf(read_scene_bytes(path), source.name);
    content = import_gltf(file, source, printable(path.filename().string(), 1000), scene_index, &poses, &switches);
    document = parse_json(file.json);
    root.emplace(document, "", source.name);
    table.emplace(*root, source, std::move(file.binary));
    attributes.emplace(*root, *table);
  } catch (const std::bad_alloc&) {
    refuse_for_memory(source.name);
  }
}

}  // namespace sightcell::scene
