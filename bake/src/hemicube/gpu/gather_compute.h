#pragma once
// Counts pixels and sums importance in compute shaders; several hemicubes can be in flight.
#include "hemicube/gpu/gpu_gather.h"
#include "hemicube/gpu/gpu_timeline.h"
#include "sightcell/picture/gl_program.h"

namespace sightcell::bake {

// Work groups of gather.comp for a resolution.
std::array<std::uint32_t, 2> gather_compute_groups(std::uint32_t resolution);

class gather_compute final : public gpu_gather {
 public:
  // counted: made with the number of groups of gather_compute_groups(). timeline: null, or where the stages are
  // recorded.
  explicit gather_compute(polygon_counts& counted, gpu_timeline* timeline = nullptr);

  void run(const hemicube_atlas& atlas, std::span<const face_view, face_count> faces, hemicube_view& view,
           sample_split* spent = nullptr) override;
  // The two halves of run(). The atlas may be drawn again between them.
  void send(const hemicube_atlas& atlas, std::uint32_t slot);
  void receive(std::uint32_t slot, hemicube_view& view);

 private:
  polygon_counts& counted_;
  gpu_timeline* timeline_;
  picture::gl_program program_;
};

}  // namespace sightcell::bake
