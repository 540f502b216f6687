#pragma once
// Finds what one ray contributes to all cells: traces a line, and finds the cells that it crosses and the polygons
// visible at its ends.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sampler/free_memory.h"
#include "sampler/global_rays.h"
#include "sampler/seen_pairs.h"
#include "sampler/segment_cells.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// A polygon that a ray found for a cell.
struct found_pair {
  std::uint32_t cell = 0, polygon = no_polygon;
  glm::vec3 eye{0.0f};    // valid viewpoint of the cell
  glm::vec3 point{0.0f};  // on the polygon; the same for all cells of a ray
  std::uint64_t ray = 0;
};

// The result of a test of a viewpoint.
struct place_asked {
  std::uint32_t cell = 0, part = 0;
  bool free = false;
};

// The results of rays, in the order of the rays.
struct feed_finds {
  std::vector<found_pair> found;
  std::vector<blocked_ray> blocked;
  std::vector<place_asked> asked;
};

struct feed_rules {
  float player_radius = 0.05f, smallest_gap = 0.002f;
  std::uint64_t seed = 1, round = 0;  // keys of the random numbers
};

// For one thread and one round. The pairs must not change while rays are cast.
class ray_feed {
 public:
  // places: of the cells, keys of their random numbers. All references must outlive the object.
  ray_feed(const ray_scene& rays, const segment_cells& cells, std::span<const std::uint64_t> places,
           std::span<const seen_pairs> known, const free_memory& memory, const feed_rules& rules)
      : rays_(rays), cells_(cells), places_(places), known_(known), memory_(memory), rules_(rules) {}

  // Records the polygons that the cells crossed by the ray do not have yet. For each cell one random point of the
  // line inside it is the viewpoint for both directions. It is tested only if something is new, and counts only if it
  // is valid.
  void cast(const global_ray& ray, std::uint64_t number);
  // Returns the results of all rays since the last call.
  feed_finds take();

 private:
  struct thing {  // a polygon on the line
    std::uint32_t polygon;
    float at;
  };
  bool trace(const global_ray& ray);
  bool meets_back(const global_ray& ray, float way, float& clear);
  float trace_on(const global_ray& ray, float way, float clear);
  void note_new(const global_ray& ray, const crossing& through, float at, std::uint64_t number,
                std::vector<found_pair>& found);

  const ray_scene& rays_;
  const segment_cells& cells_;
  std::span<const std::uint64_t> places_;
  std::span<const seen_pairs> known_;
  const free_memory& memory_;
  const feed_rules rules_;

  // The line by distance from the ray's origin. Between clear_from and clear_to no polygon occludes in either
  // direction. From there to from and to no polygon occludes a view away from the origin.
  float from_ = 0.0f, to_ = 0.0f, clear_from_ = 0.0f, clear_to_ = 0.0f;
  std::vector<thing> things_;
  sight seen_;
  std::vector<crossing> crossed_;
  feed_finds finds_;
  std::vector<found_pair> new_;
  std::vector<glm::vec3> eyes_;     // of new_
  std::vector<place_asked> asked_;  // per eye of eyes_
  std::vector<std::size_t> ends_;   // per eye of eyes_, in new_
};

}  // namespace sightcell::bake
