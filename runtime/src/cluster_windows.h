#pragma once
// The cluster of each stored polygon in two bytes, and the clusters of runs of them as one byte each, which is the
// fastest way to collect them: a byte is set without reading what others are, and 32 bytes become a word of the row
// once.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sightcell::runtime {

// Consecutive stored polygons whose clusters are near each other.
struct cluster_window {
  std::uint32_t end = 0;         // the stored polygon after the last
  std::uint32_t first_word = 0;  // of the row
  // Of the row, or 0: the polygons are too few for as many words, and each sets its bit in the row itself.
  std::uint32_t words = 0;
};

// The most clusters of a window.
inline constexpr std::uint32_t window_clusters = 16'384;
// In place of the cluster in a window: no cluster.
inline constexpr std::uint16_t no_window_cluster = window_clusters;

// Divides the polygons into windows. It is fed all of them in stored order: once to count the windows, once to fill
// them.
class window_builder {
 public:
  // out: elements for as many windows as another builder counted, or empty.
  explicit window_builder(std::span<cluster_window> out) noexcept : out_(out) {}

  // cluster: SIGHTCELL_NO_CLUSTER or one of the row.
  void add(std::uint32_t cluster) noexcept;
  // To be called after the last polygon.
  void finish() noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

 private:
  void close() noexcept;

  std::span<cluster_window> out_;
  std::uint64_t count_ = 0;
  std::uint32_t begin_ = 0, end_ = 0;                     // stored polygons of the open window
  std::uint32_t first_word_ = 0xFFFFFFFF, end_word_ = 0;  // of the row; empty: no polygon has a cluster
};

// Number of the cluster in its window, for a table of all stored polygons.
std::uint16_t cluster_in_window(const cluster_window& window, std::uint32_t cluster) noexcept;

// Collects the clusters of runs of ascending polygons, and sets their bits in a row.
class cluster_collector {
 public:
  // clusters: cluster_in_window() of all stored polygons. All spans must outlive this object.
  cluster_collector(std::span<const cluster_window> windows, std::span<const std::uint16_t> clusters,
                    std::span<std::uint32_t> row) noexcept
      : windows_(windows), clusters_(clusters.data()), row_(row) {
    if (!windows.empty()) open(0);
  }

  // Polygons first .. end - 1, none before those of the last call. Inline: a set has thousands of short runs.
  void add(std::uint32_t first, std::uint32_t end) noexcept {
    if (end > end_of_bytes_) return add_across(first, end);
    // Four at a time: a loop that compilers leave as it is takes longer.
    std::uint8_t* const present = present_.data();
    const std::uint16_t* next = clusters_ + first;
    std::uint32_t left = end - first;
    for (; left >= 4; left -= 4, next += 4) {
      present[next[0]] = 1;
      present[next[1]] = 1;
      present[next[2]] = 1;
      present[next[3]] = 1;
    }
    for (; left > 0; --left) present[*next++] = 1;
  }
  // Sets the bits of all polygons that were added.
  void finish() noexcept;

 private:
  void open(std::size_t window) noexcept;
  // As add(), with polygons of other windows, or of one without bytes.
  void add_across(std::uint32_t first, std::uint32_t end) noexcept;
  void set_bits(const cluster_window& window, std::uint32_t first, std::uint32_t end) noexcept;

  std::span<const cluster_window> windows_;
  const std::uint16_t* clusters_;
  std::span<std::uint32_t> row_;
  std::size_t at_ = 0;              // the open window
  std::uint32_t end_of_bytes_ = 0;  // its end, or 0 where its polygons set bits
  // One byte per cluster of the open window, and one for polygons without.
  std::array<std::uint8_t, window_clusters + 1> present_{};
};

}  // namespace sightcell::runtime
