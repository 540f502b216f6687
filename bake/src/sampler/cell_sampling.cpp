#include "sampler/cell_sampling.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "sampler/face_sampler.h"

namespace sightcell::bake {
namespace {

// Interior hemicubes that are rendered at once: enough for the threads of one cell, and what they see stays in some
// megabytes.
constexpr std::size_t interior_batch = 32;

// A boundary face on its way through the rounds.
struct face_work {
  boundary_face face;
  std::unique_ptr<face_sampler> places;
  std::optional<glm::vec2> place;  // where its hemicube of this round stands; none: the face is done

  // Looks for the next place that is free.
  void advance(const std::function<bool(const glm::vec3&)>& is_free) {
    while ((place = places->next()) && !is_free(face.at(*place).eye)) places->rejected(*place);
  }
};

void sample_interior(std::span<const glm::vec3> eyes, hemicube_source& source, cell_set& set) {
  std::vector<pose> poses;
  for (const glm::vec3& eye : eyes)
    for (const float side : {1.0f, -1.0f})
      poses.push_back({eye, {0.0f, 0.0f, -side}, {side, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}});
  std::vector<hemicube_view> views(std::min(poses.size(), interior_batch));
  for (std::size_t first = 0; first < poses.size(); first += interior_batch) {
    const std::size_t count = std::min(interior_batch, poses.size() - first);
    source.render(std::span(poses).subspan(first, count), std::span(views).first(count));
    for (std::size_t i = 0; i < count; ++i) set.add_view(poses[first + i].eye, views[i].seen);
  }
}

// Rounds: every face that is not done has one hemicube in each, so shares are equal; what a face in a wall does not use
// is left for the others. Returns how many were rendered.
std::uint32_t sample_boundary(const sampling_plan& plan, const box& grown, std::uint32_t samples,
                              const std::function<bool(const glm::vec3&)>& is_free, hemicube_source& source,
                              cell_set& set) {
  if (samples == 0) return 0;
  const auto faces = faces_of(grown.min, grown.max);
  constexpr auto face_total = static_cast<std::uint32_t>(std::tuple_size_v<decltype(faces_of(grown.min, grown.max))>);
  std::vector<face_work> work(face_total);
  for (std::uint32_t i = 0; i < face_total; ++i)
    work[i] = {faces[i],
               make_face_sampler(plan.sampler, faces[i].size, std::max(samples / face_total, 1u),
                                 random_stream(plan.seed, plan.place, purpose::boundary, 0, i)),
               {}};

  std::array<pose, face_total> poses;
  std::array<hemicube_view, face_total> views;
  std::uint32_t left = samples;
  while (left > 0 && !work.empty()) {
    // With fewer samples than faces, the first ones have them. Faces know nothing of each other: who searches when
    // changes nothing.
    std::uint32_t count = std::min(left, static_cast<std::uint32_t>(work.size()));
    tbb::parallel_for(0u, count, [&](std::uint32_t i) { work[i].advance(is_free); });
    const auto last = work.begin() + count;
    const auto done = std::remove_if(work.begin(), last, [](const face_work& w) { return !w.place; });
    count -= static_cast<std::uint32_t>(last - done);
    work.erase(done, last);

    for (std::uint32_t i = 0; i < count; ++i) poses[i] = work[i].face.at(*work[i].place);
    source.render(std::span(poses).first(count), std::span(views).first(count));
    for (std::uint32_t i = 0; i < count; ++i) set.add_view(poses[i].eye, views[i].seen);
    left -= count;
    if (left > 0)
      tbb::parallel_for(0u, count, [&](std::uint32_t i) { work[i].places->rendered(*work[i].place, views[i]); });
  }
  return samples - left;
}

}  // namespace

std::uint32_t sample_cell(const sampling_plan& plan, const box& grown, std::span<const glm::vec3> interior,
                          const std::function<bool(const glm::vec3&)>& is_free, hemicube_source& source,
                          cell_set& set) {
  const auto cubes = std::min<std::size_t>(interior_cubes(plan), interior.size());
  sample_interior(interior.first(cubes), source, set);
  const auto rendered = 2 * static_cast<std::uint32_t>(cubes);
  return rendered + sample_boundary(plan, grown, plan.samples - std::min(plan.samples, rendered), is_free, source, set);
}

}  // namespace sightcell::bake
