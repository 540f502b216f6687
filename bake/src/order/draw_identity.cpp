#include "order/draw_identity.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "sightcell/format/geometry_hash.h"

namespace sightcell::bake {
namespace {

std::uint64_t hash_of_geometry(const scene::geometry& g) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) {
    std::array<std::array<float, 3>, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3& p = g.positions[g.indices[i + k]];
      corners[k] = {p.x, p.y, p.z};
    }
    sum += format::triangle_hash(corners);
  }
  return sum;
}

// A name of the scene as the file can have it: without what follows a zero.
std::vector<std::string> storable(const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const std::string& name : names) out.push_back(name.substr(0, name.find('\0')));
  return out;
}

}  // namespace

draw_identity identity_of(const scene::scene& s) {
  std::vector<std::uint64_t> of_geometry;
  for (const scene::geometry& g : s.geometries) of_geometry.push_back(hash_of_geometry(g));
  draw_identity out{{}, storable(s.node_names), storable(s.mesh_names)};
  for (const scene::draw& d : s.draws) {
    if (d.polygon_count > 0) out.hashes.push_back(of_geometry[d.geometry]);
  }
  return out;
}

void put_identity(const draw_identity& identity, format::file_parts& parts) {
  parts.geometry_hashes = identity.hashes;
  parts.node_names = identity.node_names;
  parts.mesh_names = identity.mesh_names;
}

}  // namespace sightcell::bake
