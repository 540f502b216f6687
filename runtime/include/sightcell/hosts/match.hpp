#pragma once
// Matches the triangles of a glTF primitive with those that an importer made of it, for importers that reorder
// triangles or split meshes. Header only, C++20, and not part of the runtime: it allocates, and throws std::bad_alloc.
// Which draw of the file is which of the host is found by sightcell_db_match (identity.h), with geometry_hash.
//
// Source ids number the triangles in the order of the glTF file. A host that has other triangles than the file reads
// the positions and indices of the primitive from the file once more, with any glTF reader, and calls match_triangles.
// Two triangles match if their corners have the same positions, bit for bit. So this works for importers that join,
// renumber or duplicate vertices, and for those that change the order of triangles. It does not work for importers that
// move vertices, such as into world space: bake the meshes of the host then.
//
//   const auto matched = sightcell::hosts::match_triangles(of_gltf, parts);
//   if (matched.missing > 0) ...                          // triangles of the file that the host does not have
//   const auto indices = sightcell::hosts::permuted_indices(draw, order, matched, parts[0].indices);
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sightcell/identity.h"
#include "sightcell/sightcell.h"

namespace sightcell::hosts {

// Triangles as a host has them. Indices beyond the positions match nothing.
struct triangle_list {
  std::span<const float> positions;        // x, y, z of each vertex, and what else its stride has
  std::size_t stride = 3;                  // floats from vertex to vertex
  std::span<const std::uint32_t> indices;  // three per triangle
};

// A triangle of the host: its number in one of the meshes that the importer made of the primitive.
struct host_triangle {
  static constexpr std::uint32_t none = 0xFFFFFFFFu;
  std::uint32_t part = none;
  std::uint32_t triangle = none;
  [[nodiscard]] bool exists() const noexcept { return part != none; }
  bool operator==(const host_triangle&) const = default;
};

struct triangle_match {
  std::vector<host_triangle> of_source;  // by triangle of the glTF primitive
  std::size_t missing = 0;               // triangles of the primitive that the host does not have
  std::size_t extra = 0;                 // triangles of the host that the primitive does not have
  std::size_t turned = 0;                // matches whose corners are in the opposite order
  // The first triangle of each kind, for messages; none if there is none.
  std::uint32_t first_missing = host_triangle::none;
  host_triangle first_extra;
};

namespace detail {

using corner = std::array<std::uint32_t, 3>;
using corners = std::array<corner, 3>;

// The bits of a position, with +0 in place of -0.
inline corner corner_of(const triangle_list& list, std::uint32_t vertex) {
  corner bits{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float value = list.positions[vertex * list.stride + axis];
    bits[axis] = value == 0.0f ? 0u : std::bit_cast<std::uint32_t>(value);
  }
  return bits;
}

// A triangle with its corners in the order of beginning_at_least, so that it does not matter at which corner it begins.
struct keyed_triangle {
  corners key{};
  host_triangle number;  // part is not used for triangles of the source
};

inline corners beginning_at_least(const corners& c) {
  return std::min({c, corners{c[1], c[2], c[0]}, corners{c[2], c[0], c[1]}});
}

inline corners turned(const corners& c) {
  return beginning_at_least({c[0], c[2], c[1]});
}

inline void add_triangles(const triangle_list& list, std::uint32_t part, std::vector<keyed_triangle>& out) {
  const std::size_t vertices = list.stride < 3 ? 0 : (list.positions.size() + list.stride - 3) / list.stride;
  for (std::size_t t = 0; t < list.indices.size() / 3; ++t) {
    const auto vertex = list.indices.subspan(3 * t, 3);
    if (std::any_of(vertex.begin(), vertex.end(), [&](std::uint32_t v) { return v >= vertices; })) continue;
    const corners c{corner_of(list, vertex[0]), corner_of(list, vertex[1]), corner_of(list, vertex[2])};
    out.push_back({beginning_at_least(c), {part, static_cast<std::uint32_t>(t)}});
  }
}

inline bool comes_before(const keyed_triangle& a, const keyed_triangle& b) {
  if (a.key != b.key) return a.key < b.key;
  return a.number.part != b.number.part ? a.number.part < b.number.part : a.number.triangle < b.number.triangle;
}

// Matches triangles of equal keys, in the order of their numbers, and removes them from both lists.
inline void match_equal(std::vector<keyed_triangle>& source, std::vector<keyed_triangle>& host, triangle_match& out) {
  std::sort(source.begin(), source.end(), comes_before);
  std::sort(host.begin(), host.end(), comes_before);
  std::vector<keyed_triangle> source_left;
  std::vector<keyed_triangle> host_left;
  std::size_t h = 0;
  for (const keyed_triangle& s : source) {
    while (h < host.size() && host[h].key < s.key) host_left.push_back(host[h++]);
    if (h < host.size() && host[h].key == s.key) {
      out.of_source[s.number.triangle] = host[h++].number;
    } else {
      source_left.push_back(s);
    }
  }
  host_left.insert(host_left.end(), host.begin() + static_cast<std::ptrdiff_t>(h), host.end());
  source = std::move(source_left);
  host = std::move(host_left);
}

}  // namespace detail

// The geometry hash of triangles (sightcell/identity.h), for sightcell_db_match. Those of the parts of a split mesh add
// up to that of the whole. Calls the runtime. Nothing if an index is beyond the positions.
[[nodiscard]] inline std::optional<std::uint64_t> geometry_hash(const triangle_list& list) {
  const std::size_t vertices = list.stride < 3 ? 0 : (list.positions.size() + list.stride - 3) / list.stride;
  std::uint64_t hash = 0;
  const sightcell_status s = sightcell_geometry_hash(list.positions.data(), list.stride * sizeof(float), vertices,
                                                     list.indices.data(), list.indices.size(), &hash);
  return s == SIGHTCELL_OK ? std::optional(hash) : std::nullopt;
}

// Matches each triangle of a primitive with one of the host. Triangles with equal corners are matched in their order,
// so the result does not depend on anything else. First triangles with the same winding, then those that are left, for
// importers that turn triangles over.
// source: the primitive, from the glTF file.
// parts: the meshes that the importer made of it, mostly one.
// Cost: O(n log n).
[[nodiscard]] inline triangle_match match_triangles(const triangle_list& source, std::span<const triangle_list> parts) {
  triangle_match out;
  out.of_source.resize(source.indices.size() / 3);
  std::vector<detail::keyed_triangle> wanted;
  std::vector<detail::keyed_triangle> there;
  detail::add_triangles(source, 0, wanted);
  std::size_t host_count = 0;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    detail::add_triangles(parts[part], static_cast<std::uint32_t>(part), there);
    host_count += parts[part].indices.size() / 3;
  }
  detail::match_equal(wanted, there, out);
  const std::size_t before = wanted.size();
  for (detail::keyed_triangle& t : wanted) t.key = detail::turned(t.key);
  detail::match_equal(wanted, there, out);
  out.turned = before - wanted.size();
  for (std::size_t t = 0; t < out.of_source.size(); ++t) {
    if (out.of_source[t].exists()) continue;
    if (out.missing++ == 0) out.first_missing = static_cast<std::uint32_t>(t);
  }
  out.extra = host_count - (out.of_source.size() - out.missing);
  const auto number_before = [](const detail::keyed_triangle& a, const detail::keyed_triangle& b) {
    return std::pair(a.number.part, a.number.triangle) < std::pair(b.number.part, b.number.triangle);
  };
  const auto first = std::min_element(there.begin(), there.end(), number_before);
  if (first != there.end()) out.first_extra = first->number;
  return out;
}

