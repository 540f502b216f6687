#include "sightcell/picture/picture.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <glm/geometric.hpp>
#include <string>

#include "polygon_lists.h"
#include "shaders/sources.h"
#include "shared/picture_layout.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/gl_program.h"
#include "sightcell/picture/textures.h"

namespace sightcell::picture {
namespace {

constexpr float near_plane = 0.001f;      // meters; that of the bake
constexpr float haze_over_scene = 0.35f;  // optical depth across the scene's diagonal
constexpr float thickest_haze = 0.001f;   // limit per meter, so that rooms have no haze

shaders::vec4 with_w(const glm::vec3& v, float w) {
  return {v.x, v.y, v.z, w};
}

// The block of a material in the uniform buffer. 256 is the largest alignment that a device may require.
struct alignas(256) material_block {
  shaders::picture_material material;
};

material_block block_of(const scene::material& m) {
  const glm::vec4& color = m.base_color;
  return {{{color.x, color.y, color.z, color.w},
           m.alpha == scene::alpha_mode::mask ? m.alpha_cutoff : 0.0f,
           m.alpha == scene::alpha_mode::blend ? 0.0f : 1.0f,
           0.0f,
           0.0f}};
}

shaders::picture_view view_of(const camera& c, float aspect, float haze) {
  const auto finite = [](const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  const float length = glm::length(c.forward);
  if (!finite(c.eye) || !finite(c.up) || !(length > 0.0f) || !std::isfinite(length) || !(c.vertical_fov > 0.0f) ||
      !(c.vertical_fov < 3.1f)) {
    throw error(error_kind::wrong_use, "picture.camera", "camera",
                "it has no valid direction, position or field of view",
                "pass finite numbers and a field of view below 3.1 radians");
  }
  const glm::vec3 forward = c.forward / length;
  glm::vec3 right = glm::cross(forward, c.up);
  if (!(glm::dot(right, right) > 1e-10f)) {
    // forward is parallel to up: any other direction will do.
    right = glm::cross(forward, std::abs(forward.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1));
  }
  right = glm::normalize(right);
  const glm::vec3 up = glm::cross(right, forward);
  const float half_height = std::tan(0.5f * c.vertical_fov);
  return {with_w(c.eye, near_plane), with_w(right / (half_height * aspect), 0.0f), with_w(up / half_height, 0.0f),
          with_w(forward, 0.0f), with_w(sky_color, haze)};
}

double cpu_milliseconds() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Color and depth images of one size.
class frame {
 public:
  frame(std::uint32_t width, std::uint32_t height) : width_(width), height_(height) {
    glCreateRenderbuffers(2, images_);
    glNamedRenderbufferStorage(images_[0], GL_SRGB8_ALPHA8, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
    glNamedRenderbufferStorage(images_[1], GL_DEPTH_COMPONENT32F, static_cast<GLsizei>(width),
                               static_cast<GLsizei>(height));
    glCreateFramebuffers(1, &framebuffer_);
    glNamedFramebufferRenderbuffer(framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, images_[0]);
    glNamedFramebufferRenderbuffer(framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, images_[1]);
  }
  ~frame() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(2, images_);
  }
  frame(const frame&) = delete;
  frame& operator=(const frame&) = delete;

  bool has_size(std::uint32_t width, std::uint32_t height) const { return width == width_ && height == height_; }
  GLuint framebuffer() const { return framebuffer_; }

  image_rgba read() const {
    image_rgba picture{width_, height_, std::vector<std::uint8_t>(4 * std::size_t{width_} * height_)};
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_), GL_RGBA, GL_UNSIGNED_BYTE,
                 picture.pixels.data());
    // OpenGL's first row is the lowest.
    const auto row = static_cast<std::ptrdiff_t>(4 * std::size_t{width_});
    for (std::ptrdiff_t low = 0, high = std::ptrdiff_t{height_} - 1; low < high; ++low, --high) {
      const auto begin = picture.pixels.begin();
      std::swap_ranges(begin + low * row, begin + (low + 1) * row, begin + high * row);
    }
    for (std::size_t i = 3; i < picture.pixels.size(); i += 4) picture.pixels[i] = 255;
    return picture;
  }

 private:
  std::uint32_t width_, height_;
  GLuint images_[2] = {}, framebuffer_ = 0;
};

}  // namespace

