#pragma once
// A scene and a file that was baked from it, for benchmarks that cast rays of their own.
#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "sightcell/scene/scene.h"
#include "unit/bake/file_bytes.h"
#include "verify/verified_file.h"

namespace sightcell::bench {

struct baked_scene {
  baked_scene(const std::filesystem::path& scene_path, const std::filesystem::path& file_path)
      : s(scene::load_gltf(scene_path)),
        name(file_path.string()),
        bytes(test::file_bytes(file_path)),
        opened(s, nullptr, bytes, name) {
    opened.build_rays();
  }

  scene::scene s;
  std::string name;
  std::vector<std::byte> bytes;
  bake::verified_file opened;
};

inline void require(format::status outcome) {
  if (outcome != format::status::ok) throw std::runtime_error(format::status_text(outcome));
}

}  // namespace sightcell::bench
