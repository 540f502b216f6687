#include "hemicube/gpu/gpu_gather.h"
#include "hemicube/image_gather.h"
#include "sightcell/base/error.h"
#include "sightcell/base/process_time.h"
#include "sightcell/picture/gl_context.h"

namespace sightcell::bake {
namespace {

class gather_read_back final : public gpu_gather {
 public:
  gather_read_back(std::uint32_t polygon_count, polygon_counts* marked) : marked_(marked), gather_(polygon_count) {}

  void run(const hemicube_atlas& atlas, std::span<const face_view, face_count> faces, hemicube_view& view,
           sample_split* spent) override {
    const double start = thread_cpu_seconds();
    ids_.resize(3 * std::size_t{atlas.resolution} * atlas.resolution);
    depths_.resize(ids_.size());
    read_atlas(atlas, ids_, depths_);
    if (marked_ != nullptr) {
      marked_->collect(marked_list_, no_sums_);
      for (const seen_polygon& p : marked_list_) gather_.add(p.id, p.pixels, p.pixel);
    }
    if (!gather_.list(ids_, view.seen)) {
      picture::gl_context::require_device("hemicube");
      throw error(error_kind::failed, "gl.error", "OpenGL source", "the device drew a polygon that does not exist",
                  "use another source and report this with the name of your graphics driver");
    }
    const double listed = thread_cpu_seconds();
    gather_.sum(faces, depths_, atlas.near_over_far, view.importance);
    if (spent == nullptr) return;
    spent->gather = listed - start;
    spent->statistics = thread_cpu_seconds() - listed;
  }

 private:
  polygon_counts* marked_;
  image_gather gather_;
  std::vector<std::uint32_t> ids_;
  std::vector<float> depths_;  // near / depth
  std::vector<seen_polygon> marked_list_;
  std::vector<float> no_sums_;
};

}  // namespace

void read_atlas(const hemicube_atlas& atlas, std::span<std::uint32_t> ids, std::span<float> depths) {
  const auto width = static_cast<GLsizei>(3 * atlas.resolution), height = static_cast<GLsizei>(atlas.resolution);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, atlas.framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, ids.data());
  glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
}

std::unique_ptr<gpu_gather> make_gather_read_back(std::uint32_t polygon_count, polygon_counts* marked) {
  return std::make_unique<gather_read_back>(polygon_count, marked);
}

}  // namespace sightcell::bake
