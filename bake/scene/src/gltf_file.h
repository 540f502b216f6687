#pragma once
// The bytes of a glTF scene: the container (.glb or .gltf) and the resources that it refers to by URI.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightcell::scene {

// Where a scene comes from.
struct gltf_source {
  std::string name;                             // for messages
  std::optional<std::filesystem::path> folder;  // where its resources lie; none: it can have none but data URIs
};

struct gltf_file {
  std::string json;
  std::optional<std::vector<std::uint8_t>> binary;  // the BIN chunk of a .glb
  std::vector<std::string> warnings;
};

gltf_source source_of(const std::filesystem::path& path);
// A scene on disk; only a regular file. Throws sightcell::error.
std::vector<std::uint8_t> read_scene_bytes(const std::filesystem::path& path);
// Splits container and text; .glb is told by its magic. Throws sightcell::error.
gltf_file split_gltf(std::span<const std::uint8_t> bytes, const std::string& name);

// The bytes behind a URI: data:...;base64 or a file at or below the scene's folder. size: how many bytes are needed;
// a resource that has fewer is refused before anything is read. Empty size: all of it. what: "buffers[0]", for
// messages.
std::vector<std::uint8_t> read_resource(const gltf_source& scene, const std::string& uri, const std::string& what,
                                        std::optional<std::uint64_t> size);

}  // namespace sightcell::scene
