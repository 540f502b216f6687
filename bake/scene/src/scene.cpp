#include "sightcell/scene/scene.h"

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <memory>
#include <new>

#include "sightcell/scene/error.h"

namespace sightcell::scene {
namespace {

static_assert(std::endian::native == std::endian::little, "the fingerprint hashes arrays as they lie in memory");

[[noreturn]] void refuse(const scene& s, const std::string& id, const std::string& cause, const std::string& remedy) {
  throw error(error_kind::bad_input, id, s.name, cause, remedy);
}

void check_materials(const scene& s) {
  for (std::size_t i = 0; i < s.materials.size(); ++i) {
    const std::uint32_t image = s.materials[i].base_color_image;
    if (image != no_index && image >= s.images.size()) {
      refuse(s, "scene.index-out-of-range",
             "material " + std::to_string(i) + " uses image " + std::to_string(image) + " of " +
                 std::to_string(s.images.size()),
             "correct the image index");
    }
  }
}

void check_geometries(const scene& s) {
  for (std::size_t i = 0; i < s.geometries.size(); ++i) {
    const geometry& g = s.geometries[i];
    const std::string subject = "geometry " + std::to_string(i);
    if (g.indices.size() % 3 != 0) {
      refuse(s, "scene.bad-field",
             subject + " has " + std::to_string(g.indices.size()) + " indices, not whole triangles",
             "give three indices per triangle");
    }
    if (!g.uvs.empty() && g.uvs.size() != g.positions.size()) {
      refuse(s, "scene.bad-field",
             subject + " has " + std::to_string(g.uvs.size()) + " texture coordinates for " +
                 std::to_string(g.positions.size()) + " positions",
             "give one per position or none");
    }
    const auto largest = std::max_element(g.indices.begin(), g.indices.end());
    if (largest != g.indices.end() && *largest >= g.positions.size()) {
      refuse(s, "scene.index-out-of-range",
             subject + " has index " + std::to_string(*largest) + " but " + std::to_string(g.positions.size()) +
                 " vertices",
             "correct the index");
    }
  }
}

void number_draws(scene& s) {
  constexpr std::uint64_t limit = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t polygons = 0;
  std::uint64_t vertices = 0;
  for (std::size_t i = 0; i < s.draws.size(); ++i) {
    draw& d = s.draws[i];
    if (d.geometry >= s.geometries.size() || (d.material != no_index && d.material >= s.materials.size())) {
      refuse(s, "scene.index-out-of-range",
             "draw " + std::to_string(i) + " uses a geometry or material that is not there", "correct the index");
    }
    const geometry& g = s.geometries[d.geometry];
    d.first_source = static_cast<std::uint32_t>(polygons);
    d.polygon_count = static_cast<std::uint32_t>(g.indices.size() / 3);
    d.base_vertex = static_cast<std::uint32_t>(vertices);
    polygons += g.indices.size() / 3;
    vertices += g.positions.size();
    if (polygons >= limit || vertices >= limit) {
      refuse(s, "scene.too-large", "the scene has 2^32 - 1 polygons or vertices or more with all its instances",
             "bake it in parts");
    }
  }
  s.polygon_count = static_cast<std::uint32_t>(polygons);
}

class fingerprint_hash {
 public:
  fingerprint_hash() : state_(XXH3_createState(), &XXH3_freeState) {
    if (state_ == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(state_.get());
  }

  template <typename T>
  void value(const T& v) {
    static_assert(std::is_arithmetic_v<T>, "a struct could have padding");
    XXH3_128bits_update(state_.get(), &v, sizeof(v));
  }

  template <typename T>
  void array(const std::vector<T>& v) {
    value(static_cast<std::uint64_t>(v.size()));
    if (!v.empty()) XXH3_128bits_update(state_.get(), v.data(), v.size() * sizeof(T));
  }

  std::array<std::uint8_t, 16> digest() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
    std::array<std::uint8_t, 16> out{};
    std::copy(std::begin(canonical.digest), std::end(canonical.digest), out.begin());
    return out;
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

// Texture coordinates and images decide what is seen only where alpha is tested, so only masked materials bring them
// in: a new color texture must not void a bake.
std::array<std::uint8_t, 16> fingerprint_of(const scene& s) {
  std::vector<bool> masked(s.geometries.size(), false);
  for (const draw& d : s.draws) {
    if (d.material != no_index && s.materials[d.material].alpha == alpha_mode::mask) masked[d.geometry] = true;
  }
  fingerprint_hash hash;
  hash.value(static_cast<std::uint64_t>(s.materials.size()));
  for (const material& m : s.materials) {
    hash.value(static_cast<std::uint8_t>(m.alpha));
    hash.value(static_cast<std::uint8_t>(m.double_sided));
    if (m.alpha != alpha_mode::mask) continue;
    hash.value(m.alpha_cutoff);
    hash.value(m.base_color.a);
    if (m.base_color_image != no_index) hash.array(s.images[m.base_color_image].encoded);
  }
  hash.value(static_cast<std::uint64_t>(s.geometries.size()));
  for (std::size_t i = 0; i < s.geometries.size(); ++i) {
    hash.array(s.geometries[i].positions);
    hash.array(s.geometries[i].indices);
    if (masked[i]) hash.array(s.geometries[i].uvs);
  }
  hash.value(static_cast<std::uint64_t>(s.draws.size()));
  for (const draw& d : s.draws) {
    for (const std::uint32_t number : {d.node, d.mesh, d.primitive, d.instance, d.material, d.geometry}) {
      hash.value(number);
    }
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) hash.value(d.to_world[column][row]);
    }
  }
  return hash.digest();
}

bool is_finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Differences of floats and their products are exact or nearly so in double precision: only a polygon whose corners
// lie on one line in the rounded positions counts as having no area.
bool has_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 n = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
  return n.x != 0.0 || n.y != 0.0 || n.z != 0.0;
}

polygon_kind kind_of(const scene& s, const draw& d) {
  polygon_kind kind;
  if (d.material != no_index) {
    kind.alpha = s.materials[d.material].alpha;
    kind.double_sided = s.materials[d.material].double_sided;
  }
  return kind;
}

void append_draw(const scene& s, const draw& d, world_geometry& out) {
  const geometry& g = s.geometries[d.geometry];
  const glm::dmat4& m = d.to_world;
  for (const glm::vec3& local : g.positions) {
    const glm::dvec3 p(local);
    out.positions.emplace_back(m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3]);
  }
  const bool mirrored = glm::determinant(glm::dmat3(m)) < 0.0;
  const polygon_kind kind = kind_of(s, d);
  for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) {
    const std::uint32_t a = d.base_vertex + g.indices[i];
    const std::uint32_t b = d.base_vertex + g.indices[i + (mirrored ? 2 : 1)];
    const std::uint32_t c = d.base_vertex + g.indices[i + (mirrored ? 1 : 2)];
    out.indices.insert(out.indices.end(), {a, b, c});
    const glm::vec3& pa = out.positions[a];
    const glm::vec3& pb = out.positions[b];
    const glm::vec3& pc = out.positions[c];
    polygon_kind& stored = out.kinds.emplace_back(kind);
    stored.degenerate = !(is_finite(pa) && is_finite(pb) && is_finite(pc) && has_area(pa, pb, pc));
    if (stored.degenerate) continue;
    out.min = glm::min(out.min, glm::min(pa, glm::min(pb, pc)));
    out.max = glm::max(out.max, glm::max(pa, glm::max(pb, pc)));
  }
}

}  // namespace

