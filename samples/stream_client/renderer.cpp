#include "renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>

#include "shader_text.h"
#include "sightcell/picture/gl_program.h"

namespace stream_client {
namespace {

namespace picture = sightcell::picture;
using sightcell::scene::alpha_mode;
using sightcell::scene::wrap;

constexpr float near_plane = 0.001f;      // meters; that of the bake
constexpr float haze_over_scene = 0.35f;  // optical depth across the scene's diagonal
constexpr float thickest_haze = 0.001f;   // limit per meter, so that rooms have no haze

// Uniform locations, as in shader_text.h.
enum : GLint {
  at_eye,
  at_clip_x,
  at_clip_y,
  at_clip_w,
  at_to_world,
  at_uv_u,
  at_uv_v,
  at_base_color,
  at_alpha,
  at_sky
};

// Indices of one geometry on the device.
struct device_piece {
  std::uint32_t page = 0, part = 0, first_index = 0, indices = 0;
};

// One part of a page: a buffer of positions, one of colors, one for each set of coordinates, one of indices.
class device_part {
 public:
  explicit device_part(const page_part& p) {
    glCreateVertexArrays(1, &array_);
    attribute(0, 3, GL_FLOAT, GL_FALSE, make(p.positions), 3 * sizeof(float));
    if (!p.colors.empty()) attribute(2, 4, GL_UNSIGNED_SHORT, GL_TRUE, make(p.colors), 4 * sizeof(std::uint16_t));
    for (const auto& uv : p.uvs) uvs_.push_back(uv.empty() ? 0 : make(uv));
    glVertexArrayAttribFormat(array_, 1, 2, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array_, 1, 1);
    glVertexArrayElementBuffer(array_, make(p.indices));
  }
  ~device_part() {
    glDeleteVertexArrays(1, &array_);
    glDeleteBuffers(static_cast<GLsizei>(buffers_.size()), buffers_.data());
  }
  device_part(const device_part&) = delete;
  device_part& operator=(const device_part&) = delete;

  // Binds it with a set of coordinates; one that it lacks reads as 0.
  void bind(std::uint32_t uv_set) const {
    const bool has = uv_set < uvs_.size() && uvs_[uv_set] != 0;
    if (has) glVertexArrayVertexBuffer(array_, 1, uvs_[uv_set], 0, 2 * sizeof(float));
    (has ? glEnableVertexArrayAttrib : glDisableVertexArrayAttrib)(array_, 1);
    glBindVertexArray(array_);
  }

 private:
  template <class T>
  GLuint make(const std::vector<T>& data) {
    GLuint buffer = 0;
    glCreateBuffers(1, &buffer);
    buffers_.push_back(buffer);
    const std::size_t bytes = data.size() * sizeof(T);
    glNamedBufferStorage(buffer, static_cast<GLsizeiptr>(std::max<std::size_t>(bytes, 1)),
                         bytes == 0 ? nullptr : data.data(), 0);
    return buffer;
  }
  void attribute(GLuint index, GLint components, GLenum type, GLboolean normalized, GLuint buffer, GLsizei stride) {
    glEnableVertexArrayAttrib(array_, index);
    glVertexArrayAttribFormat(array_, index, components, type, normalized, 0);
    glVertexArrayAttribBinding(array_, index, index);
    glVertexArrayVertexBuffer(array_, index, buffer, 0, stride);
  }

