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
  return id;  // repeats, OpenGL's default and glTF's
}

// 0 when the image cannot be decoded or is larger than the device's textures.
GLuint decode_and_upload(const scene::image& image) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  const auto pixels = scene::decode(image, static_cast<std::uint32_t>(limit));
  if (!pixels) return 0;
  return make_texture(static_cast<GLsizei>(pixels->width), static_cast<GLsizei>(pixels->height), pixels->rgba.data());
}

}  // namespace

texture_set::texture_set(const scene::scene& s) : textures_(s.images.size(), 0) {
  const unsigned char white[4] = {255, 255, 255, 255};
  white_ = make_texture(1, 1, white);
  std::vector<bool> tried(s.images.size(), false);
  for (const scene::material& m : s.materials) {
    const std::uint32_t image = m.base_color_image;
    if (image >= s.images.size() || tried[image]) continue;
    tried[image] = true;
    textures_[image] = decode_and_upload(s.images[image]);
  }
}

texture_set::~texture_set() {
  glDeleteTextures(1, &white_);
  glDeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());  // zeros are ignored
}

unsigned texture_set::of_image(std::uint32_t image) const {
  return image < textures_.size() && textures_[image] != 0 ? textures_[image] : white_;
}

}  // namespace sightcell::picture
