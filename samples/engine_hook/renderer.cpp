#include "renderer.h"

#include <cstddef>

#include "shader_text.h"

namespace engine_hook {
namespace {

// Uniform locations, as in shader_text.h.
enum : GLint { at_eye, at_clip_x, at_clip_y, at_clip_w, at_alpha, at_double_sided, at_show_backs };

enum : GLuint { of_vertices, of_uvs, of_instances };  // vertex buffer bindings

const void* byte_offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);  // as OpenGL wants it
}

void set_clip(GLuint program, GLint location, const glm::vec3& v) {
  glProgramUniform3f(program, location, v.x, v.y, v.z);
}

GLuint make_vertex_array() {
  GLuint array = 0;
  glCreateVertexArrays(1, &array);
  const auto floats = [&](GLuint attribute, GLint components, std::size_t offset, GLuint binding) {
    glEnableVertexArrayAttrib(array, attribute);
    glVertexArrayAttribFormat(array, attribute, components, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
    glVertexArrayAttribBinding(array, attribute, binding);
  };
  floats(0, 3, 0, of_vertices);
  floats(1, 2, 0, of_uvs);
  for (GLuint row = 0; row < 3; ++row) floats(2 + row, 4, offsetof(instance_data, to_world) + 16 * row, of_instances);
  glEnableVertexArrayAttrib(array, 5);
  glVertexArrayAttribIFormat(array, 5, 2, GL_UNSIGNED_INT, offsetof(instance_data, mirrored));
  glVertexArrayAttribBinding(array, 5, of_instances);
  glVertexArrayBindingDivisor(array, of_instances, 1);
  return array;
}

}  // namespace

renderer::renderer(std::uint32_t size)
    : program_("engine_hook", {{GL_VERTEX_SHADER, vertex_text}, {GL_FRAGMENT_SHADER, fragment_text}}),
      size_(static_cast<GLsizei>(size)),
      array_(make_vertex_array()) {
  glCreateRenderbuffers(3, images_);
  const GLenum formats[3] = {GL_R32UI, GL_R32F, GL_DEPTH_COMPONENT32F};
  const GLenum places[3] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_DEPTH_ATTACHMENT};
  glCreateFramebuffers(1, &framebuffer_);
  for (int i = 0; i < 3; ++i) {
    glNamedRenderbufferStorage(images_[i], formats[i], size_, size_);
    glNamedFramebufferRenderbuffer(framebuffer_, places[i], GL_RENDERBUFFER, images_[i]);
  }
  glNamedFramebufferDrawBuffers(framebuffer_, 2, places);
}

renderer::~renderer() {
  glDeleteVertexArrays(1, &array_);
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteRenderbuffers(3, images_);
}

void renderer::begin(const engine_scene& engine, const camera& view) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, size_, size_);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);  // reversed depth: larger is nearer; of equal ones the first stays
  glBlendFunc(GL_ONE, GL_ONE);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const GLuint no_surface[4] = {};
  const GLfloat zero[4] = {};
  glClearBufferuiv(GL_COLOR, 0, no_surface);
  glClearBufferfv(GL_COLOR, 1, zero);
  glClearBufferfv(GL_DEPTH, 0, zero);
  const GLuint program = program_.id();
  glUseProgram(program);
  glProgramUniform4f(program, at_eye, view.eye.x, view.eye.y, view.eye.z, near_plane);
  set_clip(program, at_clip_x, view.right);
  set_clip(program, at_clip_y, view.up);
  set_clip(program, at_clip_w, view.forward);
  glBindVertexArray(array_);
  glVertexArrayVertexBuffer(array_, of_instances, engine.instances(), 0, sizeof(instance_data));
}

// Solid polygons write the surface and its depth; then blended ones add a layer each, in whatever order.
void renderer::begin_pass(bool blended) const {
  const GLboolean solid = blended ? GL_FALSE : GL_TRUE, layers = blended ? GL_TRUE : GL_FALSE;
  glDepthMask(solid);
  glColorMaski(0, solid, solid, solid, solid);
  glColorMaski(1, layers, layers, layers, layers);
  (blended ? glEnablei : glDisablei)(GL_BLEND, 1);
}

void renderer::bind(const batch& b) const {
  glVertexArrayVertexBuffer(array_, of_vertices, b.vertices, 0, sizeof(glm::vec3));
  if (b.uvs != 0) glVertexArrayVertexBuffer(array_, of_uvs, b.uvs, 0, sizeof(glm::vec2));
  (b.uvs != 0 ? glEnableVertexArrayAttrib : glDisableVertexArrayAttrib)(array_, 1);
  glBindTextureUnit(0, b.texture);
  glUniform2f(at_alpha, b.alpha, b.alpha_cutoff);
  glUniform1ui(at_double_sided, b.double_sided ? 1 : 0);
}

effort renderer::draw(const engine_scene& engine, const camera& view, const draw_list& list) {
  effort out;
  begin(engine, view);
  for (const bool blended : {false, true}) {
    begin_pass(blended);
    const batch* bound = nullptr;
    for (const draw_call& call : list.calls) {
      const batch& b = engine.batches()[engine.units()[call.unit].batch];
      if (b.blended != blended) continue;
      if (&b != bound) {
        bind(b);
        glVertexArrayElementBuffer(array_, list.indices != 0 ? list.indices : b.indices);
        bound = &b;
      }
      glDrawElementsInstancedBaseInstance(GL_TRIANGLES, static_cast<GLsizei>(call.index_count), GL_UNSIGNED_INT,
                                          byte_offset(sizeof(std::uint32_t) * std::size_t{call.first_index}), 1,
                                          call.unit);
      ++out.calls;
      out.polygons += call.index_count / 3;
    }
  }
  return out;
}

effort renderer::draw(const engine_scene& engine, const camera& view, const command_list& list) {
  effort out{list.polygons, 0};
  begin(engine, view);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, list.buffer);
  for (const bool blended : {false, true}) {
    begin_pass(blended);
    for (const command_run& run : list.runs) {
      const batch& b = engine.batches()[run.batch];
      if (b.blended != blended) continue;
      bind(b);
      glVertexArrayElementBuffer(array_, b.indices);
      glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                                  byte_offset(sizeof(sightcell_command) * std::size_t{run.first}),
                                  static_cast<GLsizei>(run.count), sizeof(sightcell_command));
      ++out.calls;
    }
  }
  return out;
}

void renderer::draw_with_backs(const engine_scene& engine, const camera& view, const draw_list& list) {
  glProgramUniform1ui(program_.id(), at_show_backs, 1);
  draw(engine, view, list);
  glProgramUniform1ui(program_.id(), at_show_backs, 0);
}

picture renderer::read() const {
  const auto pixels = static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_);
  picture out{std::vector<std::uint32_t>(pixels), std::vector<float>(pixels), std::vector<float>(pixels)};
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glNamedFramebufferReadBuffer(framebuffer_, GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, size_, size_, GL_RED_INTEGER, GL_UNSIGNED_INT, out.surfaces.data());
  glReadPixels(0, 0, size_, size_, GL_DEPTH_COMPONENT, GL_FLOAT, out.depths.data());
  glNamedFramebufferReadBuffer(framebuffer_, GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, size_, size_, GL_RED, GL_FLOAT, out.layers.data());
  return out;
}

}  // namespace engine_hook
