#include "hemicube/gpu/gather_compute.h"

#include <algorithm>

#include "shaders/sources.h"
#include "shared/hemicube_layout.h"
#include "sightcell/base/process_time.h"

namespace sightcell::bake {

gather_compute::gather_compute(polygon_counts& counted, gpu_timeline* timeline)
    : counted_(counted),
      timeline_(timeline),
      program_("hemicube/gather", {{GL_COMPUTE_SHADER, shaders::hemicube_gather_comp}}) {}

void gather_compute::run(const hemicube_atlas& atlas, std::span<const face_view, face_count>, hemicube_view& view,
                         sample_split* spent) {
  const double start = thread_cpu_seconds();
  send(atlas, 0);
  receive(0, view);
  if (spent != nullptr) spent->gather = thread_cpu_seconds() - start;  // includes the statistics
}

void gather_compute::send(const hemicube_atlas& atlas, std::uint32_t slot) {
  const auto [columns, rows] = gather_compute_groups(atlas.resolution);
  glUseProgram(program_.id());
  glBindTextureUnit(shaders::hemicube_texture_ids, atlas.ids);
  glBindTextureUnit(shaders::hemicube_texture_depth, atlas.depths);
  counted_.bind();
  // Orders this after the see-through pass, which has counted into the same list.
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  glDispatchCompute(columns, rows, 1);
  if (timeline_ != nullptr) timeline_->end("count pixels");
  counted_.list(slot);
  if (timeline_ != nullptr) timeline_->end("list polygons");
  counted_.mark_end(slot);
}

void gather_compute::receive(std::uint32_t slot, hemicube_view& view) {
  std::array<float, 4> sums{};
  counted_.receive(slot, view.seen, sums);
  std::sort(view.seen.begin(), view.seen.end(),
            [](const seen_polygon& a, const seen_polygon& b) { return a.id < b.id; });
  for (std::size_t i = 0; i < sums.size(); ++i) view.importance[i] = static_cast<double>(sums[i]);
}

std::array<std::uint32_t, 2> gather_compute_groups(std::uint32_t resolution) {
  return {(3 * resolution + shaders::hemicube_group_width - 1) / shaders::hemicube_group_width,
          (resolution + shaders::hemicube_group_height - 1) / shaders::hemicube_group_height};
}

}  // namespace sightcell::bake
