#include "search/certify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "bound/bound_rays.h"
#include "bound/clopper_pearson.h"
#include "bound/sequential_test.h"
#include "search/batch_plan.h"
#include "search/cell_search.h"
#include "search/volume_search.h"

namespace sightcell::bake {
namespace {

// Of an interim test's risk: that too many viewpoints are counted as valid.
constexpr double viewpoint_risk_share = 0.01;
constexpr double search_share = 0.6;  // of the time that is left, before each batch
// Cost of a verification ray, in aimed rays, where a batch is planned. In scenes of leaves it is twice as high, but a
// batch that may end early is tried there too: planning with the higher cost took a sixth more time.
constexpr double verification_ray_cost = 0.2;
// The risk of a later batch would vanish beside 1.
constexpr std::uint64_t most_batches = 40;

// Returns the number of rays to cast per trial wanted, 1 or more. Rays from invalid viewpoints are no trials. The
// share of valid viewpoints is an estimate from about a hundred points, and the number of trials is a lower limit
// that follows from the viewpoints tested, 256 or more, so a margin is added.
double headroom(double trials, double valid_share) {
  if (valid_share < fewest_valid) return 1.0;  // all viewpoints are tested
  constexpr double deviations = 3.5;
  const double tests = std::max(256.0, trials / valid_share / 256.0);
  return 1.02 + deviations * std::sqrt((1.0 - valid_share) / (valid_share * tests));
}

// The search for visibility volumes. It does nothing if there are none.
class search_of_volumes {
 public:
  search_of_volumes(const ray_scene& rays, const viewpoint_region& where, const finish_settings& how, cell_set& set)
      : priority_(first_priority * how.max_pixel_error * whole_sphere), rules_(how.rules) {
    if (!how.volumes) return;
    trial_.emplace(*how.volumes, set.volumes());
    rules_.volumes = &*trial_;
    search_ = std::make_unique<volume_search>(
        rays, *how.volumes, where,
        volume_search_settings{.seed = seed_after(how.batches_elsewhere + how.batches_before, how.seed),
                               .place = how.place,
                               .player_radius = how.rules.player_radius,
                               .smallest_gap = how.rules.smallest_gap,
                               .limit = how.limit},
        set);
  }

  // Searches with a lower priority each time.
  void look_for() {
    if (search_) search_->look_for(priority_);
    priority_ *= priority_of_next;
  }
  void add(std::span<const found_volume> found) {
    if (search_) search_->add(found);
  }
  std::uint64_t spent() const { return search_ ? search_->spent() : 0; }
  const visibility_rules& rules() const { return rules_; }

 private:
  static constexpr double first_priority = 3e-3,
                          priority_of_next = 0.25;  // of all directions, as a share of the target
  double priority_;
  visibility_rules rules_;
  std::optional<grid_trial> trial_;
  std::unique_ptr<volume_search> search_;  // null if there are no volumes
};

// The result of a batch.
struct proof {
  interim_test at;           // the last interim test: the trials and the risk of the bound
  std::uint64_t misses = 0;  // among these trials
};

// Returns the number of trials that the time of a limit allows, from the time of other rays: a number that follows from
// the rays of a batch itself would void its bound.
std::uint64_t trials_in(const time_limit& limit, bound_batch& other_rays) {
  constexpr std::uint64_t pilot = 4096, fewest = 8192;
  constexpr double share = 0.8;  // of the time that is left
  const double before = limit.spent();
  other_rays.cast(pilot);
  const double seconds = std::max(limit.spent() - before, 1e-9);
  const double trials = share * limit.left() / seconds * pilot;
  return static_cast<std::uint64_t>(std::clamp(trials, static_cast<double>(fewest), 1e15));
}

// The rays that a cell may spend. Where they do not suffice there are further rounds, each with as many rays again.
class ray_budget {
 public:
  ray_budget(std::uint64_t of_round, std::uint32_t further_rounds)
      : of_round_(of_round), further_rounds_(further_rounds), end_(of_round) {}

  std::uint64_t left(std::uint64_t spent) const { return end_ - std::min(end_, spent); }
  // Returns the rays of the next batch. In a further round they do not depend on what the search left, so that no batch
  // spends its share of the confidence on too few of them.
  std::uint64_t of_batch(std::uint64_t spent) const {
    return round_ > 0 ? of_round_ : std::max<std::uint64_t>(left(spent), 1);
  }
  std::uint32_t round() const { return round_; }  // 0: the first
  // Returns whether the cell goes on. If all is spent, another round begins, unless its rays cannot prove the target.
  // fewest: of a batch that can prove it.
  bool go_on(std::uint64_t spent, double fewest) {
    if (spent < end_) return true;
    if (round_ == further_rounds_ || fewest > static_cast<double>(of_round_)) return false;
    ++round_;
    end_ = spent + of_round_;
    return true;
  }

