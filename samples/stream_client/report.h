#pragma once
// What a run has measured. Seconds are of steady_clock, from the first request on; bytes are received bytes with
// headers.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace stream_client {

inline constexpr double not_reached = -1.0;

// When a share of the weight of the first cell was there: decoded, ready to draw.
struct level {
  double percent = 0.0;
  double seconds = not_reached;
  std::uint64_t bytes = 0, requests = 0;
};

struct failed_file {
  std::string name, cause;
};

struct report {
  std::uint64_t requests = 0;   // with those of the front
  std::uint64_t refetches = 0;  // requests of a file whose last transfer had failed
  std::uint64_t errors = 0;     // transfers that failed, and files with a wrong hash or broken contents
  std::uint64_t bytes = 0;      // of all transfers
  std::uint64_t fronts = 0;     // that were opened: more than one if the server got a new one
  bool http2 = false;

  double seconds = 0.0, front_seconds = 0.0;
  std::uint32_t first_cell = 0xFFFFFFFFu;  // number in the .pvs file
  double first_cell_weight = 0.0;          // steradians
  double first_cell_complete = not_reached;
  std::array<level, 4> levels{{{95.0}, {99.0}, {99.9}, {100.0}}};

  std::uint64_t cells_entered = 0;
  double pending_seconds = 0.0;  // time in cells that were not complete
  double longest_pending = 0.0;
  bool complete = false;  // at the end: nothing of the cell is missing or failed

  std::uint64_t peak_memory = 0, memory_limit = 0;
  std::uint64_t removed = 0;  // files, for the limit
  std::uint64_t unsupported_images = 0;
  std::uint64_t frames_drawn = 0, polygons_drawn = 0;  // polygons of the last picture

  std::vector<failed_file> failed;
  std::vector<std::string> present;  // names of files, at the end
};

}  // namespace stream_client
