#include "sampler/cell_sampling.h"

#include <algorithm>

#include "sampler/face_sampler.h"

namespace sightcell::bake {
namespace {

// Renders up to samples hemicubes on one face; returns how many were rendered.
std::uint32_t sample_face(const sampling_plan& plan, const boundary_face& face, std::uint32_t samples,
                          std::uint64_t face_number, const std::function<bool(const glm::vec3&)>& is_free,
                          hemicube_source& source, cell_set& set) {
  if (samples == 0) return 0;
  const auto places = make_face_sampler(plan.sampler, face.size, samples,
                                        random_stream(plan.seed, plan.place, purpose::boundary, 0, face_number));
  hemicube_view view;
  std::uint32_t rendered = 0;
  while (rendered < samples) {
    const auto place = places->next();
    if (!place) break;
    const pose where = face.at(*place);
    if (!is_free(where.eye)) {
      places->rejected(*place);
      continue;
    }
    source.render(where, view);
    set.add_view(where.eye, view.seen);
    places->rendered(*place, view);
    ++rendered;
  }
  return rendered;
}

std::uint32_t sample_cube(const glm::vec3& eye, hemicube_source& source, cell_set& set) {
  hemicube_view view;
  for (const float side : {1.0f, -1.0f}) {
    const pose where{eye, {0.0f, 0.0f, -side}, {side, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}};
    source.render(where, view);
    set.add_view(eye, view.seen);
  }
  return 2;
}

}  // namespace

std::uint32_t sample_cell(const sampling_plan& plan, const box& grown, std::span<const glm::vec3> interior,
                          const std::function<bool(const glm::vec3&)>& is_free, hemicube_source& source,
                          cell_set& set) {
  std::uint32_t rendered = 0;
  const auto cubes = std::min<std::size_t>(interior_cubes(plan), interior.size());
  for (std::size_t i = 0; i < cubes; ++i) rendered += sample_cube(interior[i], source, set);

  // Every face gets an equal share of what is left; what a face in a wall cannot use goes to those after it.
  std::uint32_t left = plan.samples - std::min(plan.samples, rendered);
  const auto faces = faces_of(grown.min, grown.max);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto share = left / static_cast<std::uint32_t>(faces.size() - i);
    const std::uint32_t used = sample_face(plan, faces[i], share, i, is_free, source, set);
    left -= used;
    rendered += used;
  }
  return rendered;
}

}  // namespace sightcell::bake
