#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "hemicube/gpu/gpu_culling.h"
#include "hemicube/gpu/triangle_culling.h"
#include "shaders/sources.h"
#include "shared/hemicube_layout.h"
#include "sightcell/picture/gl_program.h"

namespace sightcell::bake {
namespace {

static_assert(shaders::hemicube_faces == face_count);
static_assert(shaders::hemicube_classes == polygon_class_count);

constexpr std::size_t command_bytes = shaders::hemicube_command_words * sizeof(std::uint32_t);

shaders::vec4 vector_of(const glm::vec3& v, float w = 0.0f) {
  return {v.x, v.y, v.z, w};
}

GLuint groups_for(std::size_t count, std::uint32_t size) {
  return static_cast<GLuint>((count + size - 1) / size);
}

std::vector<shaders::hemicube_cluster> device_clusters(const gpu_geometry& geometry) {
  std::vector<shaders::hemicube_cluster> all;
  for (const gpu_geometry::cluster& c : geometry.clusters())
    all.push_back({vector_of(c.center), vector_of(c.extent), c.first_polygon, c.polygon_count, 0, 0});
  return all;
}

// Devices round coordinates of corners to steps of a power of two: most to 1/256 pixel, all to at most 1/16. The least
// slack is for rounding in shaders.
float pixel_slack() {
  GLint bits = 4;
  glGetIntegerv(GL_SUBPIXEL_BITS, &bits);
  return std::max(1.0f / 64.0f, std::ldexp(2.0f, -bits));
}

shaders::hemicube_cull_scene scene_block(const gpu_geometry& geometry) {
  shaders::hemicube_cull_scene block{};
  block.cluster_count = static_cast<std::uint32_t>(geometry.clusters().size());
  block.hiding_clusters = geometry.clusters_of(see_through_single_sided).first;
  block.pixel_slack = pixel_slack();
  for (std::uint32_t c = 0; c < polygon_class_count; ++c) {
    const gpu_geometry::index_range range = geometry.clusters_of(static_cast<polygon_class>(c));
    const GLuint groups = groups_for(range.count, shaders::hemicube_cull_size);
    block.classes[c] = {range.first, range.count, block.group_count, groups};
    block.group_count += groups;
  }
  return block;
}

template <class T>
gl_buffer buffer_of(const std::vector<T>& data) {
  return {data.size() * sizeof(T), data.data()};
}

// Level 0 is as large as the atlas, each side rounded up to whole blocks, so that no halving leaves a row out.
class depth_levels {
 public:
  explicit depth_levels(std::uint32_t resolution)
      : columns_(groups_for(3 * resolution, shaders::hemicube_depth_block)),
        rows_(groups_for(resolution, shaders::hemicube_depth_block)),
        image_(GL_R32F, static_cast<GLsizei>(columns_ * shaders::hemicube_depth_block),
               static_cast<GLsizei>(rows_ * shaders::hemicube_depth_block), shaders::hemicube_depth_levels + 1),
        program_("hemicube/depth_levels", {{GL_COMPUTE_SHADER, shaders::hemicube_depth_levels_comp}}) {}

