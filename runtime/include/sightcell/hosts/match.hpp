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
//
// A host that keeps its index buffers, also where the importer has split a primitive, numbers the triangles of all its
// instances, and takes a mapping between these numbers and source ids instead:
//
//   const auto order = sightcell::hosts::order_of_host(matched_draws, polygon_count, host_polygon_count);
//   if (!order->missing.empty() || !order->extra.empty()) ...   // what could not be mapped
//   const auto table = sightcell::hosts::clusters_by_source(*order, cluster_of_host_polygon);  // sightcell/clusters.h
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

// ---- Hosts that keep their order ------------------------------------------------------------------------------------

// A draw of the file, with the triangles that the host has for it.
struct matched_draw {
  sightcell_draw draw{};                      // of the draw table
  const triangle_match* triangles = nullptr;  // instances may share it
  std::span<const std::uint32_t>
      first_of_part;  // the host's number of the first triangle of each part of this instance
};

// Which polygon of the host is which of the file. Polygons of the host are its triangles, those of each instance of its
// own, in any numbering in which those of a part follow each other in the order of its index buffer.
struct host_order {
  static constexpr std::uint32_t none = host_triangle::none;
  std::vector<std::uint32_t> host_of_source;  // by source id: the polygon of the host; none: missing
  std::vector<std::uint32_t> source_of_host;  // by polygon of the host: the source id; none: extra
  // Source ids of the draws that the host does not have, ascending. Sets may have them; there is nothing to draw.
  std::vector<std::uint32_t> missing;
  // Polygons of the host that no draw has, ascending. No set has them: draw them always.
  std::vector<std::uint32_t> extra;
};

// Returns the mapping of a scene.
// draws: in any order. Polygons of draws that are not among them are missing.
// polygon_count: sightcell_db_polygon_count. host_polygon_count: of the host.
// Returns nothing if a match is of another primitive than its draw, if a number is beyond a count, or if two draws or
// two triangles are the same polygon.
// Cost: O(polygons); 8 bytes per polygon.
[[nodiscard]] inline std::optional<host_order> order_of_host(std::span<const matched_draw> draws,
                                                             std::uint32_t polygon_count,
                                                             std::uint32_t host_polygon_count) {
  host_order out;
  out.host_of_source.assign(polygon_count, host_order::none);
  out.source_of_host.assign(host_polygon_count, host_order::none);
  for (const matched_draw& d : draws) {
    if (d.triangles == nullptr || d.triangles->of_source.size() != d.draw.polygon_count ||
        d.draw.polygon_count > polygon_count || d.draw.first_source > polygon_count - d.draw.polygon_count) {
      return std::nullopt;
    }
    for (std::uint32_t t = 0; t < d.draw.polygon_count; ++t) {
      const host_triangle& from = d.triangles->of_source[t];
      if (!from.exists()) continue;
      if (from.part >= d.first_of_part.size()) return std::nullopt;
      const std::uint64_t host = std::uint64_t{d.first_of_part[from.part]} + from.triangle;
      const std::uint32_t source = d.draw.first_source + t;
      if (host >= host_polygon_count || out.source_of_host[host] != host_order::none ||
          out.host_of_source[source] != host_order::none) {
        return std::nullopt;
      }
      out.host_of_source[source] = static_cast<std::uint32_t>(host);
      out.source_of_host[host] = source;
    }
  }
  for (std::uint32_t i = 0; i < polygon_count; ++i) {
    if (out.host_of_source[i] == host_order::none) out.missing.push_back(i);
  }
  for (std::uint32_t i = 0; i < host_polygon_count; ++i) {
    if (out.source_of_host[i] == host_order::none) out.extra.push_back(i);
  }
  return out;
}

// Returns the table of sightcell_cluster_map_create. Missing polygons are in no cluster. A cluster with an extra
// polygon has to be drawn always, whatever its bit is. cluster_of_host: by polygon of the host. Returns nothing if it
// has fewer elements.
[[nodiscard]] inline std::vector<std::uint32_t> clusters_by_source(const host_order& order,
                                                                   std::span<const std::uint32_t> cluster_of_host) {
  if (cluster_of_host.size() < order.source_of_host.size()) return {};
  std::vector<std::uint32_t> out(order.host_of_source.size(), host_triangle::none);  // SIGHTCELL_NO_CLUSTER
  for (std::size_t source = 0; source < out.size(); ++source) {
    const std::uint32_t host = order.host_of_source[source];
    if (host != host_order::none) out[source] = cluster_of_host[host];
  }
  return out;
}

// Returns the polygons of the host in stored order, for the ranges of sightcell_view_ranges: those of a range are the
// elements first_stored + first, and the `count - 1` after it, with first_stored of its draw. none: missing.
// stored: of sightcell_db_order. Returns nothing if it is of another file.
[[nodiscard]] inline std::vector<std::uint32_t> host_polygons_by_stored(const host_order& order,
                                                                        std::span<const std::uint32_t> stored) {
  if (stored.size() != order.host_of_source.size()) return {};
  std::vector<std::uint32_t> out;
  out.reserve(stored.size());
  for (const std::uint32_t source : stored) {
    if (source >= order.host_of_source.size()) return {};
    out.push_back(order.host_of_source[source]);
  }
  return out;
}

}  // namespace sightcell::hosts
