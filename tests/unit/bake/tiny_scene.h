#pragma once
// Scenes of a few polygons, built by hand.
#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::test {

// Collects quads and triangles, one draw per call, and hands out the finished scene.
class tiny_scene {
 public:
  struct look {
    scene::alpha_mode alpha = scene::alpha_mode::opaque;
    bool double_sided = false;
  };

  // Counter-clockwise from the front. Returns the source id of its first polygon.
  std::uint32_t triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) { return triangle(a, b, c, look{}); }
  std::uint32_t triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, look how) { return add({a, b, c}, {0, 1, 2}, how); }
  std::uint32_t quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) { return quad(a, b, c, d, look{}); }
  std::uint32_t quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, look how) {
    return add({a, b, c, d}, {0, 1, 2, 0, 2, 3}, how);
  }
  // A rectangle at x = place that faces toward +x (facing > 0) or -x, spanning y and z from -half to half.
  std::uint32_t wall_x(float place, float facing, float half) { return wall_x(place, facing, half, look{}); }
  std::uint32_t wall_x(float place, float facing, float half, look how) {
    const float s = facing > 0.0f ? 1.0f : -1.0f;
    return quad({place, -half, s * half}, {place, -half, -s * half}, {place, half, -s * half}, {place, half, s * half},
                how);
  }
  // A MASK quad over which the whole map lies: a at (0, 0), b at (1, 0), c at (1, 1), d at (0, 1).
  std::uint32_t masked_quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, scene::alpha_map map,
                            bool double_sided = false) {
    const auto first = quad(a, b, c, d, look{scene::alpha_mode::mask, double_sided});
    scene_.geometries.back().uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    scene_.materials.back().alpha_map = static_cast<std::uint32_t>(scene_.alpha_maps.size());
    scene_.alpha_maps.push_back(std::move(map));
    return first;
  }

  // A closed box; its polygons face outward (or into it). Returns its first id; it has 12 polygons.
  std::uint32_t closed_box(glm::vec3 low, glm::vec3 high, bool inward = false) {
    const glm::vec3 &a = low, &b = high;
    std::vector<glm::vec3> p{{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, b.y, a.z}, {a.x, b.y, a.z},
                             {a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}};
    std::vector<std::uint32_t> i{0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                 3, 7, 6, 3, 6, 2, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5};
    if (inward)
      for (std::size_t k = 0; k < i.size(); k += 3) std::swap(i[k], i[k + 1]);
    return add(std::move(p), std::move(i), look{});
  }

  // A room of 18 x 6 x 18 m around the origin, and 24 pillars in it that hide each other from most places.
  void room_with_pillars() {
    closed_box({-9, -3, -9}, {9, 3, 9}, true);
    for (int i = 0; i < 24; ++i) {
      const float x = -8.0f + 0.65f * static_cast<float>(i), z = static_cast<float>(i * 5 % 13) - 6.0f;
      closed_box({x, -3, z}, {x + 0.4f, 2, z + 0.5f});
    }
  }

  // A wall at x = 2 with a slit from z = 1.1 to 1.3, a meter deep toward -x, and a quad right behind it. Returns the
  // quad: it is seen from places with x < 1 only under flat angles, so from z around the slit's and not from far below.
  std::uint32_t deep_slit() {
    const look sheet{scene::alpha_mode::opaque, true};
    quad({2, -9, -9}, {2, -9, 1.1f}, {2, 9, 1.1f}, {2, 9, -9});
    quad({2, -9, 1.3f}, {2, -9, 9}, {2, 9, 9}, {2, 9, 1.3f});
    quad({1, -9, 1.1f}, {2, -9, 1.1f}, {2, 9, 1.1f}, {1, 9, 1.1f}, sheet);
    quad({1, -9, 1.3f}, {2, -9, 1.3f}, {2, 9, 1.3f}, {1, 9, 1.3f}, sheet);
    return quad({2.05f, -9, 1.12f}, {2.05f, -9, 1.28f}, {2.05f, 9, 1.28f}, {2.05f, 9, 1.12f});
  }

  // Tags the draw that begins with this polygon.
  void tag(std::uint32_t first, scene::draw_tags tags) { draw_at(first).tags = tags; }
  // Makes the draw that begins with this polygon a named group, such as a door.
  void group(std::uint32_t first, std::string name) {
    draw_at(first).tags.group = static_cast<std::uint32_t>(scene_.groups.size());
    scene_.groups.push_back(std::move(name));
  }
  // Makes the draw that begins with this polygon a level of detail of an object.
  void level(std::uint32_t first, std::uint32_t object, std::uint32_t level) {
    draw_at(first).lod_object = object;
    draw_at(first).lod_level = level;
  }

  scene::scene finished() {
    scene::finish(scene_);
    return scene_;
  }

 private:
  scene::draw& draw_at(std::uint32_t first) {
    std::size_t number = 0;
    for (std::uint32_t polygon = 0; polygon < first; ++number)
      polygon += static_cast<std::uint32_t>(scene_.geometries[scene_.draws[number].geometry].indices.size() / 3);
    return scene_.draws[number];
  }

  std::uint32_t add(std::vector<glm::vec3> positions, std::vector<std::uint32_t> indices, look how) {
    const auto number = static_cast<std::uint32_t>(scene_.draws.size());
    const auto first = polygons_;
    polygons_ += static_cast<std::uint32_t>(indices.size() / 3);
    scene::material m;
    m.alpha = how.alpha;
    m.double_sided = how.double_sided;
    scene_.materials.push_back(m);
    scene_.geometries.push_back({std::move(positions), {}, std::move(indices)});
    scene::draw d;
    d.node = d.mesh = d.material = d.geometry = number;
    scene_.draws.push_back(d);
    return first;
  }

  scene::scene scene_;
  std::uint32_t polygons_ = 0;
};

}  // namespace sightcell::test
