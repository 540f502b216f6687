#include "finish/ray_finish.h"

#include <algorithm>
#include <cmath>

#include "bound/bound_rays.h"
#include "bound/clopper_pearson.h"
#include "finish/cell_search.h"

namespace sightcell::bake {
namespace {

constexpr double share_of_places = 0.01;  // of a batch's risk: of taking too many places for free ones
constexpr double of_a_bound_ray = 0.2;    // of what a ray aimed costs
constexpr double left_after_next = 0.45;  // of what is missing, when another round of hemicubes has joined
constexpr double without_hearsay = 0.1;   // of the target: what is thought to be missing where nothing is known

// What part of a batch fails, by `risk` for the places alone.
double risk_of(std::uint64_t batch) {
  return 0.05 / std::ldexp(1.0, static_cast<int>(std::min<std::uint64_t>(batch, 1000)));
}

// More rays than trials are wanted, because fewer count than are cast: the share of free places is known from about a
// hundred, and then a limit is taken from those that are tested, 256 or more.
double headroom(double trials, double free_share) {
  if (free_share < fewest_free) return 1.02;  // all places are tested
  constexpr double deviations = 3.5;
  const double tests = std::max(256.0, trials / free_share / 256.0);
  return 1.1 + deviations * std::sqrt((1.0 - free_share) / (free_share * tests));
}

// The shortest batch that will do with a good chance if so much is missing, and that chance. What a batch misses is a
// hint, but a dear one: one that is too short is lost.
struct planned_batch {
  std::uint64_t trials = 0;
  bool likely = false;
};

planned_batch plan_batch(double missing, double target, double confidence) {
  constexpr double good_chance = 0.8;
  constexpr std::uint64_t most_misses = 64;
  planned_batch planned;
  for (std::uint64_t k = 0; k <= most_misses && !planned.likely; ++k) {
    planned.trials = trials_allowing(k, target, confidence);
    planned.likely = about_at_most(k, planned.trials, missing) >= good_chance;
  }
  return planned;
}

// Does a batch now cost less than another round of hemicubes and the shorter batch after it?
bool batch_pays(double missing, std::uint64_t cost_of_views, double target, double confidence, double cost_of_trial) {
  // Where nothing is known a cheap batch is the quickest to say how much is missing.
  if (missing >= 1.0)
    return cost_of_trial * static_cast<double>(trials_without_miss(target, confidence)) <=
           static_cast<double>(cost_of_views);
  const planned_batch now = plan_batch(missing, target, confidence),
                      later = plan_batch(left_after_next * missing, target, confidence);
  return now.likely &&
         cost_of_trial * static_cast<double>(now.trials - later.trials) <= static_cast<double>(cost_of_views);
}

}  // namespace

finish_result finish_with_rays(const ray_scene& rays, const near_polygons& neighbors, const box& grown,
                               const finish_settings& how, cell_set& set, search_views* views) {
  finish_result result;
  const double target = how.max_pixel_error, worth = worth_beside(target);
  cell_search search(rays, neighbors, views,
                     {.seed = how.seed,
                      .place = how.place,
                      .smallest_gap = how.rules.smallest_gap,
                      .limit = how.limit,
                      .metric = how.rules.metric,
                      .known = views ? how.known : 0,
                      .tried = views ? worth_after(worth, views->places.taken()) : 0.0},
                     set);
  const double cost_of_trial = of_a_bound_ray / std::max(how.free_share, 1e-3);
  std::uint64_t of_batches = 0;
  int too_short = 0;       // batches that failed though nothing missed
  double of_misses = 0.0;  // the confidence that is left for misses; the rest is for how many places are free
  search_goal goal{.worth = worth};
  goal.enough = [&](double missing, std::uint64_t cost) {
    return batch_pays(missing, cost, target, of_misses, cost_of_trial);
  };

  for (std::uint64_t batch = 1; batch == 1 || result.rays_spent < how.max_rays; ++batch) {
    const double risk = risk_of(batch);
    of_misses = 1.0 - (1.0 - share_of_places) * risk;
    goal.max_cost = how.max_rays - std::min(how.max_rays, of_batches);
    search.look_for(goal);
    result.rays_spent = of_batches + search.spent();

    // Rays alone know little of how much is missing: their batches double.
    const double missing = search.missing() < 1.0 ? search.missing() : without_hearsay * target;
    const double most = std::ldexp(static_cast<double>(trials_without_miss(target, of_misses)),
                                   static_cast<int>(std::min<std::uint64_t>(batch, 30)) + (views ? 4 : 0));
    const double trials = std::min(static_cast<double>(plan_batch(missing, target, of_misses).trials), most);
    const double wanted = headroom(trials, how.free_share) * std::ldexp(trials, too_short);
    const std::uint64_t left = how.max_rays - std::min(result.rays_spent, how.max_rays);
    const std::uint64_t count =
        std::clamp<std::uint64_t>(static_cast<std::uint64_t>(wanted), 1, std::max<std::uint64_t>(left, 1));
    const fresh_batch fresh = cast_bound_rays(
        rays, grown, how.rules, {.trials = count, .free_share = how.free_share, .risk = share_of_places * risk},
        {how.seed, how.place, purpose::bound, batch}, [&](std::uint32_t polygon) { return set.contains(polygon); });
    result.rays = fresh.rays;
    result.misses = fresh.misses;
    result.confidence = 1.0 - risk;
    result.upper_bound = clopper_pearson_upper(fresh.misses, fresh.rays, of_misses);
    result.bound_met = result.upper_bound <= target;
    of_batches += std::max<std::uint64_t>(fresh.rays + fresh.places, 1);

    for (const missed_polygon& m : fresh.missed) set.add(m.polygon, m.eye);
    search.look_beside(how.max_rays - std::min(how.max_rays, of_batches));
    result.rays_spent = of_batches + search.spent();
    if (result.bound_met || (how.limit && how.limit->reached())) break;
    if (fresh.misses == 0) ++too_short;
    search.hear(static_cast<double>(fresh.misses) / static_cast<double>(std::max<std::uint64_t>(fresh.rays, 1)));
  }
  return result;
}

}  // namespace sightcell::bake
