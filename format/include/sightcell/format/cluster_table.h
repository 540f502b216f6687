#pragma once
// The clusters of a file whose sets are of clusters (SPEC.md, "Clusters"): each is some consecutive polygons in stored
// order. A set contains whole clusters, and its row has their numbers. The counterpart for writing is
// cluster_table_writer.h.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// The sizes of clusters, as the section has them: by order, because draws that share an order share its clusters.
class cluster_table {
 public:
  // A file without clusters.
  cluster_table() noexcept = default;

  // Opens the section. bytes: not copied. order_begins: polygons of all orders before each one; its last value is
  // order_begins[orders]. corrupt: sizes that contradict each other, the orders or the bytes. O(clusters of orders).
  static status open(std::span<const std::byte> bytes, const packed_column& order_begins, std::uint32_t orders,
                     cluster_table& out) noexcept;

  [[nodiscard]] bool exists() const noexcept { return exists_; }
  // Of all orders before this one; number: up to the number of orders.
  [[nodiscard]] std::uint32_t first_cluster(std::uint32_t order) const noexcept { return first_cluster_[order]; }
  // 0 for an order that does not exist.
  [[nodiscard]] std::uint32_t clusters_of(std::uint32_t order) const noexcept {
    return order < orders_ ? first_cluster_[order + 1] - first_cluster_[order] : 0;
  }
  // Polygons of a cluster, counted through all orders.
  [[nodiscard]] std::uint32_t polygons(std::uint32_t cluster) const noexcept { return polygons_[cluster]; }

 private:
  bool exists_ = false;
  std::uint32_t orders_ = 0;
  packed_column first_cluster_, polygons_;
};

// Where the clusters of a file begin, in memory, to convert rows. By range unit (a draw, or a draw group of the merged
// layout) and, in a unit, by its order.
class cluster_borders {
 public:
  cluster_borders() noexcept = default;

  // Numbers of memory that fill() needs.
  [[nodiscard]] static std::uint64_t room(std::uint32_t units, std::uint32_t orders,
                                          std::uint32_t clusters_of_orders) noexcept {
    return std::uint64_t{3} * units + 2 + orders + clusters_of_orders;
  }
  // Fills memory of room() numbers, which must outlive this object. order_of(unit): its order, below orders.
  // begin_of(unit): stored number of its first polygon. False if the sums contradict polygons or clusters, the numbers
  // in the whole file: the bytes changed.
  template <class OrderOf, class BeginOf>
  [[nodiscard]] bool fill(std::span<std::uint32_t> memory, const cluster_table& table, std::uint32_t units,
                          std::uint32_t orders, std::uint32_t polygons, std::uint32_t clusters, const OrderOf& order_of,
                          const BeginOf& begin_of) noexcept;

  [[nodiscard]] bool exist() const noexcept { return !unit_clusters_.empty(); }
  // Of all clusters, then the number of polygons: cluster is at most count().
  [[nodiscard]] std::uint32_t count() const noexcept { return unit_clusters_.back(); }
  [[nodiscard]] std::uint32_t unit_count() const noexcept {
    return static_cast<std::uint32_t>(unit_clusters_.size() - 1);
  }
  // The number of clusters of all units before this one; unit: up to unit_count().
  [[nodiscard]] std::uint32_t first_cluster(std::uint32_t unit) const noexcept { return unit_clusters_[unit]; }
  // Where the clusters of a unit begin, counted from its first polygon, then its number of polygons.
  [[nodiscard]] std::span<const std::uint32_t> begins_in(std::uint32_t unit) const noexcept {
    return begins_.subspan(unit_begins_of_[unit], unit_clusters_[unit + 1] - unit_clusters_[unit] + 1);
  }
  [[nodiscard]] std::uint32_t unit_begin(std::uint32_t unit) const noexcept { return unit_polygons_[unit]; }

  // Converts runs of clusters, and of numbers from count() on, to runs of polygons, and of numbers from the number of
  // polygons on. runs: ascending. O(runs + units).
  void expand(std::span<run> runs) const noexcept;

  // Calls emit(run of clusters) for each run of polygons. polygons: ascending runs of whole clusters, which are those
  // of all sets. O(runs * log clusters of a unit + units).
  template <class Emit>
  void for_each(std::span<const run> polygons, const Emit& emit) const noexcept {
    std::uint32_t unit = 0;
    const auto cluster_of = [&](std::uint32_t polygon) {
      while (unit + 1 < unit_count() && unit_polygons_[unit + 1] <= polygon) ++unit;
      const std::span<const std::uint32_t> begins = begins_in(unit);
      const auto found = std::lower_bound(begins.begin(), begins.end(), polygon - unit_polygons_[unit]);
      return unit_clusters_[unit] + static_cast<std::uint32_t>(found - begins.begin());
    };
    for (const run& r : polygons) {
      const std::uint32_t first = cluster_of(r.first);
      emit(run{first, cluster_of(r.first + r.count) - first});
    }
  }

 private:
  std::span<std::uint32_t> unit_clusters_;   // per unit: clusters before it; then their number
  std::span<std::uint32_t> unit_polygons_;   // per unit: polygons before it; then their number
  std::span<std::uint32_t> unit_begins_of_;  // per unit: where its order begins in begins_
  std::span<std::uint32_t> begins_;          // order after order
};

template <class OrderOf, class BeginOf>
bool cluster_borders::fill(std::span<std::uint32_t> memory, const cluster_table& table, std::uint32_t units,
                           std::uint32_t orders, std::uint32_t polygons, std::uint32_t clusters,
                           const OrderOf& order_of, const BeginOf& begin_of) noexcept {
  const auto take = [&](std::size_t size) {
    const std::span<std::uint32_t> part = memory.first(size);
    memory = memory.subspan(size);
    return part;
  };
  const std::span<std::uint32_t> unit_clusters = take(std::size_t{units} + 1);
  const std::span<std::uint32_t> unit_polygons = take(std::size_t{units} + 1);
  const std::span<std::uint32_t> unit_begins_of = take(units);
  std::size_t at = 0;
  for (std::uint32_t order = 0; order < orders; ++order) {
    const std::uint32_t first = table.first_cluster(order);
    const std::uint32_t own = table.clusters_of(order);
    if (first + order != at || own >= memory.size() - at) return false;
    std::uint32_t begin = 0;
    for (std::uint32_t i = 0; i < own; ++i) {
      memory[at++] = begin;
      begin += table.polygons(first + i);
    }
    memory[at++] = begin;
  }
  std::uint32_t before = 0;
  for (std::uint32_t unit = 0; unit < units; ++unit) {
    const std::uint32_t order = order_of(unit);
    const std::uint32_t begin = begin_of(unit);
    const std::uint32_t end = begin_of(unit + 1);
    if (order >= orders || begin > end || end > polygons) return false;
    const std::uint32_t own = table.clusters_of(order);
    const std::uint64_t begins_at = std::uint64_t{table.first_cluster(order)} + order;
    if (begins_at + own >= at || memory[static_cast<std::size_t>(begins_at) + own] != end - begin) return false;
    if (own > clusters - before) return false;
    unit_clusters[unit] = before;
    unit_polygons[unit] = begin;
    unit_begins_of[unit] = static_cast<std::uint32_t>(begins_at);
    before += own;
  }
  unit_clusters[units] = before;
  unit_polygons[units] = polygons;
  if (before != clusters) return false;
  unit_clusters_ = unit_clusters;
  unit_polygons_ = unit_polygons;
  unit_begins_of_ = unit_begins_of;
  begins_ = memory.first(at);
  return true;
}

}  // namespace sightcell::format
