#pragma once
// What else does a cell see? Hemicubes from new places and rays beside what is known, by turns.
#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "bound/metric.h"
#include "cell_set/cell_set.h"
#include "hemicube/hemicube_source.h"
#include "search/guided_views.h"
#include "search/near_polygons.h"
#include "search/refinement.h"
#include "sightcell/base/time_limit.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Hemicubes that a search may take.
struct search_views {
  guided_views places;
  hemicube_source& source;
  std::uint32_t most = 0xFFFFFFFFu;  // with those taken before
};

// Rays go beside all that is worth so much, in sr, of the error to reach; with each doubling of the hemicubes beside a
// quarter of that: the more is known, the smaller is what is missing.
double priority_beside(double max_pixel_error);
double priority_after(double priority, std::uint32_t hemicubes);

struct search_settings {
  std::uint64_t seed = 0, place = 0;
  float smallest_gap = 0.0f;
  const time_limit* limit = nullptr;  // null: none
  const error_metric* metric = &pixel_metric;
  // As in refinement_settings.
  std::size_t known = 0;
  double tried = 0.0;
};

// What may be missing, by the metric: values that are about as likely as each other, ascending.
using error_guess = std::array<double, 5>;

struct search_goal {
  double priority = 0.0;                         // sr: what rays go beside of after the first round
  std::uint64_t max_cost = 0xFFFFFFFFFFFFFFFFu;  // in rays, with what was spent before
  // Is so little missing, by the metric, that another round of hemicubes at this cost, in rays, does not pay? Null:
  // hemicubes are taken until they are spent.
  std::function<bool(const error_guess& missing, std::uint64_t cost)> enough = {};
};

class cell_search {
 public:
  // views: null, rays alone. References must outlive the object; nobody else may change the set between its calls but
  // by adding.
  cell_search(const ray_scene& rays, const near_polygons& neighbors, search_views* views, const search_settings& how,
              cell_set& set);

  // Rounds of hemicubes, each with rays beside what they saw, until what they show is enough or none is left.
  void look_for(const search_goal& goal);
  // Rays beside all that is known, as far as the last round went. For polygons that others found.
  void look_beside(std::uint64_t max_cost);

  // Of the next round of hemicubes, in rays; 0 where there is none.
  std::uint64_t cost_of_views() const;
  // By the share of the last round's pixels that show what was not known, weighed, or by what was heard since. All 1:
  // nothing is known of it.
  const error_guess& missing() const { return missing_; }
  // A batch of rays found so much missing.
  void hear(double missing);
  // In rays: a hemicube counts by what it sees.
  std::uint64_t spent() const { return spent_; }
  std::uint64_t rays() const { return cast_; }

 private:
  bool may_view() const;
  std::uint32_t next_views() const;
  bool over() const { return how_.limit && how_.limit->reached(); }
  void view();
  double take(const std::vector<pose>& poses);

  const ray_scene& rays_;
  search_views* views_;
  const search_settings how_;
  cell_set& set_;
  std::vector<glm::vec3> places_;  // where hemicubes stood and rays began
  refinement beside_;
  double priority_ = 0.0;     // of the goal, sr
  std::uint32_t deeper_ = 0;  // searches without hemicubes: each goes on as if their number had doubled
  double cost_of_view_, cost_of_round_ = 0.0;  // of one hemicube, as the last round had it; of that round so far
  error_guess missing_;
  std::uint64_t spent_ = 0, cast_ = 0;
};

}  // namespace sightcell::bake
