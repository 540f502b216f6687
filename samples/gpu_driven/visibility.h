#pragma once
// Where Sightcell is used: one view that follows the camera, and the row of cluster bits of its set on the device.
// Nothing here allocates after the constructor.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "gl_objects.h"
#include "host_scene.h"
#include "sightcell/sightcell.hpp"

namespace gpu_driven {

class visibility {
 public:
  // db: must outlive the object. file: its name, for messages.
  // host: must outlive the object.
  // leave_out: a fault for tests: the row lacks each n-th visible cluster; 0: none.
  // Throws gpu-driven.runtime.
  visibility(const sightcell::db& db, const std::string& file, const host_scene& host, std::uint32_t leave_out);

  // Every frame. Uploads the row if the set has changed.
  const sightcell_frame& move(const glm::vec3& eye);

  // A bit per cluster.
  const gl_buffer& bits() const { return bits_; }

 private:
  void add_coarse_clusters();

  std::span<const cluster_record> clusters_;
  std::string file_;
  std::uint32_t leave_out_ = 0;
  sightcell::view view_;
  sightcell::cluster_map map_;
  sightcell_frame frame_{};
  std::vector<std::uint32_t> row_;
  std::vector<std::uint8_t> group_visible_;  // by level group; empty without levels
  gl_buffer bits_;
};

}  // namespace gpu_driven
