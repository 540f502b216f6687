#pragma once
// Pixels per polygon, counted on the device, and the list of the polygons that have any. Filled by the see-through pass
// and by gather.comp, read back once per hemicube: several hemicubes can be on their way.
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hemicube/gpu/gpu_objects.h"
#include "hemicube/hemicube_source.h"
#include "sightcell/picture/gl_program.h"

namespace sightcell::bake {

class polygon_counts {
 public:
  // group_count: work groups of gather.comp; 0 without them. most_seen: no hemicube sees more polygons. slots:
  // hemicubes on their way at most. Throws sightcell::error when the device's storage buffers are too small.
  polygon_counts(std::uint32_t polygon_count, std::uint32_t group_count, std::uint32_t most_seen = 0xFFFFFFFFu,
                 std::uint32_t slots = 1);
  ~polygon_counts();

  void start();  // empties the list; counts are 0
  void bind() const;
  // Finishes the list on the device and sends it on its way. The block of uniforms hemicube_gather must be bound.
  void send(std::uint32_t slot);
  // Waits for what was sent: the list in any order, and the four sums of importance. Throws sightcell::error when the
  // device does not answer.
  void receive(std::uint32_t slot, std::vector<seen_polygon>& found, std::array<float, 4>& sums);
  // Both at once.
  void collect(std::vector<seen_polygon>& found, std::vector<float>& sums);
  std::uint32_t slots() const { return static_cast<std::uint32_t>(slots_.size()); }

 private:
  struct slot;
  std::uint32_t most_seen_;
  gl_buffer counts_, found_, sums_;
  picture::gl_program collect_program_;
  std::vector<std::unique_ptr<slot>> slots_;
};

}  // namespace sightcell::bake
