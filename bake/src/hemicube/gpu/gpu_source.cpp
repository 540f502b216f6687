#include "hemicube/gpu/gpu_source.h"

#include <algorithm>
#include <optional>
#include <string>

#include "hemicube/gpu/gather_compute.h"
#include "hemicube/gpu/gpu_gather.h"
#include "hemicube/gpu/gpu_geometry.h"
#include "hemicube/hemicube_faces.h"
#include "shaders/sources.h"
#include "shared/hemicube_layout.h"
#include "sightcell/base/error.h"
#include "sightcell/base/process_time.h"
#include "sightcell/picture/gl_program.h"

namespace sightcell::bake {
namespace {

shaders::vec4 with_w(const glm::vec3& v, float w) {
  return {v.x, v.y, v.z, w};
}

// The block of one face in the uniform buffer. 256 is the largest alignment that a device may require.
struct alignas(256) face_block {
  shaders::hemicube_face face;
};

face_block block_of(const glm::vec3& eye, const face_view& face) {
  // Off-center frustum of the kept part, which is -1..1 in clip space.
  const float width = face.max_x - face.min_x, height = face.max_y - face.min_y;
  const glm::vec3 clip_x = (2.0f * face.right - (face.max_x + face.min_x) * face.forward) / width;
  const glm::vec3 clip_y = (2.0f * face.up - (face.max_y + face.min_y) * face.forward) / height;
  return {{with_w(eye, hemicube_near), with_w(clip_x, 0.0f), with_w(clip_y, 0.0f), with_w(face.forward, 0.0f)}};
}

// Number of hemicubes in flight: drawn, with results that have not been read yet.
constexpr std::uint32_t in_flight = 3;

class gpu_source final : public hemicube_source {
 public:
  gpu_source(const picture::gl_context& context, const scene::world_geometry& world, const gpu_source_options& options)
      : context_(context),
        resolution_(options.resolution),
        near_over_far_(hemicube_near / options.far_plane),
        timeline_(options.timeline),
        geometry_(world),
        opaque_("hemicube/opaque", {{GL_VERTEX_SHADER, shaders::hemicube_polygon_vert},
                                    {GL_FRAGMENT_SHADER, shaders::hemicube_opaque_frag}}),
        see_through_("hemicube/see_through", {{GL_VERTEX_SHADER, shaders::hemicube_polygon_vert},
                                              {GL_FRAGMENT_SHADER, shaders::hemicube_see_through_frag}}),
        ids_(GL_R32UI, static_cast<GLsizei>(3 * resolution_), static_cast<GLsizei>(resolution_)),
        depths_(GL_DEPTH_COMPONENT32F, static_cast<GLsizei>(3 * resolution_), static_cast<GLsizei>(resolution_)),
        framebuffer_(ids_.id(), depths_.id()),
        face_blocks_(face_count * sizeof(face_block), nullptr, GL_DYNAMIC_STORAGE_BIT),
        culling_(make_culling(options)) {
    using stages = std::initializer_list<picture::gl_program::stage>;
    if (geometry_.has(masked_single_sided, masked_double_sided)) {
      masked_.emplace("hemicube/masked", stages{{GL_VERTEX_SHADER, shaders::hemicube_masked_vert},
                                                {GL_FRAGMENT_SHADER, shaders::hemicube_masked_frag}});
    }
    if (geometry_.has(see_through_masked_single_sided, see_through_masked_double_sided)) {
      see_through_masked_.emplace("hemicube/see_through_masked",
                                  stages{{GL_VERTEX_SHADER, shaders::hemicube_masked_vert},
                                         {GL_FRAGMENT_SHADER, shaders::hemicube_see_through_masked_frag}});
    }
    const bool compute = options.how == gather::compute || (options.how == gather::automatic && !context.software());
    std::uint32_t groups = 0;
    if (compute) groups = gather_compute_groups(resolution_)[0] * gather_compute_groups(resolution_)[1];
    if (compute || geometry_.has_see_through())
      counts_.emplace(geometry_.polygon_count(), groups, most_seen(), compute ? in_flight : 1);
    if (compute)
      compute_.emplace(*counts_, timeline_);
    else
      read_back_ = make_gather_read_back(geometry_.polygon_count(), counts_ ? &*counts_ : nullptr);
    const shaders::hemicube_gather block{resolution_, groups, near_over_far_, 0};
    gather_block_.emplace(sizeof block, &block);
    context_.check("hemicube setup");
  }

