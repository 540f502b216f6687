#include "meshlet_table.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "json_object.h"

namespace sightcell::scene {
namespace {

constexpr std::uint32_t header_bytes = 32, group_bytes = 16, record_bytes = 64;

// Little-endian numbers, one after the other.
class byte_writer {
 public:
  explicit byte_writer(std::span<std::byte> into) : into_(into) {}

  void put(std::uint32_t value) {
    for (int k = 0; k < 4; ++k) into_[at_++] = static_cast<std::byte>(value >> (8 * k));
  }
  void put(float value) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    put(bits);
  }
  template <std::size_t N>
  void put(const float (&values)[N]) {
    for (const float value : values) put(value);
  }

 private:
  std::span<std::byte> into_;
  std::size_t at_ = 0;
};

struct meshlet_bounds {
  float center[3] = {0.0f, 0.0f, 0.0f};
  float radius = std::numeric_limits<float>::max();  // of what may be anywhere
  float cone_apex[3] = {0.0f, 0.0f, 0.0f};
  float cone_axis[3] = {0.0f, 0.0f, 0.0f};
  float cone_cutoff = 1.0f;  // no cone
};

bool all_finite(const geometry& g, std::span<const std::uint32_t> corners) {
  return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
    const glm::vec3& p = g.positions[corner];
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  });
}

// Grows the radius by the rounding of float, so that the sphere contains each corner in exact arithmetic.
float grown_radius(const geometry& g, std::span<const std::uint32_t> corners, const float (&center)[3]) {
  double most = 0.0;
  for (const std::uint32_t corner : corners) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double d = double{g.positions[corner][k]} - double{center[k]};
      sum += d * d;
    }
    most = std::max(most, sum);
  }
  const auto radius = static_cast<float>(std::sqrt(most));
  return std::nextafter(radius, std::numeric_limits<float>::infinity());
}

meshlet_bounds bounds_of(const geometry& g, std::span<const std::uint32_t> corners, bool has_cone) {
  meshlet_bounds out;
  if (!all_finite(g, corners)) return out;
  const meshopt_Bounds made = meshopt_computeClusterBounds(corners.data(), corners.size(), &g.positions[0].x,
                                                           g.positions.size(), sizeof g.positions[0]);
  if (made.radius == 0.0f) {  // triangles without an area, of which meshoptimizer has no sphere
    const glm::vec3& p = g.positions[corners[0]];
    for (int k = 0; k < 3; ++k) out.center[k] = p[k];
  } else {
    std::copy_n(made.center, 3, out.center);
    if (has_cone) {
      std::copy_n(made.cone_apex, 3, out.cone_apex);
      std::copy_n(made.cone_axis, 3, out.cone_axis);
      out.cone_cutoff = made.cone_cutoff;
    }
  }
  out.radius = grown_radius(g, corners, out.center);
  return out;
}

}  // namespace

std::uint64_t meshlet_table_bytes(std::span<const meshlet_group> groups) {
  std::uint64_t bytes = header_bytes + groups.size() * group_bytes;
  for (const meshlet_group& group : groups) bytes += group.triangle_counts.size() * record_bytes;
  return bytes;
}

void write_meshlet_table(std::span<const meshlet_group> groups, const scene& packed, std::span<std::byte> into) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, const draw*> draws;
  for (const draw& d : packed.draws) draws.try_emplace({d.mesh, d.primitive}, &d);
  byte_writer out(into);
  std::uint32_t meshlets = 0;
  for (const meshlet_group& group : groups) meshlets += static_cast<std::uint32_t>(group.triangle_counts.size());
  out.put(std::uint32_t{0x4C4D4353});  // "SCML"
  out.put(meshlet_table_version);
  out.put(static_cast<std::uint32_t>(groups.size()));
  out.put(meshlets);
  out.put(group_bytes);
  out.put(record_bytes);
  out.put(std::uint32_t{0});
  out.put(std::uint32_t{0});
  std::uint32_t first = 0;
  for (const meshlet_group& group : groups) {
    const auto count = static_cast<std::uint32_t>(group.triangle_counts.size());
    out.put(group.mesh);
    out.put(group.primitive);
    out.put(first);
    out.put(count);
    first += count;
  }
  for (std::uint32_t number = 0; number < groups.size(); ++number) {
    const meshlet_group& group = groups[number];
    const draw& d = *draws.at({group.mesh, group.primitive});
    const geometry& g = packed.geometries[d.geometry];
    const std::uint64_t triangles =
        std::accumulate(group.triangle_counts.begin(), group.triangle_counts.end(), std::uint64_t{0});
    if (3 * triangles != g.indices.size())
      refuse(packed.name, "scene.bad-field", "has changed since it was loaded",
             "run the command again while no other program writes the file");
    const bool sided = d.material != no_index && packed.materials[d.material].double_sided;
    std::uint32_t index = 0;
    for (const std::uint32_t count : group.triangle_counts) {
      const std::span<const std::uint32_t> corners = std::span(g.indices).subspan(index, std::size_t{3} * count);
      const auto [least, most] = std::minmax_element(corners.begin(), corners.end());
      const meshlet_bounds bounds = group.deforms ? meshlet_bounds{} : bounds_of(g, corners, !sided);
      out.put(number);
      out.put(index);
      out.put(count);
      out.put(*least);
      out.put(*most - *least + 1);
      out.put(bounds.center);
      out.put(bounds.radius);
      out.put(bounds.cone_apex);
      out.put(bounds.cone_axis);
      out.put(bounds.cone_cutoff);
      index += 3 * count;
    }
  }
}

}  // namespace sightcell::scene
