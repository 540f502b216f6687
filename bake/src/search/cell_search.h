#pragma once
// Searches for the polygons visible from a cell. Rounds of hemicubes alternate with rays toward the neighbors of
// known members (verified dilation).
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

// The hemicubes that a search may render.
struct search_views {
  guided_views poses;  // where they are placed
  hemicube_source& source;
  std::uint32_t most = 0xFFFFFFFFu;  // limit on all hemicubes of the cell, including those rendered before
};

// Returns the priority, in sr, down to which verified dilation casts rays for this target of the miss probability.
double priority_beside(double max_pixel_error);
// Returns that priority after a number of hemicubes. Each doubling of them divides it by four: the larger the set,
// the smaller are the polygons that it lacks.
double priority_after(double priority, std::uint32_t hemicubes);

// The parameters of a search in one cell.
struct search_settings {
  std::uint64_t seed = 0, place = 0;
  float smallest_gap = 0.0f;          // meters, see aimed_rays
  const time_limit* limit = nullptr;  // null: no limit
  const error_metric* metric = &pixel_metric;
  double priority = 0.0;  // lowest priority, in sr, of rays after the first round
  // See refinement_settings.
  std::size_t known = 0;
  double tried = 0.0;
};

// Five equally likely estimates of the miss probability under the metric, ascending.
using error_guess = std::array<double, 5>;

// When a search may stop.
struct search_goal {
  std::uint64_t max_cost = 0xFFFFFFFFFFFFFFFFu;  // limit on the cost including what was spent before, in rays
  // Returns whether the estimated miss probability is so low that another round of hemicubes does not pay.
  // missing: the estimates.
  // cost: cost of that round, in rays.
  // Null: hemicubes are rendered until none is left.
  std::function<bool(const error_guess& missing, std::uint64_t cost)> enough = {};
  // Returns the expected cost of the next batch of verification rays, in rays.
  // missing: an estimate of the miss probability.
  // Null: the search ends after the rays beside its last round.
  std::function<double(double missing)> cost_of_batch = {};
};

// The search in one cell. Its state lasts over several calls.
class cell_search {
 public:
  // views: null: the search uses rays alone.
  // References must outlive the object. Between its calls other code may only add to the set.
  cell_search(const ray_scene& rays, const near_polygons& neighbors, search_views* views, const search_settings& how,
              cell_set& set);

  // Renders rounds of hemicubes, each followed by rays toward neighbors of the set, until goal.enough returns true,
  // the cost is spent, the time limit is reached or no hemicube is left. Where no round is rendered, it casts rays
  // alone, with a lower priority each time. With goal.cost_of_batch the priority of rays then falls until they cost
  // half of the batch that follows, because the more is missing, the longer is a batch that proves the target.
  void look_for(const search_goal& goal);
  // Renders hemicubes until none is left, in rounds, without rays.
  void look_around();
  // Renders full cubes at up to 8 places spread over those where verification rays missed, because hemicubes rarely
  // come to a small part of the cell that sees what the rest does not. Does nothing if there are fewer places: rays
  // toward the neighbors of what was missed cost less.
  void look_from(std::vector<glm::vec3> missed, std::uint64_t max_cost);
  // Casts rays toward the neighbors of all members down to the priority of the last round. For members that were
  // added by other code.
  void look_beside(std::uint64_t max_cost);

  // Returns the expected cost of the next round of hemicubes in rays; 0 if there is none.
  std::uint64_t cost_of_views() const;
  // Returns the cost of a verification ray, in rays of the search. It grows with the share of polygons with an alpha
  // test among those that hemicubes showed.
  double cost_of_verification_ray() const;
  // Returns the estimates of the miss probability. They follow from the share of the last round's pixels that showed
  // new polygons, weighted by the metric, or from the last call of hear(). All 1: nothing is known.
  const error_guess& missing() const { return missing_; }
  // Sets the estimates from the miss probability that a batch of verification rays measured.
  void hear(double missing);
  // Returns the cost so far in rays. A hemicube costs a number of rays that depends on its resolution and on what it
  // shows.
  std::uint64_t spent() const { return spent_; }
  // Returns the number of rays cast, without hemicubes.
  std::uint64_t rays() const { return cast_; }

 private:
  bool may_view() const;
  std::uint32_t next_views() const;
  // Returns whether the time allows another turn of hemicubes. It allows the first one always: a set of nothing would
  // hide everything.
  bool has_time() const;
  bool is_over() const { return how_.limit && how_.limit->reached(); }
  // Renders one round of hemicubes and updates the estimates.
  void view();
  double take(const std::vector<pose>& poses);

  const ray_scene& rays_;
  search_views* views_;
  const search_settings how_;
  cell_set& set_;
  std::vector<glm::vec3> viewpoints_;  // viewpoints of hemicubes and origins of rays
  refinement dilation_;
  // Number of searches by rays beyond those after hemicubes. Each lowers the priority as if the number of hemicubes had
  // doubled.
  std::uint32_t searches_by_rays_ = 0;
  // In rays: of one hemicube, as measured in the last round; of the current round so far.
  double cost_of_view_, cost_of_round_ = 0.0;
  double seen_ = 0.0, masked_ = 0.0;  // polygons in all hemicubes so far, and those of them with an alpha test
  error_guess missing_;
  std::uint64_t spent_ = 0, cast_ = 0;
};

}  // namespace sightcell::bake