  GLuint array_ = 0;
  std::vector<GLuint> buffers_, uvs_;
};

GLuint make_texture(GLsizei width, GLsizei height, const std::uint8_t* rgba) {
  GLuint id = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &id);
  glTextureStorage2D(id, static_cast<GLsizei>(std::bit_width(static_cast<unsigned>(std::max(width, height)))),
                     GL_SRGB8_ALPHA8, width, height);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTextureSubImage2D(id, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
  glGenerateTextureMipmap(id);
  return id;
}

GLuint make_sampler(wrap u, wrap v) {
  const auto mode = [](wrap w) {
    return w == wrap::clamp ? GL_CLAMP_TO_EDGE : w == wrap::mirror ? GL_MIRRORED_REPEAT : GL_REPEAT;
  };
  GLuint id = 0;
  glCreateSamplers(1, &id);
  glSamplerParameteri(id, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glSamplerParameteri(id, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glSamplerParameteri(id, GL_TEXTURE_WRAP_S, mode(u));
  glSamplerParameteri(id, GL_TEXTURE_WRAP_T, mode(v));
  return id;
}

// Color and depth of one size.
struct frame {
  ~frame() {
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteRenderbuffers(2, images);
  }
  void resize(std::uint32_t w, std::uint32_t h) {
    if (w == width && h == height) return;
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteRenderbuffers(2, images);
    width = w;
    height = h;
    glCreateRenderbuffers(2, images);
    glNamedRenderbufferStorage(images[0], GL_SRGB8_ALPHA8, static_cast<GLsizei>(w), static_cast<GLsizei>(h));
    glNamedRenderbufferStorage(images[1], GL_DEPTH_COMPONENT32F, static_cast<GLsizei>(w), static_cast<GLsizei>(h));
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, images[0]);
    glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, images[1]);
  }
  picture::image_rgba read() const {
    picture::image_rgba out{width, height, std::vector<std::uint8_t>(4 * std::size_t{width} * height)};
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height), GL_RGBA, GL_UNSIGNED_BYTE,
                 out.pixels.data());
    // OpenGL's first row is the lowest.
    const auto row = static_cast<std::ptrdiff_t>(4 * std::size_t{width});
    for (std::ptrdiff_t low = 0, high = std::ptrdiff_t{height} - 1; low < high; ++low, --high) {
      const auto begin = out.pixels.begin();
      std::swap_ranges(begin + low * row, begin + (low + 1) * row, begin + high * row);
    }
    for (std::size_t i = 3; i < out.pixels.size(); i += 4) out.pixels[i] = 255;
    return out;
  }
  std::uint32_t width = 0, height = 0;
  GLuint images[2] = {}, framebuffer = 0;
};

bool has_bit(std::span<const std::uint64_t> bits, std::size_t i) {
  return i / 64 < bits.size() && (bits[i / 64] >> (i % 64) & 1) != 0;
}

}  // namespace

struct renderer::state {
  state(const picture::gl_context& c, std::vector<material> m, std::vector<instance> i, std::uint32_t geometry_count,
        float diagonal)
      : haze(diagonal > 0.0f ? std::min(haze_over_scene / diagonal, thickest_haze) : 0.0f),
        context(c),
        materials(std::move(m)),
        instances(std::move(i)),
        pieces(geometry_count) {
    const std::uint8_t pixel[4] = {255, 255, 255, 255};
    white = make_texture(1, 1, pixel);
    // Passes by material, opaque ones first; within a material in the order of the scene.
    for (std::uint32_t k = 0; k < instances.size(); ++k) order.push_back(k);
    const auto rank = [&](std::uint32_t k) {
      const std::uint32_t number = instances[k].material;
      return std::pair(materials[number].alpha, number);
    };
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return rank(a) < rank(b); });
  }
  ~state() {
    glDeleteTextures(1, &white);
    for (const auto& [number, texture] : textures) glDeleteTextures(1, &texture);
    for (const auto& [modes, sampler] : samplers) glDeleteSamplers(1, &sampler);
  }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  void aim(const picture::camera& c) const;
  void use(const material& m);
  void finest_levels(std::span<const std::uint64_t> shown);
  void draw_instance(const instance& i);

  float haze;
  const picture::gl_context& context;
  std::vector<material> materials;
  std::vector<instance> instances;
  std::vector<std::uint32_t> order;                                          // of instances
  std::vector<std::vector<device_piece>> pieces;                             // by geometry
  std::map<std::uint32_t, std::vector<std::unique_ptr<device_part>>> pages;  // by number
  std::map<std::uint32_t, GLuint> textures;                                  // by image
  std::map<std::tuple<wrap, wrap>, GLuint> samplers;
  std::map<std::uint32_t, std::uint32_t> finest;  // by object: the finest level that is shown
  picture::gl_program program{"stream_client/scene",
                              {{GL_VERTEX_SHADER, scene_vert}, {GL_FRAGMENT_SHADER, scene_frag}}};
  GLuint white = 0;
  frame target;
  std::uint64_t polygons = 0;
};

