#include "scene_renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "shader_text.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/gl_program.h"
#include "sightcell/picture/textures.h"

namespace viewer {
namespace {

namespace picture = sightcell::picture;
namespace scene = sightcell::scene;

constexpr float near_plane = 0.001f;                 // meters; as near as the bake looks
constexpr glm::vec3 sky_color(0.36f, 0.55f, 0.82f);  // linear
constexpr float haze_over_scene = 0.35f;             // optical depth across the scene's diagonal, but at most
constexpr float thickest_haze = 0.001f;              // this per meter: none inside a room
constexpr float faint = 0.5f;                        // alpha of hidden lines

// Uniform locations, as in shader_text.h.
enum : GLint { at_eye, at_clip_x, at_clip_y, at_clip_w, at_sky, at_base_color, at_alpha, at_mark, at_brightness };
constexpr GLint at_screen = 4;  // of the lines

struct surface {
  glm::vec4 base_color{1.0f};
  float alpha_cutoff = 0.0f, alpha_opaque = 1.0f;
  GLuint texture = 0;
};

surface surface_of(const scene::material& m, const picture::texture_set& textures) {
  return {m.base_color, m.alpha == scene::alpha_mode::mask ? m.alpha_cutoff : 0.0f,
          m.alpha == scene::alpha_mode::blend ? 0.0f : 1.0f, textures.of_material(m)};
}

template <class T>
void upload(GLuint buffer, const std::vector<T>& data) {
  glNamedBufferStorage(buffer, static_cast<GLsizeiptr>(std::max<std::size_t>(data.size(), 1) * sizeof(T)), nullptr,
                       GL_DYNAMIC_STORAGE_BIT);
  if (!data.empty()) {
    glNamedBufferSubData(buffer, 0, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data());
  }
}

void add_attribute(GLuint array, GLuint index, GLint components, GLuint offset, GLuint binding) {
  glEnableVertexArrayAttrib(array, index);
  glVertexArrayAttribFormat(array, index, components, GL_FLOAT, GL_FALSE, offset);
  glVertexArrayAttribBinding(array, index, binding);
}

// Color and depth.
class offscreen_frame {
 public:
  ~offscreen_frame() { release(); }
  void resize(std::uint32_t width, std::uint32_t height) {
    if (width == width_ && height == height_) return;
    release();
    width_ = width;
    height_ = height;
    glCreateRenderbuffers(2, images_);
    glNamedRenderbufferStorage(images_[0], GL_SRGB8_ALPHA8, w(), h());
    glNamedRenderbufferStorage(images_[1], GL_DEPTH_COMPONENT32F, w(), h());
    glCreateFramebuffers(1, &framebuffer_);
    glNamedFramebufferRenderbuffer(framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, images_[0]);
    glNamedFramebufferRenderbuffer(framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, images_[1]);
  }
  GLsizei w() const { return static_cast<GLsizei>(width_); }
  GLsizei h() const { return static_cast<GLsizei>(height_); }
  GLuint framebuffer() const { return framebuffer_; }

 private:
  void release() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(2, images_);
  }
  std::uint32_t width_ = 0, height_ = 0;
  GLuint images_[2] = {}, framebuffer_ = 0;
};

}  // namespace

index_list::index_list() {
  glCreateBuffers(1, &buffer_);
}

index_list::~index_list() {
  glDeleteBuffers(1, &buffer_);
}

