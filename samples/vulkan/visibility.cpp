#include "visibility.h"

#include <algorithm>
#include <bit>

#include "sightcell/base/error.h"

namespace vulkan_host {
namespace {

void require_status(sightcell_status status, const std::string& file) {
  if (status == SIGHTCELL_OK) return;
  throw sightcell::error(sightcell::error_kind::bad_input, "vulkan.runtime", file, sightcell_status_text(status),
                         "bake the scene again");
}

void clear_each(std::span<std::uint32_t> row, std::uint32_t nth) {
  std::uint32_t seen = 0;
  for (std::uint32_t& word : row) {
    for (std::uint32_t left = word; left != 0; left &= left - 1) {
      if (++seen % nth == 0) word &= ~(1u << std::countr_zero(left));
    }
  }
}

}  // namespace

visibility::visibility(const sightcell::db& db, const std::string& file,
                       std::span<const std::uint32_t> cluster_of_source, std::uint32_t cluster_count,
                       std::uint32_t min_gap)
    : file_(file), min_gap_(min_gap), row_((cluster_count + 31) / 32) {
  const auto info = db.info();
  require_status(info.status(), file);
  most_commands_ = info->range_bound;
  auto view = sightcell::view::create(db);
  require_status(view.status(), file);
  view_ = std::move(*view);
  auto map = sightcell::cluster_map::create(db, cluster_of_source, cluster_count);
  require_status(map.status(), file);
  map_ = std::move(*map);
}

const sightcell_frame& visibility::move(const std::array<float, 3>& eye) {
  // Fails for a NaN alone. The frame has DRAW_ALL then, and all outputs return everything.
  static_cast<void>(view_.move(eye, frame_));
  return frame_;
}

std::uint32_t visibility::write_commands(std::span<sightcell_command> mapped) const {
  const sightcell::list_result got = view_.commands(min_gap_, mapped);
  require_status(got.status, file_);
  return static_cast<std::uint32_t>(got.count);
}

void visibility::write_bits(std::span<std::uint32_t> mapped) {
  if (row_revision_ != frame_.revision) {
    // Bits are set word by word and read again, which mapped memory of the device is bad at.
    require_status(view_.clusters(map_, row_), file_);
    if (left_out_ != 0) clear_each(row_, left_out_);
    row_revision_ = frame_.revision;
  }
  std::copy(row_.begin(), row_.end(), mapped.begin());
}

}  // namespace vulkan_host