void renderer::state::aim(const picture::camera& c) const {
  const glm::vec3 forward = glm::normalize(c.forward);
  glm::vec3 right = glm::cross(forward, c.up);
  if (!(glm::dot(right, right) > 1e-10f))
    right = glm::cross(forward, std::abs(forward.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1));
  right = glm::normalize(right);
  const glm::vec3 up = glm::cross(right, forward);
  const float half_height = std::tan(0.5f * c.vertical_fov);
  const float aspect = static_cast<float>(target.width) / static_cast<float>(target.height);
  const glm::vec3 x = right / (half_height * aspect), y = up / half_height;
  glUniform4f(at_eye, c.eye.x, c.eye.y, c.eye.z, near_plane);
  glUniform3f(at_clip_x, x.x, x.y, x.z);
  glUniform3f(at_clip_y, y.x, y.y, y.z);
  glUniform3f(at_clip_w, forward.x, forward.y, forward.z);
  glUniform4f(at_sky, picture::sky_color.x, picture::sky_color.y, picture::sky_color.z, haze);
}

void renderer::state::use(const material& m) {
  (m.double_sided ? glDisable : glEnable)(GL_CULL_FACE);
  (m.alpha == alpha_mode::blend ? glEnable : glDisable)(GL_BLEND);
  glDepthMask(m.alpha == alpha_mode::blend ? GL_FALSE : GL_TRUE);
  glUniform4f(at_base_color, m.base_color.x, m.base_color.y, m.base_color.z, m.base_color.w);
  glUniform2f(at_alpha, m.alpha == alpha_mode::mask ? m.alpha_cutoff : 0.0f,
              m.alpha == alpha_mode::blend ? 0.0f : 1.0f);
  const float c = std::cos(m.uv_rotation), s = std::sin(m.uv_rotation);
  glUniform3f(at_uv_u, m.uv_scale.x * c, m.uv_scale.y * s, m.uv_offset.x);
  glUniform3f(at_uv_v, -m.uv_scale.x * s, m.uv_scale.y * c, m.uv_offset.y);
  const auto texture = textures.find(m.image);
  glBindTextureUnit(0, texture == textures.end() ? white : texture->second);
  GLuint& sampler = samplers[{m.wrap_u, m.wrap_v}];
  if (sampler == 0) sampler = make_sampler(m.wrap_u, m.wrap_v);
  glBindSampler(0, sampler);
}

void renderer::state::finest_levels(std::span<const std::uint64_t> shown) {
  finest.clear();
  for (std::size_t k = 0; k < instances.size(); ++k) {
    if (instances[k].object == no_object || !has_bit(shown, k)) continue;
    const auto [entry, added] = finest.emplace(instances[k].object, instances[k].level);
    if (!added) entry->second = std::min(entry->second, instances[k].level);
  }
}

void renderer::state::draw_instance(const instance& i) {
  if (i.object != no_object && finest[i.object] != i.level) return;
  const float* m = i.matrix;
  // Mirrored instances turn the front of their polygons.
  const glm::vec3 x(m[0], m[1], m[2]), y(m[3], m[4], m[5]), z(m[6], m[7], m[8]);
  glFrontFace(glm::dot(glm::cross(x, y), z) < 0.0f ? GL_CW : GL_CCW);
  glUniformMatrix4x3fv(at_to_world, 1, GL_FALSE, m);
  for (const device_piece& piece : pieces[i.geometry]) {
    pages[piece.page][piece.part]->bind(materials[i.material].uv_set);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(piece.indices), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(std::uintptr_t{piece.first_index} * sizeof(std::uint32_t)));
    polygons += piece.indices / 3;
  }
}