void index_list::fill(std::size_t indices, const std::function<void(std::span<std::uint32_t>)>& write) {
  const auto bytes = static_cast<GLsizeiptr>(indices * sizeof(std::uint32_t));
  for (int attempt = 0; attempt < 3 && bytes > 0; ++attempt) {
    glNamedBufferData(buffer_, bytes, nullptr, GL_STREAM_DRAW);  // a new one: the old may still be being drawn
    void* memory = glMapNamedBufferRange(buffer_, 0, bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
    if (memory == nullptr) break;
    write({static_cast<std::uint32_t*>(memory), indices});
    if (glUnmapNamedBuffer(buffer_) == GL_TRUE) return;  // else the driver lost what was written
  }
  if (bytes == 0) return;
  throw sightcell::error(sightcell::error_kind::failed, "viewer.memory", "index list",
                         "the device has no room for " + std::to_string(bytes) + " bytes", "try a smaller scene");
}

void index_list::set_ranges(std::span<const sightcell_range> ranges) {
  parts_ = parts_of(ranges);
  clipped_ = stretches_are_current_ = false;
}

void index_list::clip(const draw_groups& groups, const polygon_blocks& blocks, const view_volume* volume) {
  if (volume == nullptr && !clipped_ && stretches_are_current_) return;
  clipped_ = volume != nullptr;
  if (clipped_) blocks.clip(parts_, *volume, in_view_);
  make_stretches(groups, parts(), stretches_);
  polygons_ = polygons_in(parts());
  stretches_are_current_ = true;
}

struct scene_renderer::state {
  state(const scene::scene& s, const scene::world_geometry& world) : textures(s) {
    for (const scene::material& m : s.materials) surfaces.push_back(surface_of(m, textures));
    surfaces.push_back(surface_of(scene::material{}, textures));
    glCreateBuffers(4, buffers);
    glCreateVertexArrays(2, arrays);
    upload_vertices(s, world);
    glVertexArrayVertexBuffer(arrays[1], 0, buffers[2], 0, sizeof(segment));
    glVertexArrayBindingDivisor(arrays[1], 0, 1);
    add_attribute(arrays[1], 0, 3, offsetof(segment, a), 0);
    add_attribute(arrays[1], 1, 3, offsetof(segment, b), 0);
    add_attribute(arrays[1], 2, 4, offsetof(segment, color), 0);
    const float diagonal = glm::length(world.max - world.min);
    haze = diagonal > 0.0f && std::isfinite(diagonal) ? std::min(haze_over_scene / diagonal, thickest_haze) : 0.0f;
    check_gl("upload");
  }
  ~state() {
    glDeleteVertexArrays(2, arrays);
    glDeleteBuffers(4, buffers);
  }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  void upload_vertices(const scene::scene& s, const scene::world_geometry& world) {
    upload(buffers[0], world.positions);
    glVertexArrayVertexBuffer(arrays[0], 0, buffers[0], 0, sizeof(glm::vec3));
    add_attribute(arrays[0], 0, 3, 0, 0);
    upload_colors(s, world);
    const bool textured = std::any_of(s.materials.begin(), s.materials.end(),
                                      [](const scene::material& m) { return m.base_color_image != scene::no_index; });
    if (!textured) return;  // a third of the memory for nothing; the shader reads zeros
    std::vector<glm::vec2> uvs(world.positions.size(), glm::vec2(0.0f));
    for (const scene::draw& d : s.draws) {
      const std::vector<glm::vec2>& own = s.geometries[d.geometry].uvs;
      if (d.base_vertex + own.size() <= uvs.size()) {
        std::copy(own.begin(), own.end(), uvs.begin() + static_cast<std::ptrdiff_t>(d.base_vertex));
      }
    }
    upload(buffers[1], uvs);
    glVertexArrayVertexBuffer(arrays[0], 1, buffers[1], 0, sizeof(glm::vec2));
    add_attribute(arrays[0], 1, 2, 0, 1);
  }

  void upload_colors(const scene::scene& s, const scene::world_geometry& world) {
    std::vector<glm::u8vec4> colors;  // only where the scene has any; else the shader reads a constant
    for (const scene::draw& d : s.draws) {
      const std::vector<glm::u8vec4>& own = s.geometries[d.geometry].colors;
      if (own.empty()) continue;
      colors.resize(world.positions.size(), glm::u8vec4(255));
      std::copy(own.begin(), own.end(), colors.begin() + static_cast<std::ptrdiff_t>(d.base_vertex));
    }
    if (colors.empty()) return;
    upload(buffers[3], colors);
    glVertexArrayVertexBuffer(arrays[0], 2, buffers[3], 0, sizeof(glm::u8vec4));
    glEnableVertexArrayAttrib(arrays[0], 2);
    glVertexArrayAttribFormat(arrays[0], 2, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0);
    glVertexArrayAttribBinding(arrays[0], 2, 2);
  }

  void aim(const fly_camera& camera) const {
    const glm::vec3 forward = camera.forward(), right = camera.right(), up = glm::cross(right, forward);
    const float half_height = std::tan(0.5f * camera.vertical_fov);
    const float aspect = static_cast<float>(frame.w()) / static_cast<float>(frame.h());
    const glm::vec3 x = right / (half_height * aspect), y = up / half_height;
    for (const GLuint program : {scene_program.id(), line_program.id()}) {
      glProgramUniform4f(program, at_eye, camera.eye.x, camera.eye.y, camera.eye.z, near_plane);
      glProgramUniform3f(program, at_clip_x, x.x, x.y, x.z);
      glProgramUniform3f(program, at_clip_y, y.x, y.y, y.z);
      glProgramUniform3f(program, at_clip_w, forward.x, forward.y, forward.z);
    }
    glProgramUniform4f(scene_program.id(), at_sky, sky_color.x, sky_color.y, sky_color.z, haze);
  }

  // Returns how many calls that took.
  std::uint32_t draw_group_of(const draw_group& group, const group_stretches& part) const {
    if (part.counts.empty()) return 0;
    (group.double_sided ? glDisable : glEnable)(GL_CULL_FACE);
    const surface& s = surfaces[std::min<std::size_t>(group.material, surfaces.size() - 1)];
    glUniform4f(at_base_color, s.base_color.x, s.base_color.y, s.base_color.z, s.base_color.w);
    glUniform2f(at_alpha, s.alpha_cutoff, s.alpha_opaque);
    glBindTextureUnit(0, s.texture);
    glMultiDrawElements(GL_TRIANGLES, part.counts.data(), GL_UNSIGNED_INT, part.offsets.data(),
                        static_cast<GLsizei>(part.counts.size()));
    return 1;
  }

  static void set_mark(const painted_list& painted) {
    glUniform4f(at_mark, painted.mark.x, painted.mark.y, painted.mark.z, painted.mark.w);
  }

  std::uint32_t draw_opaque(const draw_groups& groups, std::span<const painted_list> lists) const {
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    std::uint32_t calls = 0;
    for (const painted_list& painted : lists) {
      glVertexArrayElementBuffer(arrays[0], painted.list->buffer());
      set_mark(painted);
      const std::vector<group_stretches>& stretches = painted.list->stretches();
      for (std::size_t g = 0; g < stretches.size(); ++g) {
        const draw_group& group = groups.groups()[g];
        if (group.alpha != scene::alpha_mode::blend) calls += draw_group_of(group, stretches[g]);
      }
    }
    return calls;
  }

  std::uint32_t draw_blended(const draw_groups& groups, std::span<const painted_list> lists,
                             std::span<const blended_run> runs, const index_list& everything) const {
    glEnable(GL_BLEND);
    glDepthMask(GL_FALSE);
    glVertexArrayElementBuffer(arrays[0], everything.buffer());
    std::uint32_t calls = 0;
    for (const blended_run& run : runs) {
      set_mark(lists[run.list]);
      calls += draw_group_of(groups.groups()[run.group], run.stretches);
    }
    return calls;
  }

  picture::texture_set textures;
  picture::gl_program scene_program{"viewer/scene", {{GL_VERTEX_SHADER, scene_vert}, {GL_FRAGMENT_SHADER, scene_frag}}};
  picture::gl_program line_program{"viewer/line", {{GL_VERTEX_SHADER, line_vert}, {GL_FRAGMENT_SHADER, line_frag}}};
  std::vector<surface> surfaces;  // by material; glTF's default material comes last
  GLuint buffers[4] = {};         // positions, texture coordinates, lines, colors
  GLuint arrays[2] = {};          // scene, lines
  offscreen_frame frame;
  float haze = 0.0f;
};

scene_renderer::scene_renderer(const scene::scene& s, const scene::world_geometry& world)
    : state_(std::make_unique<state>(s, world)) {}

scene_renderer::~scene_renderer() = default;

void scene_renderer::begin(const fly_camera& camera, float brightness, std::uint32_t width, std::uint32_t height) {
  state& r = *state_;
  r.frame.resize(width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, r.frame.framebuffer());
  glViewport(0, 0, r.frame.w(), r.frame.h());
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glFrontFace(GL_CCW);
  glCullFace(GL_BACK);
  for (const GLenum off : {GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_DITHER}) glDisable(off);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const GLfloat sky[4] = {sky_color.x, sky_color.y, sky_color.z, 1.0f};
  const GLfloat farthest = 0.0f;
  glClearBufferfv(GL_COLOR, 0, sky);
  glClearBufferfv(GL_DEPTH, 0, &farthest);
  r.aim(camera);
  glProgramUniform1f(r.scene_program.id(), at_brightness, brightness);
  calls_ = 0;
}

void scene_renderer::draw(const draw_groups& groups, std::span<const painted_list> lists,
                          std::span<const blended_run> blended, const index_list& everything, bool wireframe) {
  glUseProgram(state_->scene_program.id());
  glBindVertexArray(state_->arrays[0]);
  glVertexAttrib4f(2, 1.0f, 1.0f, 1.0f, 1.0f);  // the tint of scenes without colors
  glDepthFunc(GL_GREATER);                      // reversed depth: larger is nearer
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glPolygonMode(GL_FRONT_AND_BACK, wireframe ? GL_LINE : GL_FILL);
  calls_ += state_->draw_opaque(groups, lists);
  calls_ += state_->draw_blended(groups, lists, blended, everything);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

void scene_renderer::draw_lines(std::span<const segment> lines, float pixels_wide) {
  if (lines.empty()) return;
  state& r = *state_;
  glNamedBufferData(r.buffers[2], static_cast<GLsizeiptr>(lines.size_bytes()), lines.data(), GL_STREAM_DRAW);
  glUseProgram(r.line_program.id());
  glBindVertexArray(r.arrays[1]);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  for (const bool hidden : {true, false}) {
    glDepthFunc(hidden ? GL_LEQUAL : GL_GREATER);
    glUniform4f(at_screen, static_cast<float>(r.frame.w()), static_cast<float>(r.frame.h()), pixels_wide,
                hidden ? faint : 1.0f);
    glDrawArraysInstanced(GL_TRIANGLES, 0, 6, static_cast<GLsizei>(lines.size()));
  }
  glDepthMask(GL_TRUE);
}

unsigned scene_renderer::framebuffer() const {
  return state_->frame.framebuffer();
}

picture::image_rgba scene_renderer::read() const {
  const offscreen_frame& frame = state_->frame;
  picture::image_rgba out{static_cast<std::uint32_t>(frame.w()), static_cast<std::uint32_t>(frame.h()), {}};
  const auto row = static_cast<std::ptrdiff_t>(4 * std::size_t{out.width});
  out.pixels.resize(static_cast<std::size_t>(row) * out.height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frame.framebuffer());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, frame.w(), frame.h(), GL_RGBA, GL_UNSIGNED_BYTE, out.pixels.data());
  // OpenGL's first row is the lowest.
  for (std::ptrdiff_t low = 0, high = std::ptrdiff_t{out.height} - 1; low < high; ++low, --high) {
    const auto begin = out.pixels.begin();
    std::swap_ranges(begin + low * row, begin + (low + 1) * row, begin + high * row);
  }
  for (std::size_t i = 3; i < out.pixels.size(); i += 4) out.pixels[i] = 255;
  return out;
}

void scene_renderer::show_in_window() const {
  const offscreen_frame& frame = state_->frame;
  glDisable(GL_FRAMEBUFFER_SRGB);  // the bytes as they are
  glBlitNamedFramebuffer(frame.framebuffer(), 0, 0, 0, frame.w(), frame.h(), 0, 0, frame.w(), frame.h(),
                         GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void check_gl(const char* where) {
  const GLenum code = glGetError();
  if (code == GL_NO_ERROR) return;
  // Each kind of error has its own flag; a lost context may report for ever.
  for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) {
  }
  throw sightcell::error(sightcell::error_kind::failed, "viewer.gl", std::string("OpenGL in ") + where,
                         code == GL_OUT_OF_MEMORY ? "out of memory" : "error " + std::to_string(code),
                         "report this with the name of your graphics driver");
}

}  // namespace viewer
