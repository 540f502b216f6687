#include "finish/cell_search.h"

#include <algorithm>
#include <limits>

#include "finish/aim.h"
#include "seeing/gap_filter.h"
#include "source/hemicube_faces.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t first_round = 24, turn = 6;  // hemicubes
constexpr std::uint32_t views_before_rays = 3 * first_round;
constexpr double worth_step = 0.25;  // the more is known, the smaller is what is missing

// What a hemicube costs, in rays; measured on real scenes it is half of that to three times as much. Fixed, because no
// result may depend on time.
std::uint64_t cost_of(std::uint32_t resolution) {
  return 1000 + std::uint64_t{resolution} * resolution / 130;
}

std::vector<glm::vec3> sorted_places(std::vector<glm::vec3> places) {
  std::sort(places.begin(), places.end(), is_lower);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

}  // namespace

cell_search::cell_search(const ray_scene& rays, const near_polygons& neighbors, search_views* views,
                         const search_settings& how, cell_set& set)
    : rays_(rays),
      views_(views),
      how_(how),
      set_(set),
      places_(sorted_places(set.eyes())),
      beside_(rays, neighbors,
              {.seed = how.seed,
               .place = how.place,
               .smallest_gap = how.smallest_gap,
               .places = &places_,
               .limit = how.limit},
              0, set),
      worth_(std::numeric_limits<double>::infinity()) {}

bool cell_search::may_view() const {
  return views_ && views_->places.taken() < views_->most;
}

// As many as there were before, so that what a round finds says how much was missing.
std::uint32_t cell_search::next_views() const {
  const std::uint32_t before = views_->places.taken();
  return std::min(std::max(before, first_round), views_->most - before);
}

std::uint64_t cell_search::cost_of_views() const {
  return may_view() ? next_views() * cost_of(views_->places.resolution()) : 0;
}

void cell_search::look_beside(std::uint64_t max_cost) {
  const std::uint64_t rays = beside_.run(worth_, max_cost - std::min(max_cost, spent_));
  spent_ += rays;
  cast_ += rays;
}

// Returns how many pixels show what was not known, each weighed by the metric along a line through one of its
// polygon's.
double cell_search::take(const std::vector<pose>& poses) {
  gap_filter without_cracks(views_->source, rays_, set_, how_.smallest_gap);
  std::vector<hemicube_view> views(poses.size());
  without_cracks.render(poses, views);
  const std::function<bool(std::uint32_t)> contains = [this](std::uint32_t polygon) { return set_.contains(polygon); };
  double fresh = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    places_.push_back(poses[i].eye);
    for (const seen_polygon& s : views[i].seen) {
      if (contains(s.id)) continue;
      const sight_line line{poses[i].eye, pixel_direction(poses[i], views_->places.resolution(), s.pixel)};
      fresh += s.pixels * how_.metric->weight(s.id, line, contains);
    }
    set_.add_view(poses[i].eye, views[i].seen);
  }
  return fresh;
}

void cell_search::view() {
  const std::uint32_t before = views_->places.taken(), resolution = views_->places.resolution();
  const std::uint32_t count = next_views();
  double fresh = 0.0;
  std::uint32_t taken = 0;
  while (taken < count && !over()) {
    const std::vector<pose> poses = views_->places.next(std::min(turn, count - taken));
    if (poses.empty()) {
      views_->most = 0;  // no place is free
      break;
    }
    fresh += take(poses);
    taken += static_cast<std::uint32_t>(poses.size());
  }
  spent_ += taken * cost_of(resolution);
  if (before > 0 && taken > 0) missing_ = fresh / (3.0 * resolution * resolution * taken);
}

void cell_search::look_for(const search_goal& goal) {
  worth_ = std::min(worth_, goal.least_worth);
  for (bool views = true; views && spent_ < goal.max_cost && !over();) {
    views = may_view() && !(goal.enough && goal.enough(missing_, cost_of_views()));
    if (views) view();
    // Rays go beside what few hemicubes saw at a good price, and beside what a few more saw at a better one.
    if (!views || !may_view() || views_->places.taken() >= views_before_rays) {
      look_beside(goal.max_cost);
      worth_ *= worth_step;
    }
  }
}

}  // namespace sightcell::bake