  using hemicube_source::render;
  void render(std::span<const pose> poses, std::span<hemicube_view> views) override {
    if (!compute_) {
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const auto faces = draw(poses[i]);
        read_back_->run(atlas(), faces, views[i]);
      }
    } else {
      // The device draws the next hemicubes while the results of the previous ones are read.
      for (std::size_t i = 0; i < poses.size() + in_flight; ++i) {
        const auto slot = static_cast<std::uint32_t>(i % in_flight);
        if (i >= in_flight && i - in_flight < poses.size()) compute_->receive(slot, views[i - in_flight]);
        if (i >= poses.size()) continue;
        draw(poses[i]);
        compute_->send(atlas(), slot);
      }
    }
    context_.check("hemicube");
  }

  // On a software rasterizer without threads (LP_NUM_THREADS=0) these are the costs of the parts. On hardware they are
  // the costs of waiting.
  std::optional<sample_split> render_split(const pose& where, hemicube_view& view) override {
    sample_split spent;
    const double start = thread_cpu_seconds();
    const auto faces = draw(where);
    glFinish();
    spent.draw = thread_cpu_seconds() - start;
    if (compute_)
      compute_->run(atlas(), faces, view, &spent);
    else
      read_back_->run(atlas(), faces, view, &spent);
    context_.check("hemicube");
    return spent;
  }

  void render_image(const pose& where, hemicube_image& image) override {
    draw_occluders(where, ids_of_background::clear);
    const std::size_t pixels = 3 * std::size_t{resolution_} * resolution_;
    image.resolution = resolution_;
    image.ids.resize(pixels);
    image.inverse_depths.resize(pixels);
    read_atlas(atlas(), image.ids, image.inverse_depths);
    for (float& depth : image.inverse_depths) depth /= hemicube_near;
    context_.check("hemicube");
  }

  std::uint32_t resolution() const override { return resolution_; }
  std::string device() const override { return context_.renderer() + " (" + context_.choice() + ")"; }

 private:
  void end_stage(const char* name) {
    if (timeline_ != nullptr) timeline_->end(name);
  }

  // Each visible occluder has at least one pixel of its own.
  std::uint32_t most_seen() const {
    const std::uint64_t most = 3 * std::uint64_t{resolution_} * resolution_ + geometry_.see_through_polygons();
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(most, geometry_.polygon_count()));
  }

  hemicube_atlas atlas() const { return {resolution_, near_over_far_, framebuffer_.id(), ids_.id(), depths_.id()}; }

  // What the ids are where nothing was drawn. Compute shaders look at the depth first.
  enum class ids_of_background { clear, any };

  // Draws the occluders into the atlas.
  std::array<face_view, face_count> draw_occluders(const pose& where, ids_of_background wanted) {
    const auto faces = hemicube_faces(where, resolution_);
    std::array<face_block, face_count> blocks;
    for (std::uint32_t f = 0; f < face_count; ++f) blocks[f] = block_of(where.eye, faces[f]);
    glNamedBufferSubData(face_blocks_.id(), 0, sizeof blocks, blocks.data());
    if (timeline_ != nullptr) timeline_->start();
    culling_->start(where.eye, faces);
    end_stage("cull, first pass");

    set_state();
    clear(wanted);
    end_stage("clear");
    draw_pass(faces);
    end_stage("draw, first pass");
    if (culling_->start_second()) {
      end_stage("cull, second pass");
      draw_pass(faces);
      end_stage("draw, second pass");
      culling_->finish_second();
      end_stage("resolve");
    }
    return faces;
  }

  // Draws the occluders and counts the non-occluders. The counts have to be collected before the next hemicube.
  std::array<face_view, face_count> draw(const pose& where) {
    const auto faces = draw_occluders(where, compute_.has_value() ? ids_of_background::any : ids_of_background::clear);
    if (counts_) counts_->bind();
    if (geometry_.has_see_through()) {
      glUseProgram(see_through_.id());
      glDepthMask(GL_FALSE);
      glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
      // GL_GEQUAL: a decal at exactly the depth of its wall is visible.
      draw_faces(faces, see_through_single_sided, see_through_double_sided);
      if (see_through_masked_) {
        glUseProgram(see_through_masked_->id());
        draw_faces(faces, see_through_masked_single_sided, see_through_masked_double_sided);
      }
      end_stage("count non-occluders");
    }
    return faces;
  }

