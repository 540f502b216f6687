#include "bench/hemicube/plain_draw.h"

#include "hemicube/gpu/gpu_objects.h"
#include "hemicube/hemicube_faces.h"
#include "sightcell/picture/gl_program.h"

namespace sightcell::bench {
namespace {

constexpr const char* vertex_text = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform vec3 eye;
layout(location = 1) uniform vec3 clip_x;
layout(location = 2) uniform vec3 clip_y;
layout(location = 3) uniform vec3 clip_w;
layout(location = 4) uniform float near;
void main() {
  vec3 p = position - eye;
  gl_Position = vec4(dot(p, clip_x), dot(p, clip_y), near, dot(p, clip_w));
}
)";

constexpr const char* fragment_text = R"(#version 450 core
layout(location = 0) out uint id;
void main() { id = uint(gl_PrimitiveID); }
)";

std::vector<std::uint32_t> present_indices(const scene::world_geometry& geometry) {
  std::vector<std::uint32_t> indices;
  for (std::size_t polygon = 0; polygon < geometry.kinds.size(); ++polygon)
    if (!geometry.kinds[polygon].absent)
      for (std::size_t k = 0; k < 3; ++k) indices.push_back(geometry.indices[3 * polygon + k]);
  return indices;
}

}  // namespace

struct plain_draw::objects {
  objects(const scene::world_geometry& geometry, const std::vector<std::uint32_t>& present, GLsizei size)
      : program("plain draw", {{GL_VERTEX_SHADER, vertex_text}, {GL_FRAGMENT_SHADER, fragment_text}}),
        ids(GL_R32UI, 3 * size, size),
        depths(GL_DEPTH_COMPONENT32F, 3 * size, size),
        vertices(geometry.positions.size() * sizeof(glm::vec3), geometry.positions.data()),
        indices(present.size() * sizeof(std::uint32_t), present.data()) {
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, ids.id(), 0);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depths.id(), 0);
    glCreateVertexArrays(1, &array);
    glVertexArrayVertexBuffer(array, 0, vertices.id(), 0, sizeof(glm::vec3));
    glVertexArrayElementBuffer(array, indices.id());
    glEnableVertexArrayAttrib(array, 0);
    glVertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array, 0, 0);
  }
  ~objects() {
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteVertexArrays(1, &array);
  }

  picture::gl_program program;
  bake::gl_image ids, depths;
  bake::gl_buffer vertices, indices;
  GLuint framebuffer = 0, array = 0;
};

plain_draw::plain_draw(const world& w, std::uint32_t resolution) : resolution_(resolution) {
  const auto present = present_indices(w.geometry);
  index_count_ = static_cast<int>(present.size());
  gl_ = std::make_unique<objects>(w.geometry, present, static_cast<GLsizei>(resolution));
}

plain_draw::~plain_draw() = default;

void plain_draw::render(std::span<const bake::pose> poses) {
  glBindFramebuffer(GL_FRAMEBUFFER, gl_->framebuffer);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glDisable(GL_SCISSOR_TEST);
  glUseProgram(gl_->program.id());
  glBindVertexArray(gl_->array);
  const auto set = [](GLint where, const glm::vec3& v) { glUniform3f(where, v.x, v.y, v.z); };
  for (const bake::pose& where : poses) {
    const GLuint background[4] = {scene::no_index, 0, 0, 0};
    const GLfloat farthest = 0.0f;
    glClearBufferuiv(GL_COLOR, 0, background);
    glClearBufferfv(GL_DEPTH, 0, &farthest);
    for (const bake::face_view& face : bake::hemicube_faces(where, resolution_)) {
      const float width = face.max_x - face.min_x, height = face.max_y - face.min_y;
      glViewport(static_cast<GLint>(face.x), static_cast<GLint>(face.y), static_cast<GLsizei>(face.width),
                 static_cast<GLsizei>(face.height));
      set(0, where.eye);
      set(1, (2.0f * face.right - (face.max_x + face.min_x) * face.forward) / width);
      set(2, (2.0f * face.up - (face.max_y + face.min_y) * face.forward) / height);
      set(3, face.forward);
      glUniform1f(4, bake::hemicube_near);
      glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
    }
  }
  glFinish();
}

}  // namespace sightcell::bench
