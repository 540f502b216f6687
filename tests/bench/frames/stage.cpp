#include "bench/frames/stage.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "bench/frames/shader_text.h"

namespace sightcell::bench {
namespace {

constexpr float near_plane = 0.001f;           // meters; as near as the bake looks
constexpr float half_height = 0.57735026919f;  // tangent of 30 degrees

enum : GLint { at_eye, at_clip_x, at_clip_y, at_clip_w, at_group, at_alpha };  // as in shader_text.h

bool same_place(float a, float b) {
  if (a == b) return true;
  if (a == 0.0f || b == 0.0f) return false;
  const float distance = near_plane / a;
  return std::abs(distance - near_plane / b) <= std::max(2e-4f, 2e-5f * distance);
}

}  // namespace

frame_difference compare(const frame_picture& reference, const frame_picture& other) {
  frame_difference out;
  for (std::size_t i = 0; i < reference.depths.size(); ++i) {
    if (!same_place(reference.depths[i], other.depths[i]) || reference.layers[i] != other.layers[i]) {
      ++out.differing;
    } else if (reference.depths[i] != other.depths[i] || reference.surfaces[i] != other.surfaces[i]) {
      ++out.in_place;
    }
  }
  return out;
}

stage::stage(const baked_world& world, std::uint32_t width, std::uint32_t height)
    : world_(world),
      textures_(world.s),
      solid_("frames", {{GL_VERTEX_SHADER, frame_vertex_text}, {GL_FRAGMENT_SHADER, frame_solid_text}}),
      masked_("frames, masked", {{GL_VERTEX_SHADER, frame_vertex_text}, {GL_FRAGMENT_SHADER, frame_masked_text}}),
      width_(static_cast<GLsizei>(width)),
      height_(static_cast<GLsizei>(height)) {
  glCreateRenderbuffers(3, images_);
  const GLenum formats[3] = {GL_R32UI, GL_R32F, GL_DEPTH_COMPONENT32F};
  const GLenum places[3] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_DEPTH_ATTACHMENT};
  glCreateFramebuffers(1, &framebuffer_);
  for (int i = 0; i < 3; ++i) {
    glNamedRenderbufferStorage(images_[i], formats[i], width_, height_);
    glNamedFramebufferRenderbuffer(framebuffer_, places[i], GL_RENDERBUFFER, images_[i]);
  }
  glNamedFramebufferDrawBuffers(framebuffer_, 2, places);
  upload_vertices();
}

stage::~stage() {
  glDeleteVertexArrays(1, &array_);
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteRenderbuffers(3, images_);
}

void stage::upload_vertices() {
  // Vertices are numbered through the draws, as the flattened ones are.
  std::vector<glm::vec3> uvs(world_.geometry.positions.size(), glm::vec3(0.0f, 0.0f, 1.0f));
  for (const scene::draw& d : world_.s.draws) {
    const scene::geometry& g = world_.s.geometries[d.geometry];
    for (std::size_t i = 0; i < g.positions.size(); ++i) {
      glm::vec3& to = uvs[d.base_vertex + i];
      if (i < g.uvs.size()) to = {g.uvs[i].x, g.uvs[i].y, 1.0f};
      if (i < g.colors.size()) to.z = static_cast<float>(g.colors[i].a) / 255.0f;
    }
  }
  positions_.upload(std::span<const glm::vec3>(world_.geometry.positions));
  uvs_.upload(std::span<const glm::vec3>(uvs));
  glCreateVertexArrays(1, &array_);
  for (const GLuint attribute : {0u, 1u}) {
    glEnableVertexArrayAttrib(array_, attribute);
    glVertexArrayAttribFormat(array_, attribute, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array_, attribute, attribute);
  }
  glVertexArrayVertexBuffer(array_, 0, positions_.id(), 0, sizeof(glm::vec3));
  glVertexArrayVertexBuffer(array_, 1, uvs_.id(), 0, sizeof(glm::vec3));
}

