#pragma once
// Owners of OpenGL objects. The context must be current where they are made and destroyed.
#include <epoxy/gl.h>

#include <cstddef>

#include "sightcell/base/error.h"

namespace sightcell::bake {

class gl_buffer {
 public:
  // data may be null; then the content is undefined. flags as in glNamedBufferStorage.
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

// A texture that is read with texelFetch only.
class gl_image {
 public:
  gl_image(GLenum format, GLsizei width, GLsizei height, GLsizei levels = 1) {
    glCreateTextures(GL_TEXTURE_2D, 1, &id_);
    glTextureStorage2D(id_, levels, format, width, height);
    // Integer textures are incomplete with any other filter; without mipmaps only level 0 could be fetched.
    glTextureParameteri(id_, GL_TEXTURE_MIN_FILTER, levels > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
    glTextureParameteri(id_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  }
  ~gl_image() { glDeleteTextures(1, &id_); }
  gl_image(const gl_image&) = delete;
  gl_image& operator=(const gl_image&) = delete;
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

// A framebuffer of ids and depths. Throws sightcell::error where the device does not support it.
class gl_framebuffer {
 public:
  gl_framebuffer(GLuint ids, GLuint depths) {
    glCreateFramebuffers(1, &id_);
    glNamedFramebufferTexture(id_, GL_COLOR_ATTACHMENT0, ids, 0);
    glNamedFramebufferTexture(id_, GL_DEPTH_ATTACHMENT, depths, 0);
    if (glCheckNamedFramebufferStatus(id_, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      glDeleteFramebuffers(1, &id_);
      throw error(error_kind::failed, "gl.error", "OpenGL source", "the device cannot draw 32-bit ids and depths",
                  "use another source");
    }
  }
  ~gl_framebuffer() { glDeleteFramebuffers(1, &id_); }
  gl_framebuffer(const gl_framebuffer&) = delete;
  gl_framebuffer& operator=(const gl_framebuffer&) = delete;
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

}  // namespace sightcell::bake
