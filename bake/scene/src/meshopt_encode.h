#pragma once
// EXT_meshopt_compression: encodes buffer views, and prepares what they contain.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::scene {

// A stream of elements of `stride` bytes, a multiple of 4.
struct vertex_bytes {
  std::span<const std::uint8_t> bytes;
  std::size_t stride = 4;
};

// Mode ATTRIBUTES, version 0 of the vertex codec.
std::vector<std::uint8_t> encode_vertices(const vertex_bytes& vertices);

// Mode TRIANGLES. indices: below vertex_count. A decoder returns the same triangles in the same order, perhaps with
// other first corners.
std::vector<std::uint8_t> encode_triangles(std::span<const std::uint32_t> indices, std::size_t vertex_count);

// Filter OCTAHEDRAL with 8 bits. vectors: four numbers per element, a unit vector and a number that is kept. Returns 4
// bytes per element.
std::vector<std::uint8_t> encode_directions(std::span<const float> vectors);

// Puts triangles into an order in which neighbors follow each other, for smaller codes. indices: below vertex_count.
void put_neighbors_together(std::span<std::uint32_t> indices, std::size_t vertex_count);

// Returns for each of `count` vertices the number of the first one that has the same bytes in all streams.
std::vector<std::uint32_t> first_equal(std::span<const vertex_bytes> streams, std::size_t count);

}  // namespace sightcell::scene