renderer::renderer(const picture::gl_context& context, std::vector<material> materials, std::vector<instance> instances,
                   std::uint32_t geometry_count, float diagonal)
    : state_(std::make_unique<state>(context, std::move(materials), std::move(instances), geometry_count, diagonal)) {
  context.check("setup of the stream client");
}

renderer::~renderer() = default;

void renderer::add_page(std::uint32_t number, const page& contents) {
  remove_page(number);
  auto& parts = state_->pages[number];
  for (const page_part& p : contents.parts) {
    const auto part = static_cast<std::uint32_t>(parts.size());
    parts.push_back(std::make_unique<device_part>(p));
    for (const page_piece& piece : p.pieces)
      state_->pieces[piece.geometry].push_back({number, part, piece.first_index, piece.indices});
  }
  // In the order of pages: pictures do not depend on the order of arrival.
  for (const page_part& p : contents.parts) {
    for (const page_piece& piece : p.pieces) {
      auto& list = state_->pieces[piece.geometry];
      std::sort(list.begin(), list.end(), [](const device_piece& a, const device_piece& b) {
        return std::tie(a.page, a.part, a.first_index) < std::tie(b.page, b.part, b.first_index);
      });
    }
  }
}

void renderer::remove_page(std::uint32_t number) {
  if (state_->pages.erase(number) == 0) return;
  for (auto& list : state_->pieces) std::erase_if(list, [&](const device_piece& p) { return p.page == number; });
}

void renderer::add_image(std::uint32_t number, const sightcell::scene::image_pixels& pixels) {
  remove_image(number);
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  if (pixels.width > static_cast<std::uint32_t>(limit) || pixels.height > static_cast<std::uint32_t>(limit)) return;
  state_->textures[number] =
      make_texture(static_cast<GLsizei>(pixels.width), static_cast<GLsizei>(pixels.height), pixels.rgba.data());
}

void renderer::remove_image(std::uint32_t number) {
  const auto found = state_->textures.find(number);
  if (found == state_->textures.end()) return;
  glDeleteTextures(1, &found->second);
  state_->textures.erase(found);
}

picture::image_rgba renderer::draw(const picture::camera& view, std::uint32_t width, std::uint32_t height,
                                   std::span<const std::uint64_t> shown) {
  state& r = *state_;
  r.target.resize(width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, r.target.framebuffer);
  glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glCullFace(GL_BACK);
  for (const GLenum off : {GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_DITHER}) glDisable(off);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_GREATER);  // reversed depth: larger is nearer
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  const GLfloat sky[4] = {picture::sky_color.x, picture::sky_color.y, picture::sky_color.z, 1.0f}, farthest = 0.0f;
  glClearBufferfv(GL_COLOR, 0, sky);
  glClearBufferfv(GL_DEPTH, 0, &farthest);
  glUseProgram(r.program.id());
  glVertexAttrib4f(2, 1.0f, 1.0f, 1.0f, 1.0f);  // of parts without colors
  glVertexAttrib4f(1, 0.0f, 0.0f, 0.0f, 1.0f);
  r.aim(view);
  r.finest_levels(shown);
  r.polygons = 0;
  std::uint32_t in_use = no_image;
  for (const std::uint32_t k : r.order) {
    const instance& i = r.instances[k];
    if (!has_bit(shown, k) || r.pieces[i.geometry].empty()) continue;
    if (i.material != in_use) r.use(r.materials[i.material]);
    in_use = i.material;
    r.draw_instance(i);
  }
  r.context.check("a picture of the stream client");
  return r.target.read();
}

std::uint64_t renderer::polygons_of_last_draw() const {
  return state_->polygons;
}

}  // namespace stream_client
