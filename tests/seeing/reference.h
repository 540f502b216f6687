#pragma once
// Which polygons a cell sees, by brute force: the rules of docs/method/visibility-rules.md written down once more, in
// double precision, with plain loops over all polygons and nothing of the bake. Slow and meant to be: for scenes of
// some fifty polygons.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::test {

// The settings that decide what is seen; meters.
struct seeing_rules {
  double smallest_gap = 0.002;
  double player_radius = 0.05;
  bool all_double_sided = false;
  scene::animated_as animated = scene::animated_as::always;
};

// The grown box of a cell.
struct place_box {
  glm::dvec3 min{0.0}, max{0.0};
};

// How hard to look. Eyes lie in strata x strata x strata boxes, so many times each; places that are not free are left
// out.
struct seeing_effort {
  int strata = 8, passes = 2;
  int directions = 100;      // per eye, uniform on the sphere
  int aims_per_polygon = 2;  // per eye, at random points of every polygon
  std::uint64_t seed = 4711;
};

struct seen_polygons {
  std::uint64_t eyes = 0;            // free ones
  std::uint64_t rays = 0;            // uniform ones
  std::vector<std::uint64_t> hits;   // per polygon, uniform rays that see it
  std::vector<std::uint64_t> aimed;  // per polygon, aimed rays that see it, whichever they were aimed at
  std::vector<bool> inside;          // rule 4: touches the box and faces a free place of it
  std::vector<bool> told;            // rule 6: in the set without being seen: always, levels of detail
  double share(std::uint32_t polygon) const {
    return rays == 0 ? 0.0 : static_cast<double>(hits[polygon]) / static_cast<double>(rays);
  }
  bool never_seen(std::uint32_t polygon) const { return hits[polygon] == 0 && aimed[polygon] == 0; }
  bool belongs(std::uint32_t polygon) const { return !never_seen(polygon) || inside[polygon] || told[polygon]; }
};

// What one ray sees. Polygons behind a crack (rule 3) are left out of both lists.
struct ray_view {
  double distance = std::numeric_limits<double>::infinity();  // of the front surface
  std::vector<std::uint32_t> front;   // the surface that ends the ray and all that coincides with it (rule 2)
  std::vector<std::uint32_t> before;  // what it is seen through
};

class brute_force {
 public:
  brute_force(const scene::scene& s, const seeing_rules& rules);

  // direction: of length 1.
  void look(const glm::dvec3& eye, const glm::dvec3& direction, ray_view& out) const;
  // Of those of 64 fixed directions that end at an opaque single-sided polygon, the share that ends at its back.
  double backs(const glm::dvec3& place) const;
  bool is_free(const glm::dvec3& place) const;
  bool touches(std::uint32_t polygon, const place_box& box) const;
  bool faces(std::uint32_t polygon, const glm::dvec3& eye) const;

  seen_polygons see(const place_box& grown, const seeing_effort& effort) const;
  // The probability that a ray is wrong, had the cell this set.
  double error_of(const std::vector<std::uint32_t>& set, const place_box& grown, const seeing_effort& effort) const;

 private:
  struct surface {
    std::array<glm::dvec3, 3> corners;
    glm::dvec3 normal{0.0};  // of any length; toward the front
    std::array<glm::dvec2, 3> uvs{};
    const scene::alpha_map* map = nullptr;
    double alpha = 1.0, cutoff = 0.5;
    scene::alpha_mode mode = scene::alpha_mode::opaque;
    bool double_sided = false, absent = false, always = false, non_occluder = false;
    std::vector<std::uint32_t> same;  // rule 2: seen when this one is

    bool occludes() const { return !absent && !non_occluder && mode != scene::alpha_mode::blend; }
  };
  struct hit {
    double distance;
    std::uint32_t polygon;
  };

  void add_draw(const scene::scene& s, const scene::draw& d, const seeing_rules& rules);
  void find_duplicates();
  bool meets(const surface& p, const glm::dvec3& eye, const glm::dvec3& direction, double& distance) const;
  bool is_there(const surface& p, double along_first, double along_second) const;
  bool blocked(const glm::dvec3& eye, const glm::dvec3& direction, double before) const;
  bool through_crack(const glm::dvec3& eye, const glm::dvec3& direction, double distance) const;
  void add_told(seen_polygons& out) const;
  template <typename Each>
  std::uint64_t for_free_places(const place_box& grown, const seeing_effort& effort, Each each) const;

  seeing_rules rules_;
  std::vector<surface> surfaces_;
  struct detail_levels {
    std::uint32_t object = 0;
    std::vector<std::uint32_t> finest, coarser;
  };
  std::vector<detail_levels> levels_;
};

}  // namespace sightcell::test
