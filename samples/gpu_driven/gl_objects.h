#pragma once
// Owners of OpenGL objects. The context must be current where they are made and destroyed.
#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sightcell/base/error.h"

namespace gpu_driven {

class gl_buffer {
 public:
  gl_buffer() = default;
  // flags: of glNamedBufferStorage. data: null for bytes that are all 0.
  gl_buffer(std::size_t bytes, const void* data, GLbitfield flags = 0) : bytes_(bytes == 0 ? 4 : bytes) {
    glCreateBuffers(1, &id_);
    glNamedBufferStorage(id_, static_cast<GLsizeiptr>(bytes_), bytes == 0 ? nullptr : data, flags);
    if (data == nullptr) clear();
  }
  template <class T>
  explicit gl_buffer(const std::vector<T>& from) : gl_buffer(from.size() * sizeof(T), from.data()) {}
  ~gl_buffer() { glDeleteBuffers(1, &id_); }
  gl_buffer(gl_buffer&& other) noexcept : id_(std::exchange(other.id_, 0)), bytes_(other.bytes_) {}
  gl_buffer& operator=(gl_buffer&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }

  // On the device: all bytes are 0.
  void clear() const { glClearNamedBufferData(id_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr); }

  // The buffer needs GL_DYNAMIC_STORAGE_BIT.
  template <class T>
  void write(std::span<const T> data) const {
    glNamedBufferSubData(id_, 0, static_cast<GLsizeiptr>(data.size_bytes()), data.data());
  }

  void bind(GLenum target, GLuint index) const { glBindBufferBase(target, index, id_); }
  void bind_storage(GLuint index) const { bind(GL_SHADER_STORAGE_BUFFER, index); }
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
  std::size_t bytes_ = 0;
};

class gl_texture {
 public:
  gl_texture() = default;
  // For texelFetch: no filter.
  gl_texture(GLenum format, GLsizei width, GLsizei height, GLsizei levels = 1) {
    glCreateTextures(GL_TEXTURE_2D, 1, &id_);
    glTextureStorage2D(id_, levels, format, width, height);
    glTextureParameteri(id_, GL_TEXTURE_MIN_FILTER, levels > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
    glTextureParameteri(id_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  }
  static gl_texture adopt(GLuint id) {
    gl_texture out;
    out.id_ = id;
    return out;
  }
  ~gl_texture() { glDeleteTextures(1, &id_); }
  gl_texture(gl_texture&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  gl_texture& operator=(gl_texture&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

class gl_framebuffer {
 public:
  // colors: textures of the outputs 0, 1, ...
  gl_framebuffer(std::span<const GLuint> colors, GLuint depth) {
    glCreateFramebuffers(1, &id_);
    std::vector<GLenum> outputs;
    for (const GLuint color : colors) {
      outputs.push_back(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + outputs.size()));
      glNamedFramebufferTexture(id_, outputs.back(), color, 0);
    }
    if (depth != 0) glNamedFramebufferTexture(id_, GL_DEPTH_ATTACHMENT, depth, 0);
    glNamedFramebufferDrawBuffers(id_, static_cast<GLsizei>(outputs.size()), outputs.data());
    if (glCheckNamedFramebufferStatus(id_, GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return;
    glDeleteFramebuffers(1, &id_);
    throw sightcell::error(sightcell::error_kind::failed, "gpu-driven.limit", "OpenGL",
                           "the device cannot draw into pictures of this kind and size",
                           "name a smaller --width and --height");
  }
  ~gl_framebuffer() { glDeleteFramebuffers(1, &id_); }
  gl_framebuffer(const gl_framebuffer&) = delete;
  gl_framebuffer& operator=(const gl_framebuffer&) = delete;
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

}  // namespace gpu_driven
