#include "casters/caster_search.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "bound/bound_rays.h"
#include "bound/clopper_pearson.h"
#include "bound/sequential_test.h"
#include "casters/shadow_batch.h"
#include "casters/visible_shadows.h"
#include "search/batch_plan.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

constexpr double eye_risk_share = 0.01;         // of an interim test's risk: too many viewpoints are counted as valid
constexpr std::uint64_t first_search = 16'384;  // trials
constexpr std::uint64_t largest_search = 262'144;
constexpr std::uint64_t rays_of_eye = 256;  // of a search, in the mean, for each viewpoint drawn for it
constexpr std::uint64_t most_tests_of_eye = 1024;
constexpr std::uint64_t stream_of_eyes = 1ull << 32;  // beyond the parts of a batch
constexpr std::uint64_t stream_of_candidates = 1ull << 33;
constexpr std::size_t eyes_of_candidates = 32;
constexpr std::uint64_t most_proofs = 40;  // batches: the risk of a later one would vanish beside 1
// Where at most this share of the target misses, a proof is likely after what is missed has joined.
constexpr double calm_share = 0.5;
// A polygon is tried alone if the shadow around one of its points fills this share of the target or more. Larger shares
// leave more to random rays; without a limit, casters that hardly a ray shows double the set.
constexpr double least_shadow_share = 3e-5;
// Share of the miss probability after a failed batch and another search. Where many small polygons cast shadows, each
// found alone, it falls slowly.
constexpr double left_after_search = 0.8;

// Returns the number of trials to cast for each one wanted, as the lower limit of trials falls short of them.
double trials_per_wanted(double wanted, double valid_share) {
  if (valid_share < fewest_valid) return 1.0;
  const double tests = std::max(256.0, wanted / valid_share / 256.0);
  return 1.02 + 3.5 * std::sqrt((1.0 - valid_share) / (valid_share * tests));
}

class caster_finder {
 public:
  caster_finder(const ray_scene& rays, const near_polygons* neighbors, const caster_cell& cell, const sun_arc& sun,
                const caster_search_settings& how)
      : rays_(rays), neighbors_(neighbors), cell_(cell), sun_(sun), how_(how), state_(rays.geometry().kinds.size()) {
    for (const std::uint32_t polygon : cell.camera) state_[polygon] = in_camera;
    sets_.camera = [this](std::uint32_t polygon) { return state_[polygon] == in_camera; };
    sets_.drawn = [this](std::uint32_t polygon) {
      return polygon >= how_.own_polygons || state_[polygon] == in_camera || state_[polygon] == caster;
    };
  }

  // See try_casters().
  std::uint64_t try_all(std::span<const std::uint32_t> candidates, std::vector<std::uint32_t>& casters) {
    for (const std::uint32_t polygon : casters) state_[polygon] = caster;
    random_stream random(how_.seed, cell_.place, purpose::caster_search, 0, stream_of_candidates);
    eyes_ = draw_viewpoints(rays_, cell_.region, how_.player_radius, eyes_of_candidates,
                            eyes_of_candidates * most_tests_of_eye, random, result_.rays_spent);
    for (const std::uint32_t polygon : candidates) {
      if (sets_.drawn(polygon) || rays_.geometry().kinds[polygon].absent) continue;
      joined_.clear();
      try_caster(polygon, eyes_, sun_.draw(random));
      if (neighbors_) look_beside();
    }
    list_casters(casters);
    return result_.rays_spent;
  }

  // See find_casters().
  caster_result run(const polygon_shadows* shadows) {
    shadows_ = shadows;
    std::uint64_t size = first_search;
    for (std::uint64_t number = 1; number <= most_proofs; ++number) {
      search(size);
      prove(number);
      if (result_.bound_met || result_.rays_spent >= how_.max_rays) break;
    }
    list_casters(result_.casters);
    return std::move(result_);
  }

 private:
  enum state : std::uint8_t { absent, in_camera, caster };

  void list_casters(std::vector<std::uint32_t>& casters) const {
    casters.clear();
    for (std::uint32_t polygon = 0; polygon < state_.size(); ++polygon)
      if (state_[polygon] == caster) casters.push_back(polygon);
  }