// Returns the index buffer of the host's mesh in stored order, for ranges and commands. A triangle of the file that the
// host does not have becomes three times vertex 0, so that all others keep their places.
// draw: of the draw table, any draw of the primitive.
// order: of sightcell_db_order.
// matched: with one part. indices: of that part.
// Returns nothing if the match is of another primitive or has more than one part: use a cluster map
// (sightcell/clusters.h) then, or bake the meshes of the host.
[[nodiscard]] inline std::vector<std::uint32_t> permuted_indices(const sightcell_draw& draw,
                                                                 std::span<const std::uint32_t> order,
                                                                 const triangle_match& matched,
                                                                 std::span<const std::uint32_t> indices) {
  if (matched.of_source.size() != draw.polygon_count || order.size() < draw.polygon_count ||
      draw.first_stored > order.size() - draw.polygon_count) {
    return {};
  }
  std::vector<std::uint32_t> out(3 * std::size_t{draw.polygon_count}, 0);
  for (std::uint32_t i = 0; i < draw.polygon_count; ++i) {
    const std::uint32_t triangle = order[draw.first_stored + i] - draw.first_source;
    if (triangle >= matched.of_source.size()) return {};
    const host_triangle& from = matched.of_source[triangle];
    if (!from.exists()) continue;
    if (from.part != 0 || from.triangle >= indices.size() / 3) return {};
    std::copy_n(indices.begin() + 3 * static_cast<std::ptrdiff_t>(from.triangle), 3,
                out.begin() + 3 * static_cast<std::ptrdiff_t>(i));
  }
  return out;
}

}  // namespace sightcell::hosts
