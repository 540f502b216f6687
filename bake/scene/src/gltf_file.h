#pragma once
// Reads the bytes of a glTF scene: the container (.glb or .gltf) and the resources that it refers to by URI.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightcell::scene {

// The origin of a scene.
struct gltf_source {
  std::string name;                             // for messages
  std::optional<std::filesystem::path> folder;  // of its resources; none: the scene may use data URIs only
};

// The parts of a container.
struct gltf_file {
  std::string json;
  std::optional<std::vector<std::uint8_t>> binary;  // the BIN chunk of a .glb
  std::vector<std::string> warnings;
};

// Returns the origin of a scene on disk.
gltf_source source_of(const std::filesystem::path& path);
// Reads a scene from a regular file. Throws sightcell::error.
std::vector<std::uint8_t> read_scene_bytes(const std::filesystem::path& path);
// Splits container and text; a .glb is recognized by its magic number. Throws sightcell::error.
gltf_file split_gltf(std::span<const std::uint8_t> bytes, const std::string& name);

// Returns the file that a URI names; nothing for data URIs and for what read_resource() rejects.
std::optional<std::filesystem::path> file_of_uri(const gltf_source& scene, const std::string& uri);

// Returns the bytes of a URI: data:...;base64 or a file at or below the scene's folder.
// what: the name of the resource for messages, such as "buffers[0]".
// size: number of bytes needed; throws sightcell::error before reading if the resource has fewer. Empty: all of it.
std::vector<std::uint8_t> read_resource(const gltf_source& scene, const std::string& uri, const std::string& what,
                                        std::optional<std::uint64_t> size);

}  // namespace sightcell::scene
