#include <algorithm>

#include "shaders/sources.h"
#include "shared/hemicube_layout.h"
#include "sightcell/picture/gl_program.h"
#include "source/gpu_gather.h"

namespace sightcell::bake {
namespace {

class gather_compute final : public gpu_gather {
 public:
  explicit gather_compute(polygon_counts& counted)
      : counted_(counted), program_("hemicube/gather", {{GL_COMPUTE_SHADER, shaders::hemicube_gather_comp}}) {}

  void run(const hemicube_atlas& atlas, std::span<const face_view, face_count>, hemicube_view& view) override {
    const auto [columns, rows] = gather_compute_groups(atlas.resolution);
    glUseProgram(program_.id());
    glBindTextureUnit(shaders::hemicube_texture_ids, atlas.ids);
    glBindTextureUnit(shaders::hemicube_texture_depth, atlas.depths);
    // The see-through pass has already counted into the same list.
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glDispatchCompute(columns, rows, 1);
    counted_.collect(view.seen, sums_);

    std::sort(view.seen.begin(), view.seen.end(),
              [](const seen_polygon& a, const seen_polygon& b) { return a.id < b.id; });
    view.importance = {};
    for (std::size_t i = 0; i < sums_.size(); ++i) view.importance[i % 4] += static_cast<double>(sums_[i]);
  }

 private:
  polygon_counts& counted_;
  picture::gl_program program_;
  std::vector<float> sums_;
};

}  // namespace

std::array<std::uint32_t, 2> gather_compute_groups(std::uint32_t resolution) {
  return {(3 * resolution + shaders::hemicube_group_width - 1) / shaders::hemicube_group_width,
          (resolution + shaders::hemicube_group_height - 1) / shaders::hemicube_group_height};
}

std::unique_ptr<gpu_gather> make_gather_compute(polygon_counts& counted) {
  return std::make_unique<gather_compute>(counted);
}

}  // namespace sightcell::bake
