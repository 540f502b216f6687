#pragma once
// KHR_draco_mesh_compression: the triangles of a primitive out of its compressed bytes.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sightcell::scene {

struct draco_wish {
  std::uint32_t id = 0;     // unique id inside the stream
  std::uint32_t width = 0;  // components per vertex
};

struct draco_mesh {
  std::uint32_t vertex_count = 0;
  std::vector<std::uint32_t> indices;          // three per triangle
  std::vector<std::vector<float>> attributes;  // vertex_count x width each, in the order of the wishes
};

// Nothing, and why, when the stream is broken or has no such attribute.
std::optional<draco_mesh> decode_draco(std::span<const std::uint8_t> bytes, std::span<const draco_wish> wishes,
                                       std::string& why_not);

}  // namespace sightcell::scene