 private:
  std::uint64_t of_round_;
  std::uint32_t further_rounds_, round_ = 0;
  std::uint64_t end_;  // of the current round
};

// Takes the bound of a batch. Sets only grow, and the bounds of all batches hold together with the stated confidence,
// so the smallest one holds.
void take_bound(const proof& found, const bound_rays& of, double target, finish_result& result) {
  const double bound =
      clopper_pearson_upper(found.misses, found.at.trials, 1.0 - (1.0 - viewpoint_risk_share) * found.at.risk);
  if (result.rays > 0 && bound >= result.upper_bound) return;
  result.rays = found.at.trials;
  result.misses = found.misses;
  result.confidence = 1.0 - found.at.risk;
  result.upper_bound = bound;
  result.bound_met = bound <= target;
  result.of_bound = of;
}

void add_missed(const bound_batch& batch, cell_set& set) {
  const finding misses(set, found_by::verification);
  for (const missed_polygon& m : batch.missed()) set.add(m.polygon, m.eye);
}

std::vector<glm::vec3> eyes_of_missed(const bound_batch& batch) {
  std::vector<glm::vec3> eyes;
  for (const missed_polygon& m : batch.missed()) eyes.push_back(m.eye);
  return eyes;
}

// Names the rays of a batch. Where every viewpoint is tested they are not known.
bound_rays bound_rays_of(const bound_batch& batch, std::uint64_t number, std::uint64_t name) {
  if (batch.parts().empty()) return {};
  return {static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(name), batch.parts()};
}

// Casts rays until an interim test meets the target, until finishing the batch is expected to cost more than another
// search and a new batch, or until max_cost is spent.
// most_trials: planned before the batch began.
// whole: the costs of another search do not end the batch.
// misses_before: of rays of the batch, before an edit of the scene.
proof prove(bound_batch& batch, const std::vector<interim_test>& interim_tests, const finish_settings& how,
            std::uint64_t cost_of_views, double cost_of_trial, std::uint64_t max_cost, std::uint64_t most_trials,
            bool whole, std::uint64_t misses_before = 0) {
  const double left = cost_of_views > 0 ? left_after_round : left_after_rays;
  const auto misses = [&] { return misses_before + batch.misses(); };
  for (interim_test next : interim_tests) {
    const bool last = next.misses == interim_tests.back().misses || next.trials >= most_trials;
    if (next.misses < misses() && !last) continue;
    next.trials = std::min(next.trials, most_trials);
    std::uint64_t trials = batch.trials(viewpoint_risk_share * next.risk);
    while (trials < next.trials && batch.spent() < max_cost) {
      const auto more = static_cast<double>(next.trials - trials);
      const double most = static_cast<double>(max_cost - batch.spent()) * std::max(how.valid_share, 1e-3);
      batch.cast(static_cast<std::uint64_t>(std::clamp(headroom(more, how.valid_share) * more, 1.0, most + 1.0)));
      if (batch.given_up()) return {};
      trials = batch.trials(viewpoint_risk_share * next.risk);
    }
    // The planned number of trials, even if there are more, because a planned number does not depend on the misses.
    const proof now{{next.misses, std::max(std::min(trials, next.trials), misses()), next.risk}, misses()};
    if (now.misses <= next.misses || trials < next.trials || last || (how.limit && how.limit->reached())) return now;
    if (whole) continue;
    const double rate = static_cast<double>(now.misses) / static_cast<double>(trials);
    const double until_proof = expected_trials(interim_tests, rate, now.misses, trials),
                 again = expected_trials(interim_tests, left * rate);
    const double finishing = cost_of_trial * (until_proof - static_cast<double>(trials));
    if (!std::isfinite(until_proof) || finishing > static_cast<double>(cost_of_views) + cost_of_trial * again)
      return now;
  }
  return {};  // not reached: the last interim test returns
}

// Casts the rays of an earlier batch again where the edit of the scene can have changed their result, and further ones
// where they probably prove the target for less than a new batch. Misses of then and now count.
proof prove_again(bound_batch& batch, const finish_settings& how, double cost_of_trial, std::uint64_t max_cost) {
  const cast_again& again = *how.again;
  batch.cast_only([&](const sight_line& ray) { return again.changed(ray); });
  for (const std::uint64_t rays : again.of.parts) batch.cast_rays(rays);
  batch.cast_only({});
  const double risk = 1.0 - again.confidence;
  const std::uint64_t misses = again.misses + batch.misses(),
                      trials = std::max(std::min(again.trials, batch.trials(viewpoint_risk_share * risk)), misses);
  const std::vector<interim_test> interim_tests =
      plan_interim_tests(how.max_pixel_error, risk_of_batch(again.of.number), viewpoint_risk_share);
  const double rate = static_cast<double>(misses) / static_cast<double>(std::max<std::uint64_t>(trials, 1));
  const double until_proof = expected_trials(interim_tests, rate, misses, trials),
               anew = expected_trials(interim_tests, left_after_rays * rate);
  if (batch.given_up() || !std::isfinite(until_proof) || until_proof - static_cast<double>(trials) > anew)
    return {{misses, trials, risk}, misses};
  return prove(batch, interim_tests, how, 0, cost_of_trial, max_cost, std::numeric_limits<std::uint64_t>::max(), false,
               again.misses);
}

// The search in a cell and its batches of verification rays, in turns.
class cell_certificate {
 public:
  cell_certificate(const ray_scene& rays, const near_polygons& neighbors, const viewpoint_region& where,
                   const finish_settings& how, cell_set& set, search_views* views)
      : rays_(rays),
        neighbors_(neighbors),
        where_(where),
        how_(how),
        set_(set),
        views_(views),
        limit_(how.limit ? *how.limit : no_limit),
        of_search_(limit_.part(search_share)),
        volumes_(rays, where, how, set),
        budget_(how.max_rays, how.further_rounds),
        rays_per_trial_(1.0 / std::max(how.valid_share, 1e-3)),
        cost_of_trial_(verification_ray_cost * rays_per_trial_),
        result_{.batches = how.batches_before} {}

