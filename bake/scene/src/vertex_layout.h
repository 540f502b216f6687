#pragma once
// How pages store the vertices of a geometry.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gltf_attributes.h"

namespace sightcell::scene {

// An attribute in a stream.
struct stream_attribute {
  std::string name;
  std::uint32_t width = 0;   // numbers per vertex
  std::uint32_t offset = 0;  // bytes from the begin of the vertex
  int component_type = 0;    // of glTF
  bool normalized = false;

  bool operator==(const stream_attribute&) const = default;
};

enum class stream_filter { none, octahedral, exponential };

// Interleaved attributes that are compressed together.
struct vertex_stream {
  stream_filter filter = stream_filter::none;
  std::uint32_t stride = 0;  // bytes
  std::vector<stream_attribute> attributes;

  bool operator==(const vertex_stream&) const = default;
};

// The streams of one set of attributes; the first one begins with POSITION.
using vertex_layout = std::vector<vertex_stream>;

// Returns the layout for the attributes of a primitive. values: of all attributes; colors whose values are not those of
// 8 bits get 16.
vertex_layout layout_of(const attribute_values& values, std::size_t vertex_count);

}  // namespace sightcell::scene
