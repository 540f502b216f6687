#include "search/hemicubes.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <vector>

namespace sightcell::bake {
namespace {

// Interior hemicubes per call: enough for the threads of one cell, and their views take only some megabytes.
constexpr std::size_t interior_batch = 32;

}  // namespace

std::uint32_t interior_cubes(const hemicube_plan& plan) {
  return plan.geometry_inside ? static_cast<std::uint32_t>(plan.samples * plan.interior_share / 2.0) : 0;
}

pose jittered(const pose& where, std::uint32_t resolution, random_stream random) {
  const float pixel = 2.0f / static_cast<float>(resolution);
  const float aside = (random.uniform() - 0.5f) * pixel, above = (random.uniform() - 0.5f) * pixel;
  pose turned = where;
  turned.forward = glm::normalize(where.forward + where.right * aside + where.up * above);
  turned.right = glm::normalize(glm::cross(turned.forward, where.up));
  turned.up = glm::cross(turned.right, turned.forward);
  return turned;
}

hemicubes::hemicubes(const hemicube_plan& plan, hemicube_source& source, cell_set& set)
    : plan_(plan), source_(source), set_(set) {}

void hemicubes::take(std::span<const pose> poses, std::span<hemicube_view> views, const importance_weight& weigh) {
  turned_.assign(poses.begin(), poses.end());
  if (plan_.jitter)
    for (std::size_t i = 0; i < turned_.size(); ++i)
      turned_[i] = jittered(turned_[i], source_.resolution(),
                            random_stream(plan_.seed, plan_.place, purpose::jitter, 0, taken_ + i));
  source_.render(turned_, views);
  if (weigh)
    for (std::size_t i = 0; i < views.size(); ++i) {
      const double weight = weigh(turned_[i], views[i]);
      for (double& part : views[i].importance) part *= weight;
    }
  for (std::size_t i = 0; i < views.size(); ++i) set_.add_view(poses[i].eye, views[i].seen);
  taken_ += static_cast<std::uint32_t>(poses.size());
}

void add_cube(const glm::vec3& eye, std::vector<pose>& poses) {
  for (const float side : {1.0f, -1.0f})
    poses.push_back({eye, {0.0f, 0.0f, -side}, {side, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}});
}

void hemicubes::take_interior(std::span<const glm::vec3> points) {
  std::vector<pose> poses;
  for (const glm::vec3& eye : points.first(std::min<std::size_t>(interior_cubes(plan_), points.size())))
    add_cube(eye, poses);
  std::vector<hemicube_view> views(std::min(poses.size(), interior_batch));
  // Leaves time for the faces.
  const time_limit of_cubes = plan_.limit ? plan_.limit->part(plan_.interior_share) : time_limit(0.0, true);
  for (std::size_t first = 0; first < poses.size();) {
    const std::size_t count = std::min({interior_batch, poses.size() - first, std::size_t{left()}});
    if (count == 0 || of_cubes.reached()) return;
    take(std::span(poses).subspan(first, count), std::span(views).first(count));
    first += count;
  }
}

}  // namespace sightcell::bake
