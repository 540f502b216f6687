#pragma once
// The bytes of a glTF scene: the container (.glb or .gltf) and the resources that it refers to by URI.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sightcell::scene {

struct gltf_file {
  std::string json;
  std::optional<std::vector<std::uint8_t>> binary;  // the BIN chunk of a .glb
  std::vector<std::string> warnings;
};

// Splits container and text; .glb is told by its magic, not by its name. Throws sightcell::error.
gltf_file read_gltf_file(const std::filesystem::path& path);

// The bytes behind a URI: data:...;base64 or a file at or below the scene's folder. size: how many bytes are needed;
// a resource that has fewer is refused before anything is read. Empty size: all of it. what: "buffers[0]", for
// messages.
std::vector<std::uint8_t> read_resource(const std::filesystem::path& scene_path, const std::string& uri,
                                        const std::string& what, std::optional<std::uint64_t> size);

}  // namespace sightcell::scene
