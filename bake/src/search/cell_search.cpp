#include "search/cell_search.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "cell_set/point_order.h"
#include "hemicube/hemicube_faces.h"
#include "search/gap_filter.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t first_round = 24, turn = 6;  // hemicubes
constexpr std::size_t cubes_of_misses = 8;
constexpr double least_of_target = 3e-4;  // of all directions, as a share of the target
// Rays toward neighbors after a batch that failed, as a share of the expected cost of the next one. On a wall of
// intel_castle at a target of 1e-5, a million of them halved what was missing; three such cells take 0.55 of the time.
constexpr double share_of_batch = 0.5;
// The miss probability that is left, divided by the one measured. After a round of hemicubes, once its finds and
// those of the rays after it have joined: one value for each fifth of the ratios measured in 34 rounds. After a batch
// of verification rays, once rays were cast toward the neighbors of its finds. Where these rarely hit, that changes
// little.
constexpr error_guess left_of_round{0.04, 0.14, 0.25, 0.43, 0.56}, left_of_batch{0.4, 0.6, 0.8, 1.0, 1.2},
    left_of_batch_where_rays_rarely_hit{0.8, 0.9, 1.0, 1.1, 1.2};

error_guess scaled(const error_guess& by, double of) {
  error_guess result = by;
  for (double& value : result) value *= of;
  return result;
}

// Returns the cost of a hemicube in aimed rays of about 2.5 us each, from its pixels, the polygons that it showed and
// those of them with an alpha test. On nine real scenes the measured cost is between half of this and twice this. A
// formula, because no result may depend on time.
double cost_of(std::uint32_t resolution, double seen, double masked) {
  return static_cast<double>(std::uint64_t{resolution} * resolution) / 650.0 + 0.25 * seen + 3.0 * masked;
}

// What a hemicube did not show from a witness is mostly smaller than a pixel there, however large the polygon is. So no
// priority is above the mean solid angle of a pixel, but each polygon gets one ray.
float largest_priority(const search_settings& how, const search_views* views) {
  if (!views) return largest_solid_angle;
  const double resolution = views->poses.resolution(), pixel = whole_sphere / 2.0 / (3.0 * resolution * resolution);
  return static_cast<float>(std::max(pixel, how.priority));
}

std::vector<glm::vec3> sorted_unique(std::vector<glm::vec3> points) {
  sort_unique(points);
  return points;
}

}  // namespace

double priority_beside(double max_pixel_error) {
  return least_of_target * max_pixel_error * whole_sphere;
}

double priority_after(double priority, std::uint32_t hemicubes) {
  for (std::uint64_t round = first_round; round < hemicubes; round *= 2) priority *= 0.25;
  return priority;
}

cell_search::cell_search(const ray_scene& rays, const near_polygons& neighbors, search_views* views,
                         const search_settings& how, cell_set& set)
    : rays_(rays),
      views_(views),
      how_(how),
      set_(set),
      viewpoints_(sorted_unique(set.eyes())),
      dilation_(rays, neighbors,
                {.seed = how.seed,
                 .place = how.place,
                 .smallest_gap = how.smallest_gap,
                 .viewpoints = &viewpoints_,
                 .limit = how.limit,
                 .largest_priority = largest_priority(how, views),
                 .known = how.known,
                 .tried = how.tried},
                set),
      cost_of_view_(views ? cost_of(views->poses.resolution(), 0.0, 0.0) : 0.0) {
  missing_.fill(1.0);
}

bool cell_search::may_view() const {
  return views_ && views_->poses.taken() < views_->most;
}

bool cell_search::has_time() const {
  return !is_over() || (views_ && views_->poses.taken() == 0);
}

// Each round doubles the number of hemicubes, so that the share of new pixels in it is an estimate of what was
// missing. Where rays find next to nothing, hemicubes alone must find the rest. Then a round costs most of the cell's
// time and often finds more than is needed, so that later rounds are by a half.
std::uint32_t cell_search::next_views() const {
  const std::uint32_t before = views_->poses.taken();
  const bool by_half = before >= 2 * first_round && dilation_.rarely_hits();
  return std::min(std::max(by_half ? before / 2 : before, first_round), views_->most - before);
}

std::uint64_t cell_search::cost_of_views() const {
  return may_view() ? static_cast<std::uint64_t>(next_views() * cost_of_view_) : 0;
}

// Measured: 0.2 to 0.4 where few polygons have an alpha test, 0.45 among leaves, where three of four seen have one.
double cell_search::cost_of_verification_ray() const {
  return 0.2 + (seen_ > 0.0 ? 0.35 * masked_ / seen_ : 0.0);
}

