#pragma once
// Owners of OpenGL objects. Made and destroyed with the context current.
#include <epoxy/gl.h>

#include <cstddef>

namespace sightcell::bake {

class gl_buffer {
 public:
  // data may be null: then the content is undefined. flags as in glNamedBufferStorage.
  gl_buffer(std::size_t bytes, const void* data, GLbitfield flags = 0) {
    glCreateBuffers(1, &id_);
    // OpenGL has no empty buffers.
    glNamedBufferStorage(id_, static_cast<GLsizeiptr>(bytes == 0 ? 4 : bytes), bytes == 0 ? nullptr : data, flags);
  }
  ~gl_buffer() { glDeleteBuffers(1, &id_); }
  gl_buffer(const gl_buffer&) = delete;
  gl_buffer& operator=(const gl_buffer&) = delete;
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

// One level, sampled with texelFetch only.
class gl_image {
 public:
  gl_image(GLenum format, GLsizei width, GLsizei height) {
    glCreateTextures(GL_TEXTURE_2D, 1, &id_);
    glTextureStorage2D(id_, 1, format, width, height);
    // Integer textures are incomplete with any other filter.
    glTextureParameteri(id_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(id_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  }
  ~gl_image() { glDeleteTextures(1, &id_); }
  gl_image(const gl_image&) = delete;
  gl_image& operator=(const gl_image&) = delete;
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

}  // namespace sightcell::bake
