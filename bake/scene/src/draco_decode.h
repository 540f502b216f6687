#pragma once
// KHR_draco_mesh_compression: decodes the triangles of a primitive.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sightcell::scene {

// An attribute to decode.
struct draco_wish {
  std::uint32_t id = 0;     // unique id inside the stream
  std::uint32_t width = 0;  // components per vertex
};

struct draco_mesh {
  std::uint32_t vertex_count = 0;
  std::vector<std::uint32_t> indices;          // three per triangle
  std::vector<std::vector<float>> attributes;  // vertex_count x width each, in the order of `wishes`
};

// Returns nothing, and the cause in why_not, if the stream is damaged or lacks an attribute.
std::optional<draco_mesh> decode_draco(std::span<const std::uint8_t> bytes, std::span<const draco_wish> wishes,
                                       std::string& why_not);

}  // namespace sightcell::scene