  finish_result run() {
    const double missing = how_.again ? try_again() : how_.missing;
    if (result_.bound_met) return result_;
    cell_search search = search_of(
        views_ ? how_.known : 0, views_ ? priority_after(priority_beside(how_.known_to), views_->poses.taken()) : 0.0);
    if (missing < 1.0) search.hear(missing);
    while (take_turn(search)) {
    }
    result_.rounds = 1 + budget_.round();
    return result_;
  }

 private:
  cell_search search_of(std::size_t known, double tried) {
    return {rays_,
            neighbors_,
            views_,
            {.seed = seed_after(how_.batches_elsewhere + how_.batches_before, how_.seed),
             .place = how_.place,
             .smallest_gap = how_.rules.smallest_gap,
             .limit = &of_search_,
             .metric = how_.rules.metric,
             .priority = priority_beside(how_.max_pixel_error),
             .known = known,
             .tried = tried},
            set_};
  }

  bound_batch batch_of(purpose use, std::uint64_t name) const {
    return {rays_, where_, volumes_.rules(), how_.valid_share, {how_.seed, how_.place, use, name}, contains_, give_up_};
  }

  // Looks beside what an earlier bake did not know, and tries its bound. Returns the share of the rays that missed.
  double try_again() {
    bound_batch batch = batch_of(purpose::bound, how_.again->of.name);  // with the random numbers of the bound
    cell_search search = search_of(how_.known, 0.0);  // not beside what the earlier bake knew, because that bake did
    search.look_beside(budget_.left(0));
    const proof found = prove_again(batch, how_, cost_of_trial_, budget_.of_batch(0));
    (void)limit_.reached();  // throws where a stop was requested: the batch is not complete then
    if (!batch.given_up() && found.at.trials > 0)
      take_bound(found, {how_.again->of.number, how_.again->of.name, batch.parts()}, how_.max_pixel_error, result_);
    add_missed(batch, set_);
    search.look_beside(budget_.left(batch.spent()));
    of_batches_ = result_.rays_spent = batch.spent() + search.spent();
    return share_of(batch.misses(), found);
  }

  static double share_of(std::uint64_t misses, const proof& among) {
    return static_cast<double>(misses) / static_cast<double>(std::max<std::uint64_t>(among.at.trials, 1));
  }

  // Searches for polygons and volumes.
  void look(cell_search& search) {
    search_goal goal{
        .max_cost = budget_.left(of_batches_), .enough = [&](const error_guess& missing, std::uint64_t cost) {
          return !std::exchange(views_first_, false) && batch_pays(interim_tests_, missing, cost, cost_of_trial_);
        }};
    // Not before the first batch: most cells need no other.
    if (turns_ > 1)
      goal.cost_of_batch = [&](double missing) {
        const double trials = expected_trials(interim_tests_, missing);
        // Its first interim test shows whether a batch fails.
        return cost_of_trial_ * (std::isfinite(trials) ? trials : static_cast<double>(interim_tests_.front().trials));
      };
    of_search_ = limit_.part(how_.limit_ends_batches ? 1.0 : search_share);
    const std::uint32_t hemicubes = views_ ? views_->poses.taken() : 0;
    search.look_for(goal);
    if (views_ && views_->poses.taken() > hemicubes) batches_since_views_ = 0;
    volumes_.look_for();
    result_.rays_spent = of_batches_ + search.spent() + volumes_.spent();
  }