  void build(GLuint depths) const {
    glUseProgram(program_.id());
    glBindTextureUnit(shaders::hemicube_texture_depth, depths);
    for (GLuint level = 0; level <= shaders::hemicube_depth_levels; ++level) {
      glBindImageTexture(shaders::hemicube_image_level + level, image_.id(), static_cast<GLint>(level), GL_FALSE, 0,
                         GL_WRITE_ONLY, GL_R32F);
    }
    glDispatchCompute(columns_, rows_, 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  }
  GLuint id() const { return image_.id(); }

 private:
  GLuint columns_, rows_;
  gl_image image_;
  picture::gl_program program_;
};

class occlusion_culling final : public gpu_culling {
 public:
  occlusion_culling(const gpu_geometry& geometry, const culling_target& target, std::uint32_t most_triangles)
      : target_(target),
        scene_(scene_block(geometry)),
        clusters_(buffer_of(device_clusters(geometry))),
        cluster_of_(buffer_of(geometry.cluster_of_polygons())),
        group_draws_(sizeof(std::uint32_t) * face_count * scene_.group_count, nullptr),
        commands_(command_bytes * face_count * scene_.cluster_count, nullptr),
        packed_commands_(command_bytes * face_count * scene_.cluster_count, nullptr),
        triangles_(geometry, most_triangles),
        last_seen_(buffer_of(std::vector<std::uint32_t>(scene_.cluster_count))),
        view_block_(sizeof(shaders::hemicube_cull), nullptr, GL_DYNAMIC_STORAGE_BIT),
        scene_block_(sizeof scene_, &scene_),
        levels_(target.resolution),
        second_ids_(GL_R32UI, static_cast<GLsizei>(3 * target.resolution), static_cast<GLsizei>(target.resolution)),
        first_("hemicube/cull_first", {{GL_COMPUTE_SHADER, shaders::hemicube_cull_first_comp}}),
        second_("hemicube/cull_second", {{GL_COMPUTE_SHADER, shaders::hemicube_cull_second_comp}}),
        compact_("hemicube/compact", {{GL_COMPUTE_SHADER, shaders::hemicube_compact_comp}}),
        resolve_("hemicube/resolve", {{GL_COMPUTE_SHADER, shaders::hemicube_resolve_comp}}),
        second_framebuffer_(second_ids_.id(), target.depths) {
    glClearTexImage(second_ids_.id(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &shaders::hemicube_background);
  }

  void start(const glm::vec3& eye, std::span<const face_view, face_count> faces) override {
    shaders::hemicube_cull block{};
    block.eye = vector_of(eye, hemicube_near);
    block.number = ++number_;
    for (std::uint32_t f = 0; f < face_count; ++f) {
      const face_view& face = faces[f];
      block.faces[f] = {vector_of(face.forward),
                        vector_of(face.right),
                        vector_of(face.up),
                        {face.min_x, face.max_x, face.min_y, face.max_y},
                        {static_cast<float>(face.x), static_cast<float>(face.y), static_cast<float>(face.width),
                         static_cast<float>(face.height)}};
    }
    glNamedBufferSubData(view_block_.id(), 0, sizeof block, &block);
    cull(first_, false);
  }

  bool start_second() override {
    // Texture fetches need no barrier to see the drawn pixels, because the framebuffer changes before the next draw.
    levels_.build(target_.depths);
    glBindTextureUnit(shaders::hemicube_texture_levels, levels_.id());
    cull(second_, true);
    glBindFramebuffer(GL_FRAMEBUFFER, second_framebuffer_.id());
    return true;
  }

  void finish_second() override {
    glUseProgram(resolve_.id());
    glBindTextureUnit(shaders::hemicube_texture_depth, target_.depths);
    glBindTextureUnit(shaders::hemicube_texture_levels, levels_.id());
    glBindImageTexture(shaders::hemicube_image_ids, target_.ids, 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    glBindImageTexture(shaders::hemicube_image_second_ids, second_ids_.id(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_cluster_of, cluster_of_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_last_seen, last_seen_.id());
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glDispatchCompute(groups_for(3 * target_.resolution, shaders::hemicube_group_width),
                      groups_for(target_.resolution, shaders::hemicube_group_height), 1);
    // For the next use of the ids (a shader, glReadPixels or the draws of the next hemicube), and for the next
    // hierarchical depth, which overwrites this one.
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT |
                    GL_PIXEL_BUFFER_BARRIER_BIT);
    glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer);
  }

  void draw(std::uint32_t face, polygon_class which) const override {
    const auto [first, count, first_group, groups] = scene_.classes[which];
    if (count == 0) return;
    triangles_.draw(face, which, packed_commands_.id(), std::size_t{face} * scene_.cluster_count + first, count);
  }

 private:
  void cull(const picture::gl_program& program, bool second) const {
    glBindBufferBase(GL_UNIFORM_BUFFER, shaders::hemicube_block_cull, view_block_.id());
    glBindBufferBase(GL_UNIFORM_BUFFER, shaders::hemicube_block_cull_scene, scene_block_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_clusters, clusters_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_group_draws, group_draws_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_commands, commands_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_last_seen, last_seen_.id());
    // The commands of the last pass have to be read before they are overwritten.
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    glUseProgram(program.id());
    glDispatchCompute(scene_.group_count, face_count, 1);
    glUseProgram(compact_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_packed, packed_commands_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_lists, triangles_.lists());
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glDispatchCompute(scene_.group_count, face_count, 1);
    triangles_.run(packed_commands_.id(), second);
  }

  culling_target target_;
  std::uint32_t number_ = 0;  // of the last hemicube
  shaders::hemicube_cull_scene scene_;
  gl_buffer clusters_, cluster_of_, group_draws_, commands_, packed_commands_;
  triangle_culling triangles_;
  gl_buffer last_seen_, view_block_, scene_block_;
  depth_levels levels_;
  gl_image second_ids_;
  picture::gl_program first_, second_, compact_, resolve_;
  gl_framebuffer second_framebuffer_;  // ids of the second pass, and the depths of both
};

}  // namespace

std::unique_ptr<gpu_culling> make_occlusion_culling(const gpu_geometry& geometry, const culling_target& target,
                                                    std::uint32_t most_triangles) {
  return std::make_unique<occlusion_culling>(geometry, target, most_triangles);
}

bool can_cull_on_device() {
  return epoxy_has_gl_extension("GL_ARB_indirect_parameters");
}

}  // namespace sightcell::bake
