#pragma once
// Where Sightcell is used: one view that follows the camera, and its set in two forms. Nothing here allocates after the
// constructor.
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightcell/sightcell.hpp"

namespace vulkan_host {

class visibility {
 public:
  // db: must outlive the object. file: its name, for messages.
  // cluster_of_source, cluster_count: the host's clusters, for write_bits.
  // min_gap: of sightcell_view_commands.
  visibility(const sightcell::db& db, const std::string& file, std::span<const std::uint32_t> cluster_of_source,
             std::uint32_t cluster_count, std::uint32_t min_gap);

  // Every frame.
  const sightcell_frame& move(const std::array<float, 3>& eye);

  // Number of the set. Buffers that were filled at another revision have to be filled again: with two frames in
  // flight, a buffer may be two changes behind, so SIGHTCELL_FRAME_CHANGED alone does not tell.
  std::uint32_t revision() const { return frame_.revision; }

  std::uint32_t most_commands() const { return most_commands_; }
  std::uint32_t words() const { return static_cast<std::uint32_t>(row_.size()); }

  // Writes the commands from front to back, without reading: mapped memory of the device is fine.
  // mapped: most_commands() or more. Returns their number.
  std::uint32_t write_commands(std::span<sightcell_command> mapped) const;

  // Copies the row of bits. mapped: words().
  void write_bits(std::span<std::uint32_t> mapped);

  // A fault for tests: rows lack each n-th visible cluster. 0: none.
  void leave_out(std::uint32_t nth) { left_out_ = nth; }

 private:
  std::string file_;
  std::uint32_t min_gap_, most_commands_ = 0, left_out_ = 0;
  std::uint32_t row_revision_ = 0;  // of row_
  sightcell::view view_;
  sightcell::cluster_map map_;
  sightcell_frame frame_{};
  std::vector<std::uint32_t> row_;
};

}  // namespace vulkan_host
