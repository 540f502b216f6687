#pragma once
// A buffer object on the device.
#include <epoxy/gl.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "sightcell/base/error.h"

namespace engine_hook {

class gl_buffer {
 public:
  gl_buffer() { glCreateBuffers(1, &id_); }
  ~gl_buffer() { glDeleteBuffers(1, &id_); }
  gl_buffer(gl_buffer&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  gl_buffer& operator=(gl_buffer&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  gl_buffer(const gl_buffer&) = delete;
  gl_buffer& operator=(const gl_buffer&) = delete;

  GLuint id() const { return id_; }

  template <class T>
  void upload(std::span<const T> data) {
    glNamedBufferData(id_, static_cast<GLsizeiptr>(data.size_bytes()), data.data(), GL_STATIC_DRAW);
  }

  // Lets write(std::span<T>) fill `count` elements where the device reads them. The old contents are given up, so
  // nobody waits for frames that still draw with them. An engine with a ring of persistently mapped memory does the
  // same with a part of it, and a fence.
  template <class T, class Write>
  void write_mapped(std::size_t count, const Write& write) {
    const auto bytes = static_cast<GLsizeiptr>(count * sizeof(T));
    if (bytes == 0) return;
    for (int attempt = 0; attempt < 3; ++attempt) {
      glNamedBufferData(id_, bytes, nullptr, GL_STREAM_DRAW);
      void* const memory = glMapNamedBufferRange(id_, 0, bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
      if (memory == nullptr) break;
      write(std::span<T>(static_cast<T*>(memory), count));
      if (glUnmapNamedBuffer(id_) == GL_TRUE) return;  // else the driver lost what was written
    }
    throw sightcell::error(sightcell::error_kind::failed, "hook.memory", "a mapped buffer",
                           "the device has no room for " + std::to_string(bytes) + " bytes", "try a smaller scene");
  }

 private:
  GLuint id_ = 0;
};

}  // namespace engine_hook
