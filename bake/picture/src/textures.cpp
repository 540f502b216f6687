#include "textures.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#include <stb_image.h>

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
  if (image.encoded.empty() || image.encoded.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return 0;
  const auto bytes = static_cast<int>(image.encoded.size());
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  int width = 0, height = 0, channels = 0;
  // The size first: a broken header must not make the decoder allocate gigabytes.
  if (stbi_info_from_memory(image.encoded.data(), bytes, &width, &height, &channels) == 0) return 0;
  if (width < 1 || height < 1 || width > limit || height > limit) return 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(image.encoded.data(), bytes, &width, &height, &channels, 4), stbi_image_free);
  return pixels ? make_texture(width, height, pixels.get()) : 0;
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