  shadow_batch batch(purpose use, std::uint64_t round) const {
    return {rays_, cell_.region, how_.player_radius, cell_.valid_share, sun_, {how_.seed, cell_.place, use, round},
            sets_};
  }

  // Casts batches of growing size until a batch that could prove the bound is likely to do so.
  void search(std::uint64_t& size) {
    const double enough = std::min(1.0 / how_.max_error, static_cast<double>(largest_search));
    while (result_.rays_spent < how_.max_rays) {
      shadow_batch trial = batch(purpose::caster_search, ++searches_);
      draw_eyes(size);
      if (eyes_.empty())
        trial.cast(size);
      else
        trial.cast_from(eyes_, size);
      result_.rays_spent += trial.spent();
      const bool calm =
          static_cast<double>(trial.misses()) <= calm_share * how_.max_error * static_cast<double>(size) &&
          static_cast<double>(size) >= enough;
      join(trial.missed());
      if (calm) return;
      try_polygons();
      size = std::min(2 * size, largest_search);
    }
  }

  // Tries all polygons, once.
  void try_polygons() {
    if (shadows_ == nullptr || eyes_.empty()) return;
    joined_.clear();
    for (const missed_shadow& one : missed_shadows_of_polygons(
             rays_, *shadows_, sets_, eyes_, {how_.seed, cell_.place, purpose::caster_search, searches_},
             least_shadow_share * how_.max_error, result_.rays_spent))
      join(one);
    shadows_ = nullptr;
  }

  // Draws further viewpoints for a search. A ray of a search counts for itself alone, so one valid viewpoint serves
  // many, and no ray begins at an invalid one. None are drawn where hardly any is valid: shadow_batch tests them all.
  void draw_eyes(std::uint64_t rays) {
    if (cell_.valid_share < fewest_valid) return;
    random_stream random(how_.seed, cell_.place, purpose::caster_search, searches_, stream_of_eyes);
    const std::uint64_t wanted = rays / rays_of_eye;
    const std::vector<glm::vec3> drawn = draw_viewpoints(rays_, cell_.region, how_.player_radius, wanted,
                                                         wanted * most_tests_of_eye, random, result_.rays_spent);
    eyes_.insert(eyes_.end(), drawn.begin(), drawn.end());
  }

  // Casts one batch of independent trials; see plan_interim_tests. It ends where another search and batch are
  // expected to cost less.
  void prove(std::uint64_t number) {
    shadow_batch trial = batch(purpose::caster_bound, number);
    const std::vector<interim_test> plan = plan_interim_tests(how_.max_error, risk_of_batch(number), eye_risk_share);
    for (const interim_test& next : plan) {
      if (next.misses < trial.misses()) continue;
      std::uint64_t trials = trial.trials(eye_risk_share * next.risk);
      while (trials < next.trials && trial.spent() < how_.max_rays) {
        const auto more = static_cast<double>(next.trials - trials);
        trial.cast(static_cast<std::uint64_t>(std::max(trials_per_wanted(more, cell_.valid_share) * more, 1.0)));
        trials = trial.trials(eye_risk_share * next.risk);
      }
      take(std::max(std::min(trials, next.trials), trial.misses()), trial.misses(), next.risk);
      if (trial.misses() <= next.misses || trials < next.trials) break;
      const double done = static_cast<double>(trials), rate = static_cast<double>(trial.misses()) / done;
      const double left = expected_trials(plan, rate, trial.misses(), trials) - done;
      const double again = static_cast<double>(largest_search) + expected_trials(plan, left_after_search * rate);
      if (!std::isfinite(left) || left > again) break;
    }
    result_.rays_spent += trial.spent();
    join(trial.missed());
  }

  // Sets only grow, so the smallest bound of all batches holds.
  void take(std::uint64_t trials, std::uint64_t misses, double risk) {
    const double bound = clopper_pearson_upper(misses, trials, 1.0 - (1.0 - eye_risk_share) * risk);
    if (result_.rays > 0 && bound >= result_.upper_bound) return;
    result_.rays = trials, result_.misses = misses;
    result_.upper_bound = bound, result_.confidence = 1.0 - risk;
    result_.bound_met = bound <= how_.max_error;
  }

