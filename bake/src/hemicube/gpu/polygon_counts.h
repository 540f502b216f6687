#pragma once
// Pixels per polygon, counted on the device, and the list of the polygons that have any. The see-through pass and
// gather.comp count. The list is read back once per hemicube; several hemicubes can be in flight.
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
  // group_count: number of work groups of gather.comp; 0 where it does not run. most_seen: maximum number of polygons
  // in a list. slots: maximum number of hemicubes in flight. Throws sightcell::error where the device's storage buffers
  // are too small.
  polygon_counts(std::uint32_t polygon_count, std::uint32_t group_count, std::uint32_t most_seen = 0xFFFFFFFFu,
                 std::uint32_t slots = 1);
  ~polygon_counts();

  void bind() const;
  // Finishes the list on the device and starts its transfer. The uniform block hemicube_gather must be bound.
  void send(std::uint32_t slot);
  // The two halves of send().
  void list(std::uint32_t slot);
  void mark_end(std::uint32_t slot);
  // Waits for the list, which is in any order, and for the four importance sums. Throws sightcell::error when the
  // device does not respond.
  void receive(std::uint32_t slot, std::vector<seen_polygon>& found, std::array<float, 4>& sums);
  // send() and receive().
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
