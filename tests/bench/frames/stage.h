#pragma once
// The device's side: a world's vertices, lists of its polygons, and the frame that they are drawn into.
#include <epoxy/gl.h>

#include <cstdint>
#include <span>
#include <vector>

#include "bench/frames/baked_world.h"
#include "bench/frames/clusters.h"
#include "bench/frames/path_file.h"
#include "sightcell/picture/gl_program.h"
#include "sightcell/picture/textures.h"

namespace sightcell::bench {

class gl_buffer {
 public:
  gl_buffer() { glCreateBuffers(1, &id_); }
  ~gl_buffer() { glDeleteBuffers(1, &id_); }
  gl_buffer(const gl_buffer&) = delete;
  gl_buffer& operator=(const gl_buffer&) = delete;

  GLuint id() const { return id_; }
  template <class T>
  void upload(std::span<const T> data, GLenum usage = GL_STATIC_DRAW) {
    glNamedBufferData(id_, static_cast<GLsizeiptr>(data.size_bytes()), data.data(), usage);
  }
  // Memory that is written from front to back; nullptr where the device has no room.
  std::uint32_t* map(std::size_t words) {
    const auto bytes = static_cast<GLsizeiptr>(words * sizeof(std::uint32_t));
    glNamedBufferData(id_, bytes, nullptr, GL_STREAM_DRAW);
    return static_cast<std::uint32_t*>(
        glMapNamedBufferRange(id_, 0, bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT));
  }
  void unmap() { glUnmapNamedBuffer(id_); }

 private:
  GLuint id_ = 0;
};

struct frame_camera {
  glm::vec3 eye, clip_x, clip_y, clip_w;
  frustum seen;
};

struct frame_picture {
  std::vector<std::uint32_t> surfaces;  // group + 1 of the nearest solid polygon; 0: none
  std::vector<float> depths;            // of it: near plane / meters along the view's axis; 0: none
  std::vector<float> layers;            // blended polygons in front of it
};

struct frame_difference {
  std::uint64_t differing = 0;  // another place, or other layers before it
  std::uint64_t in_place = 0;   // of surfaces in the same place, another one's
};

// The same polygon has bit for bit the same depth in all pictures. Pixels differ where depths lie farther apart than
// the bake's own rule has surfaces coincide, max(0.2 mm, distance / 50,000), or where layers differ; any other bit that
// is not the same counts as in place: of coinciding surfaces a cell set has to hold only one, and ways draw in orders
// of their own.
frame_difference compare(const frame_picture& reference, const frame_picture& other);

class stage {
 public:
  stage(const baked_world& world, std::uint32_t width, std::uint32_t height);
  ~stage();
  stage(const stage&) = delete;
  stage& operator=(const stage&) = delete;

  // 60 degrees high.
  frame_camera camera_at(const path_frame& frame) const;

  void begin(const frame_camera& camera);
  void use_indices(const gl_buffer& indices) { glVertexArrayElementBuffer(array_, indices.id()); }
  void use_group(std::uint32_t group);
  frame_picture read() const;

  // Three indices of each stored polygon, one after the other.
  void upload_polygons(std::span<const std::uint32_t> stored, gl_buffer& to) const;

 private:
  void upload_vertices();

  const baked_world& world_;
  picture::texture_set textures_;
  picture::gl_program solid_, masked_;
  gl_buffer positions_, uvs_;
  GLsizei width_, height_;
  GLuint images_[3] = {}, framebuffer_ = 0, array_ = 0;
};

}  // namespace sightcell::bench