  // Returns the number of trials that the time allows the batch of this name.
  std::uint64_t most_trials_of(std::uint64_t name) const {
    if (!limit_.has_time() || how_.limit_ends_batches) return std::numeric_limits<std::uint64_t>::max();
    bound_batch pilot = batch_of(purpose::estimate, name);
    return trials_in(limit_, pilot);
  }

  // Searches, and casts a batch, whose misses join the set. Returns whether another turn follows.
  bool take_turn(cell_search& search) {
    const std::uint64_t number = how_.batches_before + ++turns_, name = how_.batches_elsewhere + number;
    interim_tests_ = plan_interim_tests(how_.max_pixel_error, risk_of_batch(number), viewpoint_risk_share);
    look(search);

    bound_batch batch = batch_of(purpose::bound, name);
    const std::uint64_t most_trials = most_trials_of(name);
    const proof found =
        prove(batch, interim_tests_, how_, search.cost_of_views(), cost_of_trial_, budget_.of_batch(result_.rays_spent),
              most_trials, batch_is_whole(batches_since_views_++));
    result_.batches = number;
    of_batches_ += std::max<std::uint64_t>(batch.spent(), 1);
    (void)limit_.reached();  // throws where a stop was requested: the batch is not complete then
    if (!batch.given_up()) take_bound(found, bound_rays_of(batch, number, name), how_.max_pixel_error, result_);

    add_missed(batch, set_);
    volumes_.add(batch.missed_volumes());
    of_search_ = limit_.part(1.0);
    if (!result_.bound_met) search.look_from(eyes_of_missed(batch), budget_.left(of_batches_));
    search.look_beside(budget_.left(of_batches_));
    result_.rays_spent = of_batches_ + search.spent() + volumes_.spent();
    if (result_.bound_met || limit_.reached() || number >= most_batches || most_trials < interim_tests_.front().trials)
      return false;
    // Misses of volumes are left out, because hemicubes and rays toward polygons find no volumes.
    search.hear(share_of(found.misses - std::min(found.misses, batch.misses_of_volumes()), found));
    return plan_next(number + 1, search);
  }

  // Returns whether the rays suffice for another turn. Decides whether it begins with hemicubes.
  bool plan_next(std::uint64_t number, const cell_search& search) {
    const std::vector<interim_test> next =
        plan_interim_tests(how_.max_pixel_error, risk_of_batch(number), viewpoint_risk_share);
    const std::uint32_t round = budget_.round();
    const bool more = budget_.go_on(result_.rays_spent, static_cast<double>(next.front().trials) * rays_per_trial_);
    const double cost_of_whole_batch =
        search.cost_of_verification_ray() * rays_per_trial_ * static_cast<double>(next.back().trials);
    views_first_ =
        budget_.round() > round ||
        hemicubes_follow(batches_since_views_, static_cast<double>(search.cost_of_views()), cost_of_whole_batch);
    return more;
  }

  const ray_scene& rays_;
  const near_polygons& neighbors_;
  const viewpoint_region& where_;
  const finish_settings& how_;
  cell_set& set_;
  search_views* views_;  // null: none
  const time_limit& limit_;
  time_limit of_search_;
  search_of_volumes volumes_;
  ray_budget budget_;
  double rays_per_trial_, cost_of_trial_;
  finish_result result_;
  std::vector<interim_test> interim_tests_;  // of the current batch
  std::uint64_t of_batches_ = 0, turns_ = 0, batches_since_views_ = 0;
  bool views_first_ = false;  // because batches and rays beside their finds did not suffice
  const std::function<bool(std::uint32_t)> contains_ = [this](std::uint32_t polygon) { return set_.contains(polygon); };
  const std::function<bool()> give_up_ = [this] {
    return limit_.stopped() || (how_.limit_ends_batches && limit_.has_time() && limit_.left() <= 0.0);
  };
};

}  // namespace

finish_result finish_with_rays(const ray_scene& rays, const near_polygons& neighbors, const viewpoint_region& where,
                               const finish_settings& how, cell_set& set, search_views* views) {
  const finding later(set, found_by::later_hemicubes);  // but for what rays find
  return cell_certificate(rays, neighbors, where, how, set, views).run();
}

}  // namespace sightcell::bake
