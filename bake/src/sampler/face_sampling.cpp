#include "sampler/face_sampling.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "search/boundary_face.h"

namespace sightcell::bake {
namespace {

// A boundary face during the rounds.
struct face_work {
  boundary_face face;
  std::unique_ptr<face_sampler> places;
  std::optional<glm::vec2> place;  // of its hemicube in this round; none: the face is finished

  // Finds the next position that is a valid viewpoint.
  void advance(const std::function<bool(const glm::vec3&)>& is_valid) {
    while ((place = places->next()) && !is_valid(face.at(*place).eye)) places->rejected(*place);
  }
};

}  // namespace

// Every unfinished face has one hemicube per round, so the shares are equal, and hemicubes that a face in a wall does
// not use are left for the others.
void sample_faces(const face_options& how, const hemicube_plan& plan, const box& grown,
                  const std::function<bool(const glm::vec3&)>& is_valid, hemicubes& cell,
                  const importance_weight& weigh) {
  if (cell.left() == 0) return;
  const auto faces = faces_of(grown.min, grown.max);
  constexpr auto face_total = static_cast<std::uint32_t>(std::tuple_size_v<decltype(faces_of(grown.min, grown.max))>);
  face_options of_face = how;
  of_face.samples = std::max((plan.samples - cell.taken()) / face_total, 1u);
  std::vector<face_work> work(face_total);
  for (std::uint32_t i = 0; i < face_total; ++i)
    work[i] = {faces[i],
               make_face_sampler(of_face, faces[i].size, random_stream(plan.seed, plan.place, purpose::boundary, 0, i)),
               {}};

  std::array<pose, face_total> poses;
  std::array<hemicube_view, face_total> views;
  while (cell.left() > 0 && !work.empty()) {
    // With fewer samples than faces, the first faces have them. Faces are independent, so the order of their searches
    // has no effect.
    std::uint32_t count = std::min(cell.left(), static_cast<std::uint32_t>(work.size()));
    tbb::parallel_for(0u, count, [&](std::uint32_t i) { work[i].advance(is_valid); });
    const auto last = work.begin() + count;
    const auto done = std::remove_if(work.begin(), last, [](const face_work& w) { return !w.place; });
    count -= static_cast<std::uint32_t>(last - done);
    work.erase(done, last);

    for (std::uint32_t i = 0; i < count; ++i) poses[i] = work[i].face.at(*work[i].place);
    cell.take(std::span(poses).first(count), std::span(views).first(count), weigh);
    if (cell.left() > 0)
      tbb::parallel_for(0u, count, [&](std::uint32_t i) { work[i].places->rendered(*work[i].place, views[i]); });
  }
}

}  // namespace sightcell::bake
