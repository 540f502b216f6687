#pragma once
// Draws a tour in each mode, compares each measured frame with everything, and adds up.
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "comparison.h"
#include "host_scene.h"
#include "renderer.h"
#include "sightcell/sightcell.hpp"
#include "tour.h"
#include "visibility.h"

namespace gpu_driven {

// Sums over frames.
struct mode_sums {
  std::uint64_t clusters = 0, triangles = 0, clusters_in_set = 0, missed = 0, missed_with_wrong = 0;
  std::uint64_t wrong_pixels = 0, ties = 0, differing = 0;
  double difference = 0.0;                                    // of colors: 1 for black and white, of all pixels
  std::uint64_t most_wrong_pixels = 0;                        // of a frame
  double device_milliseconds = 0.0, host_milliseconds = 0.0;  // timer queries; CPU time of the host's thread
};

struct section {
  std::uint64_t frames = 0, seen = 0, seen_in_set = 0;
  double allowed_pixels = 0.0;  // by the bounds of the cells
  std::array<mode_sums, mode_count> modes;

  // Wrong pixels of a mode beyond the bounds of the cells.
  double beyond_bound(draw_mode mode) const;
};

struct sections {
  section cuts, settled, walk, turns;  // turns: those frames of the walk alone
};

class measurement {
 public:
  // db, host: must outlive the object. Fails with gl.*, gpu-driven.*.
  measurement(const sightcell::db& db, const std::string& file, const sightcell::scene::scene& s,
              const host_scene& host, const renderer::settings& wanted, std::uint32_t leave_out);
  ~measurement();

  // Adds the frames of a tour to the sections.
  void run(std::span<const tour_frame> tour, sections& out);

  // Draws a view in one mode, three frames long, for picture().
  void draw(const camera& view, draw_mode mode);

  const renderer& draws() const { return renderer_; }

 private:
  struct timer {
    GLuint queries[2] = {};
    double host_milliseconds = 0.0;
  };

  void draw_frame(const tour_frame& frame, bool is_same_view);
  void draw_mode_timed(draw_mode mode, const camera& view);
  void collect(const tour_frame& frame, sections& out);
  visibility* visible_in(draw_mode mode);

  std::vector<float> bounds_;  // of the cells
  renderer renderer_;
  visibility for_pvs_, for_both_;
  comparison comparison_;
  std::array<timer, mode_count> timers_;
  std::uint32_t cell_ = SIGHTCELL_NO_CELL;
};

}  // namespace gpu_driven
