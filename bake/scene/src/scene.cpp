#include "sightcell/scene/scene.h"

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <new>

#include "sightcell/base/error.h"

namespace sightcell::scene {
namespace {

static_assert(std::endian::native == std::endian::little, "the fingerprint hashes arrays as they are in memory");

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
    const std::uint32_t map = s.materials[i].alpha_map;
    if (map != no_index && map >= s.alpha_maps.size()) {
      refuse(s, "scene.index-out-of-range",
             "material " + std::to_string(i) + " uses alpha map " + std::to_string(map) + " of " +
                 std::to_string(s.alpha_maps.size()),
             "correct the index");
    }
  }
  for (std::size_t i = 0; i < s.alpha_maps.size(); ++i) {
    const alpha_map& map = s.alpha_maps[i];
    if (map.texels.empty() || map.texels.size() != std::size_t{map.width} * map.height) {
      refuse(s, "scene.bad-field",
             "alpha map " + std::to_string(i) + " of " + std::to_string(map.width) + " x " +
                 std::to_string(map.height) + " has " + std::to_string(map.texels.size()) + " texels",
             "give one byte per texel");
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
    if (!g.colors.empty() && g.colors.size() != g.positions.size()) {
      refuse(s, "scene.bad-field",
             subject + " has " + std::to_string(g.colors.size()) + " colors for " + std::to_string(g.positions.size()) +
                 " positions",
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
             "draw " + std::to_string(i) + " uses a geometry or material that does not exist", "correct the index");
    }
    if (d.tags.group != no_index && d.tags.group >= s.groups.size()) {
      refuse(s, "scene.index-out-of-range",
             "draw " + std::to_string(i) + " is of group " + std::to_string(d.tags.group) + " of " +
                 std::to_string(s.groups.size()),
             "correct the index");
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

// Texture coordinates and images decide visibility only where alpha is tested, so only those of masked materials are
// included: a new color texture must not invalidate a bake.
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
    if (m.alpha_unknown) hash.value(std::uint8_t{3});
    if (m.wrap_u != wrap::repeat || m.wrap_v != wrap::repeat)
      hash.value(static_cast<std::uint8_t>(4 + static_cast<int>(m.wrap_u) * 4 + static_cast<int>(m.wrap_v)));
    if (m.alpha_map != no_index) {
      hash.value(s.alpha_maps[m.alpha_map].width);
      hash.array(s.alpha_maps[m.alpha_map].texels);
    } else if (m.base_color_image != no_index) {
      hash.array(s.images[m.base_color_image].encoded);
    }
  }
  hash.value(static_cast<std::uint64_t>(s.geometries.size()));
  for (std::size_t i = 0; i < s.geometries.size(); ++i) {
    hash.array(s.geometries[i].positions);
    hash.array(s.geometries[i].indices);
    if (!masked[i]) continue;
    hash.array(s.geometries[i].uvs);
    for (const glm::u8vec4& color : s.geometries[i].colors) hash.value(color.a);
  }
  hash.value(static_cast<std::uint64_t>(s.draws.size()));
  for (const draw& d : s.draws) {
    for (const std::uint32_t number : {d.node, d.mesh, d.primitive, d.instance, d.material, d.geometry}) {
      hash.value(number);
    }
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) hash.value(d.to_world[column][row]);
    }
    // A marker first: without tags the hash stays that of scenes from before tags existed.
    if (d.tags != draw_tags{}) {
      const draw_tags& t = d.tags;
      hash.value(std::uint8_t{1});
      for (const bool b : {t.occluder, t.dynamic, t.always, t.never, t.animated, t.group != no_index})
        hash.value(static_cast<std::uint8_t>(b));
    }
    if (d.lod_object != no_index) {
      hash.value(std::uint8_t{2});
      hash.value(d.lod_object);
      hash.value(d.lod_level);
    }
  }
  return hash.digest();
}

}  // namespace

void finish(scene& s) {
  check_materials(s);
  check_geometries(s);
  number_draws(s);
  s.fingerprint = fingerprint_of(s);
}

std::uint32_t draw_of(const scene& s, std::uint32_t source_id) {
  // The last of all draws that begin at or before the id: empty draws share their first id with the draw after them.
  const auto after = std::upper_bound(s.draws.begin(), s.draws.end(), source_id,
                                      [](std::uint32_t id, const draw& d) { return id < d.first_source; });
  return static_cast<std::uint32_t>(after - s.draws.begin()) - 1;
}

}  // namespace sightcell::scene
