#include "bound/bound_rays.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>
#include <vector>

#include "bound/ray_trial.h"
#include "bound/valid_count.h"
#include "trace/direction_code.h"

namespace sightcell::bake {
namespace {

// Chunks are large enough that the rays of one packet, after sorting by direction, are within some degrees.
constexpr std::uint64_t chunk_rays = 65536;
constexpr std::uint64_t fewest_tests = 256, rays_per_test = 256;

struct chunk_result {
  std::uint64_t cast = 0, traced = 0, tested = 0, valid = 0, misses = 0, viewpoints_tested = 0, misses_of_volumes = 0;
  std::vector<missed_polygon> missed;
  std::vector<found_volume> missed_volumes;
};

// Returns rays from viewpoints that are not tested yet.
std::vector<sight_line> draw(const viewpoint_region& where, std::uint64_t count, const error_metric& metric,
                             random_stream& random) {
  std::vector<sight_line> lines(count);
  for (sight_line& line : lines) {
    line.eye = where.draw(random);
    line.direction = metric.direction(random);
  }
  return lines;
}

// Returns the indices of the lines that met something which the set lacks, ascending. Lines are sorted so that those
// with similar directions share packets.
// changed: the lines to trace; empty: all.
// traced: their number is added.
std::vector<std::uint32_t> suspects(const ray_scene& rays, const ray_trial& trial, const viewpoint_region& where,
                                    const std::vector<sight_line>& lines,
                                    const std::function<bool(const sight_line&)>& changed, std::uint64_t& traced) {
  const box& around = where.whole();
  std::vector<std::uint64_t> order;  // code of the line, index: one number sorts faster than a pair
  order.reserve(lines.size());
  for (std::uint32_t i = 0; i < lines.size(); ++i) {
    if (changed && !changed(lines[i])) continue;
    const std::uint32_t code =
        direction_code(lines[i].direction) << 15 | place_code(lines[i].eye, around.min, around.max - around.min);
    order.push_back(std::uint64_t{code} << 32 | i);
  }
  std::sort(order.begin(), order.end());
  const auto line_of = [&](std::size_t i) { return static_cast<std::uint32_t>(order[i]); };
  std::vector<sight_line> sorted(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = lines[line_of(i)];
  traced += order.size();
  std::vector<sight> seen(order.size());
  rays.trace(sorted, seen);
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < order.size(); ++i)
    if (trial.lacks(sorted[i], seen[i])) found.push_back(line_of(i));
  std::sort(found.begin(), found.end());
  return found;
}

chunk_result cast_chunk(const ray_scene& rays, const viewpoint_region& where, const visibility_rules& rules,
                        std::uint64_t count, std::uint64_t tests, random_stream random,
                        const std::function<bool(std::uint32_t)>& contains,
                        const std::function<bool(const sight_line&)>& changed) {
  chunk_result result;
  const std::vector<sight_line> lines = draw(where, count, *rules.metric, random);
  result.cast = count;
  ray_trial trial(rays, rules, contains);
  const std::vector<std::uint32_t> suspect_lines = suspects(rays, trial, where, lines, changed, result.traced);

  std::vector<glm::vec3> viewpoints;
  for (std::size_t i = 0; i < std::min<std::size_t>(tests, lines.size()); ++i) viewpoints.push_back(lines[i].eye);
  result.tested = viewpoints.size();
  for (const std::uint32_t i : suspect_lines) viewpoints.push_back(lines[i].eye);
  result.viewpoints_tested = viewpoints.size();
  std::vector<std::uint8_t> valid(viewpoints.size());
  rays.find_valid(viewpoints, rules.player_radius, valid);
  result.valid = static_cast<std::uint64_t>(
      std::count(valid.begin(), valid.begin() + static_cast<std::ptrdiff_t>(result.tested), std::uint8_t{1}));

  sight seen;
  for (std::size_t k = 0; k < suspect_lines.size(); ++k) {
    if (!valid[result.tested + k]) continue;  // an invalid viewpoint is no trial
    const sight_line& line = lines[suspect_lines[k]];
    rays.trace(line.eye, line.direction, seen);
    if (trial.test(line, seen, random, result.missed)) ++result.misses;
  }
  result.misses_of_volumes = trial.misses_of_volumes();
  result.missed_volumes = trial.missed_volumes();
  return result;
}

}  // namespace

// For boxes with hardly any valid viewpoint: every viewpoint is tested, so every ray is a trial.
void bound_batch::cast_tested(std::uint64_t trials) {
  constexpr std::uint64_t most_parts = 1024;  // each part of each round has a random stream of its own
  verification_stream source = source_;
  source.round = source_.round * most_parts + parts_++;
  const verification_batch part = cast_verification_rays(rays_, where_, rules_, trials, source, contains_, give_up_);
  given_up_ = given_up_ || part.given_up;
  cast_ += part.rays, traced_ += part.rays, tested_ += part.rays, valid_ += part.rays;
  misses_ += part.misses;
  viewpoints_tested_ += part.viewpoints_tested;
  missed_.insert(missed_.end(), part.missed.begin(), part.missed.end());
  misses_of_volumes_ += part.misses_of_volumes;
  missed_volumes_.insert(missed_volumes_.end(), part.missed_volumes.begin(), part.missed_volumes.end());
}

void bound_batch::cast(std::uint64_t trials) {
  if (valid_share_ < fewest_valid) return cast_tested(trials);
  cast_rays(static_cast<std::uint64_t>(std::ceil(static_cast<double>(trials) / valid_share_)));
}

void bound_batch::cast_rays(std::uint64_t count) {
  rays_of_parts_.push_back(count);
  std::vector<chunk_result> chunks((count + chunk_rays - 1) / chunk_rays);
  const std::uint64_t tests = std::max(fewest_tests, count / rays_per_test);
  const std::uint64_t tests_of_chunk = (tests + chunks.size() - 1) / std::max<std::size_t>(chunks.size(), 1);
  std::atomic<bool> given_up{false};
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
    if (give_up_ && (given_up || give_up_())) {
      given_up = true;
      return;
    }
    const std::uint64_t size = std::min(chunk_rays, count - i * chunk_rays);
    chunks[i] = cast_chunk(rays_, where_, rules_, size, tests_of_chunk,
                           random_stream(source_.seed, source_.place, source_.use, source_.round, parts_ + i),
                           contains_, changed_);
  });
  given_up_ = given_up_ || given_up;
  parts_ += chunks.size();
  for (const chunk_result& chunk : chunks) {
    cast_ += chunk.cast;
    traced_ += chunk.traced;
    tested_ += chunk.tested;
    valid_ += chunk.valid;
    misses_ += chunk.misses;
    viewpoints_tested_ += chunk.viewpoints_tested;
    missed_.insert(missed_.end(), chunk.missed.begin(), chunk.missed.end());
    misses_of_volumes_ += chunk.misses_of_volumes;
    missed_volumes_.insert(missed_volumes_.end(), chunk.missed_volumes.begin(), chunk.missed_volumes.end());
  }
}

// Every miss is a trial, too. If nearly all rays miss, there are more misses than the lower limit of trials.
std::uint64_t bound_batch::trials(double risk) const {
  return std::max(valid_at_least(cast_, tested_, valid_, risk), misses_);
}

verification_batch cast_bound_rays(const ray_scene& rays, const viewpoint_region& where, const visibility_rules& rules,
                                   const bound_plan& plan, const verification_stream& source,
                                   const std::function<bool(std::uint32_t)>& contains) {
  bound_batch batch(rays, where, rules, plan.valid_share, source, contains);
  batch.cast(plan.trials);
  const std::uint64_t trials = batch.trials(plan.risk);
  return {.rays = trials,
          .misses = batch.misses(),
          .viewpoints_tested = batch.spent() - trials,
          .missed = batch.missed(),
          .misses_of_volumes = batch.misses_of_volumes(),
          .missed_volumes = batch.missed_volumes()};
}

}  // namespace sightcell::bake