  std::unique_ptr<gpu_culling> make_culling(const gpu_source_options& options) const {
    const culling how = options.hide;
    if ((how == culling::occlusion || (how == culling::automatic && !context_.software())) && can_cull_on_device())
      return make_occlusion_culling(geometry_, {resolution_, framebuffer_.id(), ids_.id(), depths_.id()},
                                    options.most_triangles);
    return make_frustum_culling(geometry_, how != culling::none);
  }

  // Sets all state for each hemicube, because other code draws with the same context.
  void set_state() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDepthRangef(0.0f, 1.0f);
    glFrontFace(GL_CCW);
    glCullFace(GL_BACK);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    for (const GLenum off : {GL_BLEND, GL_STENCIL_TEST, GL_DITHER, GL_MULTISAMPLE, GL_POLYGON_OFFSET_FILL,
                             GL_DEPTH_CLAMP, GL_COLOR_LOGIC_OP, GL_SAMPLE_ALPHA_TO_COVERAGE}) {
      glDisable(off);
    }
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_SCISSOR_TEST);
    glDepthFunc(GL_GEQUAL);  // reversed depth: larger is nearer; of two at the same depth the later one is kept
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    const auto width = static_cast<GLsizei>(3 * resolution_), height = static_cast<GLsizei>(resolution_);
    glScissor(0, 0, width, height);
    geometry_.bind();
    glBindBufferBase(GL_UNIFORM_BUFFER, shaders::hemicube_block_gather, gather_block_->id());
  }

  void clear(ids_of_background wanted) const {
    const GLuint background[4] = {shaders::hemicube_background, 0, 0, 0};
    const GLfloat farthest = 0.0f;
    if (wanted == ids_of_background::clear) glClearBufferuiv(GL_COLOR, 0, background);
    glClearBufferfv(GL_DEPTH, 0, &farthest);
  }

  // Draws the selected occluders.
  void draw_pass(std::span<const face_view, face_count> faces) {
    glUseProgram(opaque_.id());
    draw_faces(faces, opaque_single_sided, opaque_double_sided);
    if (!masked_) return;
    glUseProgram(masked_->id());
    draw_faces(faces, masked_single_sided, masked_double_sided);
  }

  void draw_faces(std::span<const face_view, face_count> faces, polygon_class single_sided,
                  polygon_class double_sided) {
    for (std::uint32_t f = 0; f < face_count; ++f) {
      const face_view& face = faces[f];
      const auto x = static_cast<GLint>(face.x), y = static_cast<GLint>(face.y);
      const auto width = static_cast<GLsizei>(face.width), height = static_cast<GLsizei>(face.height);
      glViewport(x, y, width, height);
      glScissor(x, y, width, height);
      glBindBufferRange(GL_UNIFORM_BUFFER, shaders::hemicube_block_face, face_blocks_.id(),
                        static_cast<GLintptr>(f * sizeof(face_block)), sizeof(shaders::hemicube_face));
      glEnable(GL_CULL_FACE);
      culling_->draw(f, single_sided);
      glDisable(GL_CULL_FACE);
      culling_->draw(f, double_sided);
    }
  }

  const picture::gl_context& context_;
  std::uint32_t resolution_;
  float near_over_far_;
  gpu_timeline* timeline_;
  gpu_geometry geometry_;
  picture::gl_program opaque_, see_through_;
  std::optional<picture::gl_program> masked_, see_through_masked_;  // only where the scene has such polygons
  gl_image ids_, depths_;
  gl_framebuffer framebuffer_;
  gl_buffer face_blocks_;
  std::unique_ptr<gpu_culling> culling_;
  std::optional<gl_buffer> gather_block_;
  std::optional<polygon_counts> counts_;
  std::optional<gather_compute> compute_;
  std::unique_ptr<gpu_gather> read_back_;  // used without compute_
};

}  // namespace

std::unique_ptr<hemicube_source> make_gpu_source(const picture::gl_context& context,
                                                 const scene::world_geometry& geometry,
                                                 const gpu_source_options& options) {
  check_hemicube(options.resolution, options.far_plane);
  return std::make_unique<gpu_source>(context, geometry, options);
}

}  // namespace sightcell::bake
