#include "cluster_windows.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "sightcell/clusters.h"

namespace sightcell::runtime {
namespace {

constexpr std::uint32_t bits_per_word = 32, bytes_per_step = 8;
constexpr std::uint32_t window_words = window_clusters / bits_per_word;
constexpr std::uint32_t fewest_polygons_per_word = 16;  // on average, for a window whose words are worth testing

// Eight bytes of 0 or 1 become eight bits, the first byte the lowest: the product moves each to its place in the
// highest byte, and no two of its terms meet there.
std::uint32_t bits_of(const std::uint8_t* bytes) noexcept {
  constexpr std::uint64_t moves =
      std::endian::native == std::endian::little ? 0x0102040810204080u : 0x8040201008040201u;
  std::uint64_t eight = 0;
  std::memcpy(&eight, bytes, sizeof eight);
  return static_cast<std::uint32_t>(eight * moves >> 56);
}

bool any_of(const std::uint8_t* bytes) noexcept {
  std::array<std::uint64_t, bits_per_word / bytes_per_step> all;
  std::memcpy(all.data(), bytes, sizeof all);
  return (all[0] | all[1] | all[2] | all[3]) != 0;
}

}  // namespace

void window_builder::add(std::uint32_t cluster) noexcept {
  if (cluster != SIGHTCELL_NO_CLUSTER) {
    const std::uint32_t word = cluster / bits_per_word;
    if (std::max(end_word_, word + 1) - std::min(first_word_, word) > window_words) close();
    first_word_ = std::min(first_word_, word);
    end_word_ = std::max(end_word_, word + 1);
  }
  ++end_;
}

void window_builder::finish() noexcept {
  if (end_ > begin_) close();
}

void window_builder::close() noexcept {
  cluster_window made{.end = end_};
  if (first_word_ < end_word_) {
    made.first_word = first_word_;
    const std::uint32_t words = end_word_ - first_word_;
    if ((end_ - begin_) / fewest_polygons_per_word >= words) made.words = words;
  }
  if (!out_.empty()) out_[static_cast<std::size_t>(count_)] = made;
  ++count_;
  begin_ = end_;
  first_word_ = 0xFFFFFFFF, end_word_ = 0;
}

std::uint16_t cluster_in_window(const cluster_window& window, std::uint32_t cluster) noexcept {
  if (cluster == SIGHTCELL_NO_CLUSTER) return no_window_cluster;
  return static_cast<std::uint16_t>(cluster - window.first_word * bits_per_word);
}

void cluster_collector::open(std::size_t window) noexcept {
  at_ = window;
  end_of_bytes_ = windows_[window].words != 0 ? windows_[window].end : 0;
}

void cluster_collector::add_across(std::uint32_t first, std::uint32_t end) noexcept {
  while (first < end) {
    if (first >= windows_[at_].end) {
      finish();
      const auto after = [](std::uint32_t polygon, const cluster_window& w) { return polygon < w.end; };
      const auto later = windows_.begin() + static_cast<std::ptrdiff_t>(at_);
      open(static_cast<std::size_t>(std::upper_bound(later, windows_.end(), first, after) - windows_.begin()));
    }
    const cluster_window& window = windows_[at_];
    const std::uint32_t stop = std::min(end, window.end);
    if (window.words != 0)
      add(first, stop);
    else
      set_bits(window, first, stop);
    first = stop;
  }
}

void cluster_collector::set_bits(const cluster_window& window, std::uint32_t first, std::uint32_t end) noexcept {
  for (const std::uint16_t cluster : std::span(clusters_ + first, end - first)) {
    if (cluster == no_window_cluster) continue;
    row_[window.first_word + cluster / bits_per_word] |= 1u << cluster % bits_per_word;
  }
}

void cluster_collector::finish() noexcept {
  if (windows_.empty()) return;
  const cluster_window& window = windows_[at_];
  for (std::uint32_t word = 0; word < window.words; ++word) {
    std::uint8_t* bytes = present_.data() + std::size_t{word} * bits_per_word;
    if (!any_of(bytes)) continue;
    std::uint32_t bits = 0;
    for (std::uint32_t i = 0; i < bits_per_word; i += bytes_per_step) bits |= bits_of(bytes + i) << i;
    row_[window.first_word + word] |= bits;
    std::memset(bytes, 0, bits_per_word);
  }
}

}  // namespace sightcell::runtime
