#include "hemicube/gpu/gpu_culling.h"

#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

namespace sightcell::bake {
namespace {

class frustum_culling final : public gpu_culling {
 public:
  frustum_culling(const gpu_geometry& geometry, bool frustum) : geometry_(geometry), frustum_(frustum) {
    index_counts_.reserve(geometry.clusters().size() * face_count);
    index_offsets_.reserve(geometry.clusters().size() * face_count);
  }

  void start(const glm::vec3& eye, std::span<const face_view, face_count> faces) override {
    index_counts_.clear();
    index_offsets_.clear();
    for (std::uint32_t f = 0; f < face_count; ++f) {
      for (std::uint32_t c = 0; c < polygon_class_count; ++c) {
        gpu_geometry::index_range& range = draws_[f][c];
        range.first = static_cast<std::uint32_t>(index_counts_.size());
        cull_class(eye, faces[f], static_cast<polygon_class>(c));
        range.count = static_cast<std::uint32_t>(index_counts_.size()) - range.first;
      }
    }
  }

  bool start_second() override { return false; }
  void finish_second() override {}

  void draw(std::uint32_t face, polygon_class which) const override {
    const gpu_geometry::index_range& range = draws_[face][which];
    if (range.count == 0) return;
    geometry_.bind_vertices(which);
    glMultiDrawElements(GL_TRIANGLES, &index_counts_[range.first], GL_UNSIGNED_INT, &index_offsets_[range.first],
                        static_cast<GLsizei>(range.count));
  }

 private:
  // The same formula as in_frustum in shaders/hemicube/cull.glsl.
  void cull_class(const glm::vec3& eye, const face_view& face, polygon_class which) {
    // Planes through the eye; their normals point inside.
    const std::array<glm::vec3, 5> planes{face.right - face.min_x * face.forward,
                                          face.max_x * face.forward - face.right, face.up - face.min_y * face.forward,
                                          face.max_y * face.forward - face.up, face.forward};
    const gpu_geometry::index_range clusters = geometry_.clusters_of(which);
    std::uint32_t end_of_last = 0xFFFFFFFFu;  // device number of the polygon after the last draw of this list
    for (const gpu_geometry::cluster& c : geometry_.clusters().subspan(clusters.first, clusters.count)) {
      const glm::vec3 from_eye = c.center - eye;
      bool outside = false;
      for (const glm::vec3& plane : planes) {
        const glm::vec3 size = glm::abs(plane);
        // Slightly more than the box, because of rounding here and in the vertex shader.
        const float reach = glm::dot(size, c.extent + 1e-5f * (glm::abs(from_eye) + glm::abs(eye)));
        outside = outside || glm::dot(plane, from_eye) + reach < 0.0f;
      }
      if (outside && frustum_) continue;
      if (end_of_last == c.first_polygon) {
        index_counts_.back() += static_cast<GLsizei>(3 * c.polygon_count);
      } else {
        index_counts_.push_back(static_cast<GLsizei>(3 * c.polygon_count));
        index_offsets_.push_back(
            reinterpret_cast<const void*>(std::size_t{c.first_polygon} * 3 * sizeof(std::uint32_t)));
      }
      end_of_last = c.first_polygon + c.polygon_count;
    }
  }

  const gpu_geometry& geometry_;
  bool frustum_;
  // Draws of all faces and classes, as arguments of glMultiDrawElements, and the part of each face and class.
  std::vector<GLsizei> index_counts_;
  std::vector<const void*> index_offsets_;
  std::array<std::array<gpu_geometry::index_range, polygon_class_count>, face_count> draws_;
};

}  // namespace

std::unique_ptr<gpu_culling> make_frustum_culling(const gpu_geometry& geometry, bool frustum) {
  return std::make_unique<frustum_culling>(geometry, frustum);
}

}  // namespace sightcell::bake