struct renderer::state {
  state(const gl_context& context_used, const scene::scene& s, const scene::world_geometry& g)
      : context(context_used),
        lists(s, g),
        textures(s),
        program("picture/picture", {{GL_VERTEX_SHADER, shaders::picture_picture_vert},
                                    {GL_FRAGMENT_SHADER, shaders::picture_picture_frag}}) {
    const float diagonal = glm::length(g.max - g.min);
    haze = diagonal > 0.0f && std::isfinite(diagonal) ? std::min(haze_over_scene / diagonal, thickest_haze) : 0.0f;
    glCreateBuffers(buffer_count, buffers);
    upload_vertices(s, g);
    upload_materials(s);
    lists.gather(std::nullopt, list, all_ranges);
    fill(buffers[all_indices], list, GL_STATIC_DRAW);
    glNamedBufferData(buffers[view_block], sizeof(shaders::picture_view), nullptr, GL_DYNAMIC_DRAW);
    context.check("picture setup");
  }
  ~state() {
    glDeleteVertexArrays(1, &vertex_array);
    glDeleteBuffers(buffer_count, buffers);
  }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  template <class T>
  static void fill(GLuint buffer, const std::vector<T>& data, GLenum usage) {
    glNamedBufferData(buffer, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(), usage);
  }

  void upload_vertices(const scene::scene& s, const scene::world_geometry& g) {
    std::vector<glm::vec2> uvs(g.positions.size(), glm::vec2(0.0f));
    std::vector<glm::u8vec4> colors;  // only if the scene has vertex colors
    for (const scene::draw& d : s.draws) {
      const std::vector<glm::vec2>& own = s.geometries[d.geometry].uvs;
      if (d.base_vertex + own.size() <= uvs.size()) {
        std::copy(own.begin(), own.end(), uvs.begin() + static_cast<std::ptrdiff_t>(d.base_vertex));
      }
      const std::vector<glm::u8vec4>& tints = s.geometries[d.geometry].colors;
      if (tints.empty()) continue;
      colors.resize(g.positions.size(), glm::u8vec4(255));
      std::copy(tints.begin(), tints.end(), colors.begin() + static_cast<std::ptrdiff_t>(d.base_vertex));
    }
    fill(buffers[positions], g.positions, GL_STATIC_DRAW);
    fill(buffers[texture_uvs], uvs, GL_STATIC_DRAW);
    fill(buffers[vertex_colors], colors, GL_STATIC_DRAW);
    glCreateVertexArrays(1, &vertex_array);
    glVertexArrayVertexBuffer(vertex_array, 0, buffers[positions], 0, sizeof(glm::vec3));
    glVertexArrayVertexBuffer(vertex_array, 1, buffers[texture_uvs], 0, sizeof(glm::vec2));
    glEnableVertexArrayAttrib(vertex_array, shaders::picture_attribute_position);
    glVertexArrayAttribFormat(vertex_array, shaders::picture_attribute_position, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(vertex_array, shaders::picture_attribute_position, 0);
    glEnableVertexArrayAttrib(vertex_array, shaders::picture_attribute_uv);
    glVertexArrayAttribFormat(vertex_array, shaders::picture_attribute_uv, 2, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(vertex_array, shaders::picture_attribute_uv, 1);
    if (colors.empty()) return;  // the shader reads the constant of set_state
    glVertexArrayVertexBuffer(vertex_array, 2, buffers[vertex_colors], 0, sizeof(glm::u8vec4));
    glEnableVertexArrayAttrib(vertex_array, shaders::picture_attribute_color);
    glVertexArrayAttribFormat(vertex_array, shaders::picture_attribute_color, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0);
    glVertexArrayAttribBinding(vertex_array, shaders::picture_attribute_color, 2);
  }

  // The default material of glTF is last, for draws without a material.
  void upload_materials(const scene::scene& s) {
    std::vector<material_block> blocks;
    for (const scene::material& m : s.materials) {
      blocks.push_back(block_of(m));
      texture_of.push_back(textures.of_material(m));
    }
    blocks.push_back(block_of(scene::material{}));
    texture_of.push_back(textures.of_material(scene::material{}));
    fill(buffers[material_blocks], blocks, GL_STATIC_DRAW);
  }

  void set_state(std::uint32_t width, std::uint32_t height) const {
    glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer());
    glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDepthRangef(0.0f, 1.0f);
    glFrontFace(GL_CCW);
    glCullFace(GL_BACK);
    for (const GLenum off : {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_DITHER}) glDisable(off);
    glEnable(GL_FRAMEBUFFER_SRGB);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);  // reversed depth: larger is closer
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    const GLfloat sky[4] = {sky_color.x, sky_color.y, sky_color.z, 1.0f};
    const GLfloat farthest = 0.0f;
    glClearBufferfv(GL_COLOR, 0, sky);
    glClearBufferfv(GL_DEPTH, 0, &farthest);
    glUseProgram(program.id());
    glBindVertexArray(vertex_array);
    glVertexAttrib4f(shaders::picture_attribute_color, 1.0f, 1.0f, 1.0f, 1.0f);
    glBindBufferBase(GL_UNIFORM_BUFFER, shaders::picture_block_view, buffers[view_block]);
  }

