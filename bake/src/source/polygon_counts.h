#pragma once
// Pixels per polygon, counted on the device, and the list of the polygons that have any. Filled by the see-through pass
// and by gather.comp, read back once per hemicube.
#include <cstdint>
#include <vector>

#include "sightcell/picture/gl_program.h"
#include "source/gpu_objects.h"
#include "source/hemicube_source.h"

namespace sightcell::bake {

class polygon_counts {
 public:
  // group_count: work groups of gather.comp, which leave four floats each in the result; 0 without them.
  // Throws sightcell::error when the device's storage buffers are too small for the scene.
  polygon_counts(std::uint32_t polygon_count, std::uint32_t group_count);

  void start();  // empties the list; counts are 0
  void bind() const;
  // Finishes the list on the device and reads it, in any order, with the work groups' sums. The block of uniforms
  // hemicube_gather must be bound.
  void collect(std::vector<seen_polygon>& found, std::vector<float>& group_sums);

 private:
  std::uint32_t group_count_;
  gl_buffer counts_, found_, result_;
  picture::gl_program collect_program_;
  std::vector<std::uint32_t> words_;  // as read back
  std::uint32_t expected_ = 1024;     // polygons to read at once: about what the last hemicube saw
};

}  // namespace sightcell::bake
