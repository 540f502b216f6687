#include "visibility.h"

#include <algorithm>
#include <array>
#include <bit>

#include "sightcell/base/error.h"

namespace gpu_driven {
namespace {

void require_status(sightcell_status status, const std::string& file) {
  if (status == SIGHTCELL_OK) return;
  throw sightcell::error(sightcell::error_kind::bad_input, "gpu-driven.runtime", file, sightcell_status_text(status),
                         "bake the scene again");
}

void clear_each(std::span<std::uint32_t> row, std::uint32_t nth) {
  std::uint32_t visited = 0;
  for (std::uint32_t& word : row) {
    for (std::uint32_t left = word; left != 0; left &= left - 1) {
      if (++visited % nth == 0) word &= ~(1u << std::countr_zero(left));
    }
  }
}

}  // namespace

visibility::visibility(const sightcell::db& db, const std::string& file, const host_scene& host,
                       std::uint32_t leave_out)
    : clusters_(host.clusters),
      file_(file),
      leave_out_(leave_out),
      row_((host.clusters.size() + 31) / 32),
      group_visible_(host.level_groups.size()),
      bits_(row_.size() * sizeof(std::uint32_t), nullptr, GL_DYNAMIC_STORAGE_BIT) {
  auto view = sightcell::view::create(db);
  require_status(view.status(), file);
  view_ = std::move(*view);
  auto map =
      sightcell::cluster_map::create(db, host.cluster_of_source, static_cast<std::uint32_t>(host.clusters.size()));
  require_status(map.status(), file);
  map_ = std::move(*map);
}

// A coarse cluster is visible if any leaf below it is. Clusters follow those below them, so one pass is enough; the
// bits of coarse ones are 0 before it, because no polygon of the file is in them.
void visibility::add_coarse_clusters() {
  std::fill(group_visible_.begin(), group_visible_.end(), std::uint8_t{0});
  for (std::uint32_t c = 0; c < clusters_.size(); ++c) {
    const cluster_record& own = clusters_[c];
    std::uint32_t& word = row_[c >> 5];
    if (own.made_by != no_level_group && group_visible_[own.made_by] != 0) word |= 1u << (c & 31u);
    if (own.member_of != no_level_group && (word >> (c & 31u) & 1u) != 0) group_visible_[own.member_of] = 1;
  }
}

const sightcell_frame& visibility::move(const glm::vec3& eye) {
  // Fails for a NaN alone. The frame has DRAW_ALL then, and all bits are 1.
  static_cast<void>(view_.move(std::array<float, 3>{eye.x, eye.y, eye.z}, frame_));
  if ((frame_.flags & SIGHTCELL_FRAME_CHANGED) == 0) return frame_;
  require_status(view_.clusters(map_, row_), file_);
  if (!group_visible_.empty()) add_coarse_clusters();
  if (leave_out_ != 0) clear_each(row_, leave_out_);
  bits_.write(std::span<const std::uint32_t>(row_));  // 4 bytes for 32 clusters
  return frame_;
}

}  // namespace gpu_driven
