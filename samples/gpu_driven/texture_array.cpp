#include "texture_array.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <string>

#include "sightcell/base/error.h"
#include "sightcell/scene/image.h"

namespace gpu_driven {
namespace {

namespace scene = sightcell::scene;

constexpr std::uint64_t most_texels = std::uint64_t{1} << 26;  // of all layers: 256 MB

// The power of two that the largest image fits into, or less where there are many images.
std::uint32_t side_of(const scene::scene& s, const std::vector<std::uint32_t>& images) {
  std::uint32_t longest = 1;
  for (const std::uint32_t i : images) {
    const auto size = i < s.images.size() ? scene::size_of(s.images[i].encoded) : std::nullopt;
    if (size) longest = std::max({longest, size->width, size->height});
  }
  std::uint32_t side = std::min(std::bit_ceil(longest), 2048u);
  while (side > 1 && std::uint64_t{side} * side * images.size() > most_texels) side /= 2;
  return side;
}

class framebuffer_name {
 public:
  framebuffer_name() { glCreateFramebuffers(1, &id_); }
  ~framebuffer_name() { glDeleteFramebuffers(1, &id_); }
  framebuffer_name(const framebuffer_name&) = delete;
  framebuffer_name& operator=(const framebuffer_name&) = delete;
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

// Resizes an image into a layer of the array.
void upload_layer(const scene::image_pixels& pixels, const gl_texture& array, GLsizei side, GLint layer) {
  const auto width = static_cast<GLsizei>(pixels.width), height = static_cast<GLsizei>(pixels.height);
  if (width == side && height == side) {
    glTextureSubImage3D(array.id(), 0, 0, 0, layer, side, side, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixels.rgba.data());
    return;
  }
  const gl_texture original(GL_SRGB8_ALPHA8, width, height);
  glTextureSubImage2D(original.id(), 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.rgba.data());
  const framebuffer_name from, to;
  glNamedFramebufferTexture(from.id(), GL_COLOR_ATTACHMENT0, original.id(), 0);
  glNamedFramebufferTextureLayer(to.id(), GL_COLOR_ATTACHMENT0, array.id(), 0, layer);
  glBlitNamedFramebuffer(from.id(), to.id(), 0, 0, width, height, 0, 0, side, side, GL_COLOR_BUFFER_BIT, GL_LINEAR);
}

}  // namespace

gl_texture make_texture_array(const scene::scene& s, const std::vector<std::uint32_t>& images) {
  GLint most_layers = 0, most_side = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_layers);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most_side);
  const auto layers = static_cast<GLsizei>(images.size());
  if (layers > most_layers) {
    throw sightcell::error(sightcell::error_kind::failed, "gpu-driven.limit", "OpenGL",
                           "the device has no room for the " + std::to_string(layers) + " textures of " + s.name,
                           "take a scene with fewer images");
  }
  const std::uint32_t side = side_of(s, images);
  GLuint id = 0;
  glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &id);
  gl_texture array = gl_texture::adopt(id);
  glTextureStorage3D(id, static_cast<GLsizei>(std::bit_width(side)), GL_SRGB8_ALPHA8, static_cast<GLsizei>(side),
                     static_cast<GLsizei>(side), layers);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (GLint layer = 0; layer < layers; ++layer) {
    const std::uint32_t image = images[static_cast<std::size_t>(layer)];
    std::optional<scene::image_pixels> pixels;
    if (image < s.images.size()) pixels = scene::decode(s.images[image], static_cast<std::uint32_t>(most_side));
    if (!pixels) pixels = scene::image_pixels{1, 1, {255, 255, 255, 255}};
    upload_layer(*pixels, array, static_cast<GLsizei>(side), layer);
  }
  glGenerateTextureMipmap(id);
  glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return array;  // repeats; the shader does the other wrap modes
}

}  // namespace gpu_driven
