#include "meshopt_encode.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace sightcell::scene {

std::vector<std::uint8_t> encode_vertices(const vertex_bytes& vertices) {
  const std::size_t count = vertices.bytes.size() / vertices.stride;
  std::vector<std::uint8_t> out(meshopt_encodeVertexBufferBound(count, vertices.stride));
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), vertices.bytes.data(), count, vertices.stride));
  return out;
}

std::vector<std::uint8_t> encode_triangles(std::span<const std::uint32_t> indices, std::size_t vertex_count) {
  // The extension demands version 1; the library writes version 0 unless it is told.
  [[maybe_unused]] static const bool set = (meshopt_encodeIndexVersion(1), true);
  std::vector<std::uint8_t> out(meshopt_encodeIndexBufferBound(indices.size(), vertex_count));
  out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

std::vector<std::uint8_t> encode_directions(std::span<const float> vectors) {
  std::vector<std::uint8_t> out(vectors.size());
  meshopt_encodeFilterOct(out.data(), vectors.size() / 4, 4, 8, vectors.data());
  return out;
}

void put_neighbors_together(std::span<std::uint32_t> indices, std::size_t vertex_count) {
  std::vector<std::uint32_t> ordered(indices.size());
  meshopt_optimizeVertexCacheStrip(ordered.data(), indices.data(), indices.size(), vertex_count);
  std::copy(ordered.begin(), ordered.end(), indices.begin());
}

std::vector<std::uint32_t> first_equal(std::span<const vertex_bytes> streams, std::size_t count) {
  std::vector<meshopt_Stream> sources;
  for (const vertex_bytes& s : streams) sources.push_back({s.bytes.data(), s.stride, s.stride});
  if (count == 0) return {};
  // All vertices, as whole triangles, which the function wants.
  std::vector<std::uint32_t> all((count + 2) / 3 * 3, 0), unique(count);
  std::iota(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), 0u);
  const std::size_t uniques =
      meshopt_generateVertexRemapMulti(unique.data(), all.data(), all.size(), count, sources.data(), sources.size());
  std::vector<std::uint32_t> first(uniques, std::numeric_limits<std::uint32_t>::max());
  for (std::uint32_t i = 0; i < count; ++i) {
    if (first[unique[i]] > i) first[unique[i]] = i;
    unique[i] = first[unique[i]];
  }
  return unique;
}

}  // namespace sightcell::scene
