#pragma once
// The draw paths. Between begin and the end of a frame, each mode draws the same view into the same target.
#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <vector>

#include "camera.h"
#include "depth_levels.h"
#include "gl_objects.h"
#include "host_scene.h"
#include "sightcell/picture/gl_program.h"
#include "sightcell/scene/scene.h"
#include "visibility.h"

namespace gpu_driven {

enum class draw_mode : std::uint8_t {
  everything,    // all clusters; with levels of detail, all of the cut
  frustum,       // clusters in the frustum that do not face away; so are those of the modes below
  pvs,           // clusters with a polygon in the set
  last_frame,    // clusters that the hierarchical depth of the last frame does not occlude, in one pass
  two_pass,      // what was visible in the last frame; then the rest, tested against the depth of that
  pvs_two_pass,  // the same, of clusters with a polygon in the set
  leaves         // with --levels: as frustum, without levels of detail
};
inline constexpr std::size_t mode_count = 7;
inline constexpr std::array<const char*, mode_count> mode_names = {"everything", "frustum",      "pvs",   "last_frame",
                                                                   "two_pass",   "pvs_two_pass", "leaves"};

// A picture on the device.
struct target {
  gl_texture color, depth, ids;  // ids: of clusters + 1; only that of everything has them
  gl_framebuffer framebuffer;

  target(int width, int height, bool has_ids);
};

class renderer {
 public:
  struct settings {
    int width = 0, height = 0;
    bool may_count = true;     // use ARB_indirect_parameters where the device has it
    float most_pixels = 0.0f;  // error of the cut, where the scene has levels of detail
  };

  // host: its bins are used afterwards, so it must outlive the object. s: used during the constructor only.
  // Fails with gl.*, gpu-driven.limit.
  renderer(const sightcell::scene::scene& s, const host_scene& host, const settings& wanted);

  ~renderer();
  renderer(const renderer&) = delete;
  renderer& operator=(const renderer&) = delete;

  // Begins a frame.
  void begin(const camera& view);

  // Draws the frame in a mode. Calls are to be in the same order in each frame.
  // visible: for the modes of the PVS, has moved to the eye; else null.
  void draw(draw_mode mode, const visibility* visible);

  bool has_levels() const { return !host_.level_groups.empty(); }
  bool draws(draw_mode mode) const { return mode != draw_mode::leaves || has_levels(); }
  bool counts() const { return counts_; }
  const settings& size() const { return settings_; }
  std::uint32_t multi_draws(draw_mode mode) const;  // calls that draw, per frame

  const target& picture(draw_mode mode) const { return mode == draw_mode::everything ? full_ : shared_; }
  const gl_buffer& clusters() const { return clusters_; }
  const gl_buffer& drawn(draw_mode mode) const { return states_[static_cast<std::size_t>(mode)].drawn; }
  const gl_buffer& seen() const { return seen_; }  // clusters with pixels in the last picture of everything

 private:
  // What a mode keeps for its next frame.
  struct state {
    gl_buffer drawn, history;
  };
  enum class stage : std::uint8_t { without_depth, last_depth, first_of_two, second_of_two, whole_cut };

  void make_vertex_array();
  void cull(draw_mode mode, stage which, const visibility* visible);
  void draw_everything();
  void begin_commands() const;
  void bind_for_draws(const gl_buffer& commands, const gl_buffer& counts);
  void draw_bin(std::size_t b, std::uint32_t region);
  void draw_bins(std::uint32_t region, bool blended);
  void begin_pass(const target& into);
  void set_bin(const bin& b);
  void remember_depth();

  const host_scene& host_;
  settings settings_;
  bool counts_ = false;
  gl_texture textures_;
  gl_buffer vertices_, indices_, instances_, materials_, clusters_, levels_, bins_, all_commands_;
  gl_buffer all_counts_, first_counts_, commands_, command_counts_, view_, last_view_, seen_;
  std::array<state, mode_count> states_;
  target full_, shared_;
  depth_levels own_depth_, last_depth_;
  sightcell::picture::gl_program cull_, opaque_, masked_, blended_;
  GLuint vertex_array_ = 0;
};

}  // namespace gpu_driven
