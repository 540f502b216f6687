#include "sightcell/picture/textures.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>

namespace sightcell::picture {
namespace {

GLuint make_texture(GLsizei width, GLsizei height, const unsigned char* rgba) {
  GLuint id = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &id);
  const auto levels = static_cast<GLsizei>(std::bit_width(static_cast<unsigned>(std::max(width, height))));
  glTextureStorage2D(id, levels, GL_SRGB8_ALPHA8, width, height);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTextureSubImage2D(id, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
  glGenerateTextureMipmap(id);
  glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return id;  // repeats, the default of OpenGL and glTF
}

// Returns 0 if the image cannot be decoded or is larger than the device's textures.
GLuint decode_and_upload(const scene::image& image) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  const auto pixels = scene::decode(image, static_cast<std::uint32_t>(limit));
  if (!pixels) return 0;
  return make_texture(static_cast<GLsizei>(pixels->width), static_cast<GLsizei>(pixels->height), pixels->rgba.data());
}

GLint wrap_mode(scene::wrap mode) {
  return mode == scene::wrap::clamp ? GL_CLAMP_TO_EDGE : mode == scene::wrap::mirror ? GL_MIRRORED_REPEAT : GL_REPEAT;
}

bool repeats(const scene::material& m) {
  return m.wrap_u == scene::wrap::repeat && m.wrap_v == scene::wrap::repeat;
}

// Returns a view of a texture with other wrap modes.
GLuint make_wrapped(GLuint texture, scene::wrap wrap_u, scene::wrap wrap_v) {
  GLint levels = 0;
  glGetTextureParameteriv(texture, GL_TEXTURE_IMMUTABLE_LEVELS, &levels);
  GLuint view = 0;
  glGenTextures(1, &view);
  glTextureView(view, GL_TEXTURE_2D, texture, GL_SRGB8_ALPHA8, 0, static_cast<GLuint>(levels), 0, 1);
  glTextureParameteri(view, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(view, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(view, GL_TEXTURE_WRAP_S, wrap_mode(wrap_u));
  glTextureParameteri(view, GL_TEXTURE_WRAP_T, wrap_mode(wrap_v));
  return view;
}

}  // namespace

texture_set::texture_set(const scene::scene& s) : textures_(s.images.size(), 0) {
  const unsigned char white[4] = {255, 255, 255, 255};
  white_ = make_texture(1, 1, white);
  std::vector<bool> tried(s.images.size(), false);
  for (const scene::material& m : s.materials) {
    const std::uint32_t image = m.base_color_image;
    if (image >= s.images.size()) continue;
    if (!tried[image]) textures_[image] = decode_and_upload(s.images[image]);
    tried[image] = true;
    if (textures_[image] == 0 || repeats(m)) continue;
    unsigned& wrapped = wrapped_[{image, m.wrap_u, m.wrap_v}];
    if (wrapped == 0) wrapped = make_wrapped(textures_[image], m.wrap_u, m.wrap_v);
  }
}

texture_set::~texture_set() {
  for (const auto& [what, view] : wrapped_) glDeleteTextures(1, &view);
  glDeleteTextures(1, &white_);
  glDeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());  // zeros are ignored
}

unsigned texture_set::of_material(const scene::material& m) const {
  if (m.base_color_image >= textures_.size() || textures_[m.base_color_image] == 0) return white_;
  const auto wrapped = wrapped_.find({m.base_color_image, m.wrap_u, m.wrap_v});
  return wrapped != wrapped_.end() ? wrapped->second : textures_[m.base_color_image];
}

}  // namespace sightcell::picture