  void draw_ranges(const std::vector<index_range>& ranges) const {
    for (const index_range& range : ranges) {
      const draw_group& group = lists.groups()[range.group];
      if (group.double_sided) {
        glDisable(GL_CULL_FACE);
      } else {
        glEnable(GL_CULL_FACE);
      }
      if (group.alpha == scene::alpha_mode::blend) {
        glEnable(GL_BLEND);
        glDepthMask(GL_FALSE);
      }
      const std::size_t material = std::min<std::size_t>(group.material, texture_of.size() - 1);
      glBindBufferRange(GL_UNIFORM_BUFFER, shaders::picture_block_material, buffers[material_blocks],
                        static_cast<GLintptr>(material * sizeof(material_block)), sizeof(shaders::picture_material));
      glBindTextureUnit(shaders::picture_texture_base_color, texture_of[material]);
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.count), GL_UNSIGNED_INT,
                     reinterpret_cast<const void*>(range.first * sizeof(std::uint32_t)));
    }
  }

  enum : int {
    positions,
    texture_uvs,
    vertex_colors,
    all_indices,
    some_indices,
    material_blocks,
    view_block,
    buffer_count
  };

  const gl_context& context;
  polygon_lists lists;
  texture_set textures;
  gl_program program;
  GLuint buffers[buffer_count] = {};
  GLuint vertex_array = 0;
  std::vector<unsigned> texture_of;  // by material block
  std::vector<std::uint32_t> list;   // index list of the last draw
  std::vector<index_range> all_ranges, some_ranges;
  std::unique_ptr<frame> target;
  float haze = 0.0f;
  std::uint64_t polygons = 0;
  double milliseconds = 0.0;
};

renderer::renderer(const gl_context& context, const scene::scene& s, const scene::world_geometry& geometry)
    : state_(std::make_unique<state>(context, s, geometry)) {}

renderer::~renderer() = default;

image_rgba renderer::draw(const camera& view, std::uint32_t width, std::uint32_t height,
                          std::optional<std::span<const std::uint32_t>> source_ids) {
  state& r = *state_;
  GLint limit = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  const auto largest = static_cast<std::uint32_t>(limit);
  if (width < 1 || height < 1 || width > largest || height > largest) {
    throw error(
        error_kind::wrong_use, "picture.size", "picture",
        std::to_string(width) + " x " + std::to_string(height) + " pixels is not a size that this device supports",
        "use 1 to " + std::to_string(largest));
  }
  if (!r.target || !r.target->has_size(width, height)) {
    r.target.reset();
    r.target = std::make_unique<frame>(width, height);
  }
  const auto block = view_of(view, static_cast<float>(width) / static_cast<float>(height), r.haze);

  glFinish();  // work of other code is not part of this picture's time
  const double start = cpu_milliseconds();
  if (source_ids) {
    r.lists.gather(source_ids, r.list, r.some_ranges);
    state::fill(r.buffers[state::some_indices], r.list, GL_STREAM_DRAW);
  }
  const std::vector<index_range>& ranges = source_ids ? r.some_ranges : r.all_ranges;
  glNamedBufferSubData(r.buffers[state::view_block], 0, sizeof block, &block);
  glVertexArrayElementBuffer(r.vertex_array, r.buffers[source_ids ? state::some_indices : state::all_indices]);
  r.set_state(width, height);
  r.draw_ranges(ranges);
  glFinish();
  r.milliseconds = cpu_milliseconds() - start;

  r.polygons = 0;
  for (const index_range& range : ranges) r.polygons += range.count / 3;
  image_rgba picture = r.target->read();
  r.context.check("picture");
  return picture;
}

std::uint64_t renderer::polygons_of_last_draw() const {
  return state_->polygons;
}

double renderer::cpu_milliseconds_of_last_draw() const {
  return state_->milliseconds;
}

}  // namespace sightcell::picture