void cell_search::look_beside(std::uint64_t max_cost) {
  const double priority =
      std::ldexp(priority_after(how_.priority, views_ ? views_->poses.taken() : 0), -2 * searches_by_rays_);
  const std::uint64_t rays = dilation_.run(priority, max_cost - std::min(max_cost, spent_));
  spent_ += rays;
  cast_ += rays;
}

// Renders the poses. Returns the number of pixels that show new polygons, each weighted by the metric along the line
// through one pixel of its polygon.
double cell_search::take(const std::vector<pose>& poses) {
  gap_filter filtered(views_->source, rays_, set_, how_.smallest_gap);
  std::vector<hemicube_view> views(poses.size());
  filtered.render(poses, views);
  const std::function<bool(std::uint32_t)> contains = [this](std::uint32_t polygon) { return set_.contains(polygon); };
  double new_pixels = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    viewpoints_.push_back(poses[i].eye);
    double masked = 0.0;
    for (const seen_polygon& s : views[i].seen) {
      if (rays_.geometry().kinds[s.id].alpha_tested) ++masked;
      if (contains(s.id)) continue;
      const sight_line line{poses[i].eye, pixel_direction(poses[i], views_->poses.resolution(), s.pixel)};
      new_pixels += s.pixels * how_.metric->weight(s.id, line, contains);
    }
    cost_of_round_ += cost_of(views_->poses.resolution(), static_cast<double>(views[i].seen.size()), masked);
    seen_ += static_cast<double>(views[i].seen.size());
    masked_ += masked;
    set_.add_view(poses[i].eye, views[i].seen);
  }
  return new_pixels;
}

void cell_search::view() {
  const std::uint32_t before = views_->poses.taken(), resolution = views_->poses.resolution();
  const std::uint32_t count = next_views();
  double new_pixels = 0.0;
  std::uint32_t taken = 0;
  cost_of_round_ = 0.0;
  while (taken < count && has_time()) {
    const std::vector<pose> poses = views_->poses.next(std::min(turn, count - taken));
    if (poses.empty()) {
      views_->most = 0;  // no viewpoint is valid
      break;
    }
    new_pixels += take(poses);
    taken += static_cast<std::uint32_t>(poses.size());
  }
  spent_ += static_cast<std::uint64_t>(cost_of_round_);
  if (taken > 0) cost_of_view_ = cost_of_round_ / taken;
  if (before > 0 && taken > 0) missing_ = scaled(left_of_round, new_pixels / (3.0 * resolution * resolution * taken));
}

void cell_search::hear(double missing) {
  missing_ = scaled(dilation_.rarely_hits() ? left_of_batch_where_rays_rarely_hit : left_of_batch, missing);
}

void cell_search::look_from(std::vector<glm::vec3> missed, std::uint64_t max_cost) {
  sort_unique(missed);
  if (missed.size() < cubes_of_misses) return;
  std::vector<glm::vec3> eyes;
  for (std::size_t i = 0; i < cubes_of_misses; ++i) eyes.push_back(missed[i * missed.size() / cubes_of_misses]);
  constexpr std::size_t at_a_time = turn / 2;
  for (std::size_t i = 0; i < eyes.size() && spent_ < max_cost && has_time() && may_view(); i += at_a_time) {
    const std::size_t left = (views_->most - views_->poses.taken()) / 2;
    cost_of_round_ = 0.0;
    take(views_->poses.cubes_at(std::span(eyes).subspan(i, std::min({at_a_time, eyes.size() - i, left}))));
    spent_ += static_cast<std::uint64_t>(cost_of_round_);
  }
}

void cell_search::look_around() {
  while (has_time() && may_view()) view();
}

void cell_search::look_for(const search_goal& goal) {
  bool any = false;
  std::uint64_t before = cast_;
  while (spent_ < goal.max_cost && has_time() && may_view() &&
         !(goal.enough && goal.enough(missing_, cost_of_views()))) {
    view();
    before = cast_;
    look_beside(goal.max_cost);
    any = true;
  }
  if (!any) {
    look_beside(goal.max_cost);
    ++searches_by_rays_;
  }
  const double most = goal.cost_of_batch ? share_of_batch * goal.cost_of_batch(missing_[missing_.size() / 2]) : 0.0;
  while (static_cast<double>(cast_ - before) < most && spent_ < goal.max_cost && !is_over() && !dilation_.done()) {
    ++searches_by_rays_;
    look_beside(goal.max_cost);
  }
}

}  // namespace sightcell::bake