void finish(scene& s) {
  check_materials(s);
  check_geometries(s);
  number_draws(s);
  s.fingerprint = fingerprint_of(s);
}

world_geometry flatten(const scene& s) {
  world_geometry out;
  std::size_t vertices = 0;
  if (!s.draws.empty()) vertices = s.draws.back().base_vertex + s.geometries[s.draws.back().geometry].positions.size();
  out.positions.reserve(vertices);
  out.indices.reserve(std::size_t{s.polygon_count} * 3);
  out.kinds.reserve(s.polygon_count);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  out.min = glm::vec3(infinity);
  out.max = glm::vec3(-infinity);
  for (const draw& d : s.draws) append_draw(s, d, out);
  if (out.min.x > out.max.x) out.min = out.max = glm::vec3(0.0f);
  // Every polygon at a corner that is not finite is degenerate already, so the place is free; no NaN must reach a
  // ray tracer or a GPU that is given the whole array.
  for (glm::vec3& p : out.positions) {
    if (!is_finite(p)) p = glm::vec3(0.0f);
  }
  return out;
}

std::uint32_t draw_of(const scene& s, std::uint32_t source_id) {
  // The last of all draws that begin at or before the id: empty draws share their first id with the draw after them.
  const auto after = std::upper_bound(s.draws.begin(), s.draws.end(), source_id,
                                      [](std::uint32_t id, const draw& d) { return id < d.first_source; });
  return static_cast<std::uint32_t>(after - s.draws.begin()) - 1;
}

}  // namespace sightcell::scene