  void join(const std::vector<missed_shadow>& missed) {
    joined_.clear();
    for (const missed_shadow& one : missed) join(one);
    if (neighbors_) look_beside();
  }

  // Earlier shadows of the same batch may have brought what this one lacks.
  void join(const missed_shadow& one) {
    const std::vector<std::uint32_t>& blockers = one.lacking.one_of;
    if (!blockers.empty() && std::none_of(blockers.begin(), blockers.end(), sets_.drawn)) {
      add(blockers.front(), one);
      add(blockers.back(), one);
    }
    for (const std::uint32_t polygon : one.lacking.each) add(polygon, one);
  }

  void add(std::uint32_t polygon, const missed_shadow& from) {
    if (sets_.drawn(polygon)) return;
    state_[polygon] = caster;
    joined_.push_back({polygon, from.eye, from.to_light});
  }

  // Tries the neighbors of each polygon that joined: those whose shadow is seen from the same viewpoint join too.
  void look_beside() {
    for (std::size_t i = 0; i < joined_.size(); ++i) {
      const found one = joined_[i];
      neighbors_->for_each(one.polygon, [&](std::uint32_t polygon) {
        if (!sets_.drawn(polygon)) try_caster(polygon, {&one.eye, 1}, one.to_light);
      });
    }
  }

  struct found {
    std::uint32_t polygon = 0;
    glm::vec3 eye{0.0f}, to_light{0.0f};  // of a shadow of it that is seen
  };

  // Joins the polygon if the shadow of one of some points of it falls on something that one of the viewpoints sees.
  void try_caster(std::uint32_t polygon, std::span<const glm::vec3> eyes, const glm::vec3& to_light) {
    sight below;
    for (std::size_t i = 0; i < shadow_points; ++i) {
      const glm::vec3 on = shadow_point(rays_.geometry(), polygon, i);
      ++result_.rays_spent;
      rays_.trace(on - beside_polygon * to_light, -to_light, below);
      if (below.front == no_polygon || !sets_.camera(below.front)) continue;
      const glm::vec3 point = on - to_light * (beside_polygon + below.distance);
      for (const glm::vec3& eye : eyes)
        if (sees(eye, point, below.front, to_light)) break;
      if (sets_.drawn(polygon)) return;
    }
  }

  // Returns whether a viewpoint sees a point of a polygon. If so, what its shadow lacks joins.
  bool sees(const glm::vec3& eye, const glm::vec3& point, std::uint32_t receiver, const glm::vec3& to_light) {
    const float distance = glm::length(point - eye);
    if (!(distance > 0.0f)) return false;
    const sight_line line{eye, (point - eye) / distance};
    sight seen;
    rays_.trace(line.eye, line.direction, seen);
    if (seen.front != receiver) return false;
    std::vector<missed_shadow> missed;
    if (lacks_shadow(rays_, line, seen, to_light, sets_, missed))
      for (const missed_shadow& one : missed) join(one);
    return true;
  }

  const ray_scene& rays_;
  const near_polygons* neighbors_;
  const caster_cell& cell_;
  const sun_arc& sun_;
  const caster_search_settings& how_;
  std::vector<state> state_;  // by polygon
  caster_sets sets_;
  std::vector<found> joined_;
  std::vector<glm::vec3> eyes_;               // valid viewpoints that the rays of a search begin at
  const polygon_shadows* shadows_ = nullptr;  // until they are tried
  std::uint64_t searches_ = 0;
  caster_result result_;
};

}  // namespace

caster_result find_casters(const ray_scene& rays, const near_polygons* neighbors, const polygon_shadows* shadows,
                           const caster_cell& cell, const sun_arc& sun, const caster_search_settings& how) {
  return caster_finder(rays, neighbors, cell, sun, how).run(shadows);
}

std::uint64_t try_casters(const ray_scene& rays, const near_polygons* neighbors, const caster_cell& cell,
                          const sun_arc& sun, const caster_search_settings& how,
                          std::span<const std::uint32_t> candidates, std::vector<std::uint32_t>& casters) {
  return caster_finder(rays, neighbors, cell, sun, how).try_all(candidates, casters);
}

}  // namespace sightcell::bake
