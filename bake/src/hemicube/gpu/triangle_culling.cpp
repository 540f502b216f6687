#include "hemicube/gpu/triangle_culling.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hemicube/hemicube_faces.h"
#include "shaders/sources.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t list_count = std::size_t{face_count} * polygon_class_count;
constexpr std::size_t header_bytes = 4 * sizeof(std::uint32_t);
constexpr std::size_t bytes_of_lists = header_bytes + list_count * sizeof(shaders::hemicube_list);

std::size_t most_clusters(const gpu_geometry& geometry) {
  return face_count * geometry.clusters().size();
}

std::size_t list_at(std::uint32_t face, polygon_class which) {
  return header_bytes + (face * polygon_class_count + which) * sizeof(shaders::hemicube_list);
}

// Returns for how many triangles of a pass there is to be room.
std::uint32_t room_for(const gpu_geometry& geometry, std::uint32_t most_triangles) {
  GLint64 limit = 0;  // at least 128 MiB
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  const auto bytes = static_cast<std::uint64_t>(limit);
  if (geometry.vertex_bytes() > bytes || geometry.index_bytes() > bytes) return 0;
  const std::uint64_t most = std::uint64_t{geometry.drawn_polygons()} * face_count;
  return static_cast<std::uint32_t>(std::min({most, std::uint64_t{most_triangles}, bytes / 12}));
}

}  // namespace

triangle_culling::triangle_culling(const gpu_geometry& geometry, std::uint32_t most_triangles)
    : geometry_(geometry),
      room_(room_for(geometry, most_triangles)),
      may_overflow_(std::uint64_t{geometry.drawn_polygons()} * face_count > room_),
      // Lists of classes without clusters are written by no shader.
      lists_(bytes_of_lists, std::vector<std::byte>(bytes_of_lists).data()),
      kept_(most_clusters(geometry) * sizeof(shaders::hemicube_kept), nullptr),
      triangle_sums_(4 * (most_clusters(geometry) / shaders::hemicube_sum_size + 1), nullptr),
      kept_indices_(std::size_t{room_} * 12, nullptr),
      number_("hemicube/number_clusters", {{GL_COMPUTE_SHADER, shaders::hemicube_number_clusters_comp}}),
      first_("hemicube/triangles_first", {{GL_COMPUTE_SHADER, shaders::hemicube_triangles_first_comp}}),
      second_("hemicube/triangles_second", {{GL_COMPUTE_SHADER, shaders::hemicube_triangles_second_comp}}),
      pack_("hemicube/pack_triangles", {{GL_COMPUTE_SHADER, shaders::hemicube_pack_triangles_comp}}),
      whole_("hemicube/whole_lists", {{GL_COMPUTE_SHADER, shaders::hemicube_whole_lists_comp}}),
      vertex_array_(geometry.make_vertex_array(opaque_single_sided, kept_indices_.id())),
      masked_array_(geometry.make_vertex_array(masked_single_sided, kept_indices_.id())) {}

triangle_culling::~triangle_culling() {
  glDeleteVertexArrays(1, &vertex_array_);
  glDeleteVertexArrays(1, &masked_array_);
}

void triangle_culling::run(GLuint packed_commands, bool second) const {
  if (room_ == 0) return glMemoryBarrier(GL_COMMAND_BARRIER_BIT);
  const auto bind = [](std::uint32_t where, GLuint buffer) {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, where, buffer);
  };
  bind(shaders::hemicube_buffer_packed, packed_commands);
  bind(shaders::hemicube_buffer_lists, lists_.id());
  bind(shaders::hemicube_buffer_triangle_sums, triangle_sums_.id());
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  glUseProgram(number_.id());
  glDispatchCompute(1, 1, 1);

  bind(shaders::hemicube_buffer_vertices, geometry_.vertices());
  bind(shaders::hemicube_buffer_indices, geometry_.indices());
  bind(shaders::hemicube_buffer_kept, kept_.id());
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, lists_.id());
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
  glUseProgram((second ? second_ : first_).id());
  glDispatchComputeIndirect(0);

  bind(shaders::hemicube_buffer_kept_indices, kept_indices_.id());
  // The draws of the last pass have to be done with the indices before they are overwritten.
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT);
  glUseProgram(pack_.id());
  glDispatchComputeIndirect(0);
  if (may_overflow_) {
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glUseProgram(whole_.id());
    glDispatchCompute(1, 1, 1);
  }
  glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT);
}

void triangle_culling::draw(std::uint32_t face, polygon_class which, GLuint packed_commands, std::size_t first_command,
                            std::uint32_t most_clusters) const {
  const std::size_t list = list_at(face, which);
  if (room_ > 0) {
    glBindVertexArray(is_masked(which) ? masked_array_ : vertex_array_);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, lists_.id());
    glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                           reinterpret_cast<const void*>(list + offsetof(shaders::hemicube_list, index_count)));
  }
  if (!may_overflow_) return;
  const std::size_t number =
      room_ > 0 ? offsetof(shaders::hemicube_list, whole_clusters) : offsetof(shaders::hemicube_list, clusters);
  geometry_.bind_vertices(which);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, packed_commands);
  glBindBuffer(GL_PARAMETER_BUFFER_ARB, lists_.id());
  glMultiDrawElementsIndirectCountARB(
      GL_TRIANGLES, GL_UNSIGNED_INT,
      reinterpret_cast<const void*>(first_command * shaders::hemicube_command_words * sizeof(std::uint32_t)),
      static_cast<GLintptr>(list + number), static_cast<GLsizei>(most_clusters), 0);
}

}  // namespace sightcell::bake