void stage::upload_polygons(std::span<const std::uint32_t> stored, gl_buffer& to) const {
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * stored.size());
  for (const std::uint32_t polygon : stored) {
    const auto corner = world_.stored_corners.begin() + 3 * std::ptrdiff_t{polygon};
    indices.insert(indices.end(), corner, corner + 3);
  }
  to.upload(std::span<const std::uint32_t>(indices));
}

frame_camera stage::camera_at(const path_frame& frame) const {
  const glm::vec3 forward = frame.forward(), up(0.0f, 1.0f, 0.0f), right = glm::cross(forward, up);
  const float half_width = half_height * static_cast<float>(width_) / static_cast<float>(height_);
  frame_camera c{frame.eye, right / half_width, up / half_height, forward, {}};
  c.seen = {frame.eye,
            {glm::normalize(forward + c.clip_x), glm::normalize(forward - c.clip_x), glm::normalize(forward + c.clip_y),
             glm::normalize(forward - c.clip_y), forward}};
  return c;
}

void stage::begin(const frame_camera& camera) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width_, height_);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glFrontFace(GL_CCW);
  glCullFace(GL_BACK);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);  // reversed depth: larger is nearer
  glBlendFunc(GL_ONE, GL_ONE);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const GLuint no_surface[4] = {};
  const GLfloat zero[4] = {};
  glClearBufferuiv(GL_COLOR, 0, no_surface);
  glClearBufferfv(GL_COLOR, 1, zero);
  glClearBufferfv(GL_DEPTH, 0, zero);
  for (const GLuint program : {solid_.id(), masked_.id()}) {
    glProgramUniform4f(program, at_eye, camera.eye.x, camera.eye.y, camera.eye.z, near_plane);
    glProgramUniform3f(program, at_clip_x, camera.clip_x.x, camera.clip_x.y, camera.clip_x.z);
    glProgramUniform3f(program, at_clip_y, camera.clip_y.x, camera.clip_y.y, camera.clip_y.z);
    glProgramUniform3f(program, at_clip_w, camera.clip_w.x, camera.clip_w.y, camera.clip_w.z);
  }
  glBindVertexArray(array_);
}

// Solid polygons write the surface and its depth; blended ones, which come last, add a layer each, in whatever order.
void stage::use_group(std::uint32_t group) {
  const scene::material& m = *world_.groups[group].material;
  const bool blended = m.alpha == scene::alpha_mode::blend;
  const bool tested = m.alpha == scene::alpha_mode::mask && !m.alpha_unknown;
  const GLboolean solid = blended ? GL_FALSE : GL_TRUE, layers = blended ? GL_TRUE : GL_FALSE;
  glDepthMask(solid);
  glColorMaski(0, solid, solid, solid, solid);
  glColorMaski(1, layers, layers, layers, layers);
  (blended ? glEnablei : glDisablei)(GL_BLEND, 1);
  (m.double_sided ? glDisable : glEnable)(GL_CULL_FACE);
  glUseProgram(tested ? masked_.id() : solid_.id());
  glUniform1ui(at_group, group);
  if (!tested) return;
  glUniform2f(at_alpha, m.base_color.a, m.alpha_cutoff);
  glBindTextureUnit(0, textures_.of_material(m));
}

frame_picture stage::read() const {
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  frame_picture out{std::vector<std::uint32_t>(pixels), std::vector<float>(pixels), std::vector<float>(pixels)};
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glNamedFramebufferReadBuffer(framebuffer_, GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, width_, height_, GL_RED_INTEGER, GL_UNSIGNED_INT, out.surfaces.data());
  glReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, out.depths.data());
  glNamedFramebufferReadBuffer(framebuffer_, GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, width_, height_, GL_RED, GL_FLOAT, out.layers.data());
  return out;
}

}  // namespace sightcell::bench
