#pragma once
// A scene with triangles of all sizes and kinds around the origin, and poses in it: slivers, triangles below a pixel,
// triangles that reach behind the viewpoint, shared edges, masks with all wrap modes. Made with additions,
// multiplications, divisions and square roots alone, so it has the same bits on every machine.
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "hemicube/hemicube_source.h"
#include "sightcell/scene/scene.h"

namespace sightcell::test {

class rubble_maker {
 public:
  scene::world_geometry make() {
    add_masks();
    for (int i = 0; i < 5000; ++i) {
      const float size = 0.003f * static_cast<float>(1u << engine_() % 11);
      const glm::vec3 center = 20.0f * point();
      if (glm::dot(center, center) < 4.0f) continue;
      const auto corner = [&] { return center + size * point(); };
      const glm::vec3 a = corner(), b = corner(), c = i % 5 == 0 ? 0.999f * b + 0.001f * corner() : corner();
      scene::polygon_kind kind;
      kind.double_sided = i % 3 == 0;
      if (i % 7 == 0) kind.alpha = scene::alpha_mode::blend;
      if (i % 11 == 0)
        add_masked(a, b, c, kind);
      else
        add(a, b, c, kind);
    }
    scene::polygon_kind both_sides;
    both_sides.double_sided = true;
    for (int i = 0; i < 12; ++i) {  // large
      const auto corner = [&] {
        const glm::vec3 p = point();
        return glm::vec3(90.0f * p.x, -4.0f + 3.0f * p.y, 90.0f * p.z);
      };
      const glm::vec3 a = corner(), b = corner(), c = corner();
      if (i % 3 == 0)
        add_masked(a, b, c, both_sides);
      else
        add(a, b, c, both_sides);
    }
    for (int i = 0; i < 30; ++i) {  // edge to edge
      const float x = 0.5f * static_cast<float>(i) - 8.0f;
      add({x, -3, -9}, {x + 0.5f, -3, -9}, {x + 0.5f, -2, -9}, scene::polygon_kind());
      add({x, -3, -9}, {x + 0.5f, -2, -9}, {x, -2, -9}, scene::polygon_kind());
    }
    return world_;
  }

 private:
  float number() { return static_cast<float>(engine_() >> 8) / 8388608.0f - 1.0f; }  // -1 to 1
  glm::vec3 point() {
    const float x = number(), y = number(), z = number();
    return {x, y, z};
  }

  void add_masks() {
    for (const scene::wrap u : {scene::wrap::repeat, scene::wrap::clamp, scene::wrap::mirror})
      for (const scene::wrap v : {scene::wrap::repeat, scene::wrap::clamp, scene::wrap::mirror}) {
        scene::alpha_mask mask;
        mask.width = 1 + static_cast<std::uint32_t>(engine_() % 9);
        mask.height = 1 + static_cast<std::uint32_t>(engine_() % 9);
        mask.wrap_u = u;
        mask.wrap_v = v;
        for (std::uint32_t k = 0; k < mask.width * mask.height; ++k)
          mask.texels.push_back(static_cast<std::uint8_t>(engine_() % 256));
        world_.masks.push_back(mask);
      }
  }

  void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, scene::polygon_kind kind) {
    for (const glm::vec3& p : {a, b, c}) {
      world_.indices.push_back(static_cast<std::uint32_t>(world_.positions.size()));
      world_.positions.push_back(p);
    }
    world_.kinds.push_back(kind);
  }

  void add_masked(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, scene::polygon_kind kind) {
    kind.alpha = scene::alpha_mode::mask;
    kind.alpha_tested = true;
    scene::masked_polygon masked;
    masked.id = static_cast<std::uint32_t>(world_.kinds.size());
    masked.mask = static_cast<std::uint32_t>(engine_() % world_.masks.size());
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 p = point();
      masked.uvs[k] = 3.0f * glm::vec2(p.x, p.y);
      masked.alphas[k] = 0.75f + 0.25f * p.z;
    }
    world_.masked.push_back(masked);
    add(a, b, c, kind);
  }

  std::mt19937 engine_{11};
  scene::world_geometry world_;
};

inline scene::world_geometry rubble() {
  return rubble_maker().make();
}

inline std::vector<bake::pose> rubble_poses() {
  const auto unit = [](const glm::vec3& a) { return a / std::sqrt(glm::dot(a, a)); };
  std::vector<bake::pose> made;
  for (int i = 0; i < 6; ++i) {
    const auto step = static_cast<float>(i);
    const float turn = 0.9f * step - 2.2f;  // a point of the circle for every number
    bake::pose p;
    p.eye = {0.1f * step, 0.3f, -0.2f};
    p.forward = unit({1.0f - turn * turn, 0.5f * static_cast<float>(i % 3 - 1), 2.0f * turn});
    p.right = unit(glm::cross(p.forward, glm::vec3(0.1f, 1, 0)));
    p.up = glm::cross(p.right, p.forward);
    made.push_back(p);
  }
  return made;
}

}  // namespace sightcell::test
