#include "order/cluster_order.h"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "order/stored_draws.h"
#include "sightcell/base/error.h"
#include "sightcell/format/layout.h"
#include "sightcell/scene/clusters.h"

namespace sightcell::bake {
namespace {

std::vector<format::draw_record> by_source(std::vector<format::draw_record> draws) {
  const auto place = [](const format::draw_record& d) { return std::tuple(d.first_source, d.polygon_count > 0); };
  std::stable_sort(draws.begin(), draws.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return draws;
}

// The clusters of one draw, as a host knows them: the polygons of each, in source order from the first of the draw.
using draw_clusters = std::vector<std::vector<std::uint32_t>>;

draw_clusters members_of(const format::draw_record& d, const cluster_numbers& clusters, std::uint32_t first) {
  draw_clusters members;
  for (std::uint32_t t = 0; t < d.polygon_count; ++t) {
    const std::size_t number = clusters[d.first_source + t] - first;
    if (number >= members.size()) members.resize(number + 1);
    members[number].push_back(t);
  }
  return members;
}

// The draws of a file with clusters in place of polygons.
class clustered_draws {
 public:
  clustered_draws(std::vector<format::draw_record> draws, const cluster_numbers& clusters)
      : originals_(by_source(std::move(draws))) {
    std::uint32_t first = 0;
    for (std::uint32_t number = 0; number < originals_.size(); ++number) {
      const format::draw_record& d = originals_[number];
      members_.push_back(members_of(d, clusters, first));
      format::draw_record& made = draws_.emplace_back(d);
      made.host_tag = number;
      made.mesh = unit_of(number);
      made.primitive = 0;
      made.first_source = first;
      made.polygon_count = static_cast<std::uint32_t>(members_.back().size());
      first += made.polygon_count;
    }
    count_ = first;
  }

  [[nodiscard]] std::span<const format::draw_record> draws() const { return draws_; }
  [[nodiscard]] std::uint32_t count() const { return count_; }

  // Puts polygons back in place of clusters.
  void expand(const stored_draws& stored, format::file_parts& parts) const {
    parts.draws.clear();
    parts.order_of_draw = stored.order_of_draw;
    parts.orders.assign(stored.orders.size(), {});
    parts.clusters.assign(stored.orders.size(), {});
    std::uint32_t next = 0;
    for (const format::draw_record& made : stored.draws) {
      format::draw_record& d = parts.draws.emplace_back(originals_[made.host_tag]);
      d.group = made.group;
      d.first_stored = next;
      next += d.polygon_count;
    }
    const bool merged = parts.facts.layout == format::host_layout::merged;
    for (std::size_t begin = 0, end = 0; begin < stored.draws.size(); begin = end) {
      const std::uint32_t number = stored.order_of_draw[begin];
      for (end = begin + 1; merged && end < stored.draws.size() && stored.order_of_draw[end] == number;) ++end;
      if (!parts.orders[number].empty()) continue;
      const draw_clusters all = members_of_unit(std::span(stored.draws).subspan(begin, end - begin));
      for (const std::uint32_t cluster : stored.orders[number]) {
        parts.orders[number].insert(parts.orders[number].end(), all[cluster].begin(), all[cluster].end());
        parts.clusters[number].push_back(static_cast<std::uint32_t>(all[cluster].size()));
      }
    }
  }

 private:
  // A number for draws that may share an order. Draws of a mesh whose clusters differ share none.
  std::uint32_t unit_of(std::uint32_t number) {
    const format::draw_record& d = originals_[number];
    const auto [found, fresh] = units_.try_emplace({d.mesh, d.primitive, d.polygon_count}, number);
    return fresh || members_[found->second] == members_[number] ? found->second : number;
  }

  // The clusters of the draws of an order, one draw after the other.
  [[nodiscard]] draw_clusters members_of_unit(std::span<const format::draw_record> draws) const {
    draw_clusters all;
    std::uint32_t before = 0;
    for (const format::draw_record& made : draws) {
      for (std::vector<std::uint32_t> polygons : members_[made.host_tag]) {
        for (std::uint32_t& polygon : polygons) polygon += before;
        all.push_back(std::move(polygons));
      }
      before += originals_[made.host_tag].polygon_count;
    }
    return all;
  }

  std::vector<format::draw_record> originals_, draws_;  // in source order
  std::vector<draw_clusters> members_;                  // by draw
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> units_;
  std::uint32_t count_ = 0;
};

}  // namespace

cluster_numbers clusters_of_scene(const scene::scene& s) {
  std::map<std::uint32_t, scene::mesh_clusters> of_geometry;
  // Draws of one primitive have the clusters of the first, also where they are posed in another way.
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> first_geometry;
  cluster_numbers numbers;
  numbers.reserve(s.polygon_count);
  std::uint32_t before = 0;
  for (const scene::draw& d : s.draws) {
    const std::tuple key(d.mesh, d.primitive, d.polygon_count);
    const std::uint32_t geometry = first_geometry.try_emplace(key, d.geometry).first->second;
    const auto [found, fresh] = of_geometry.try_emplace(geometry);
    scene::mesh_clusters& own = found->second;
    if (fresh) {
      own = scene::clusters_of(s.geometries[geometry]);
      std::vector<std::uint32_t> sizes(own.count);
      for (const std::uint32_t cluster : own.of_triangle) ++sizes[cluster];
      if (std::any_of(sizes.begin(), sizes.end(), [](auto n) { return n > format::layout::max_cluster_polygons; }))
        throw error(error_kind::bad_input, "scene.bad-field", s.name,
                    "meshes[" + std::to_string(d.mesh) + "] has a cluster of more than 256 triangles",
                    "divide it, or leave out the clusters");
    }
    for (const std::uint32_t cluster : own.of_triangle) numbers.push_back(before + cluster);
    before += own.count;
  }
  return numbers;
}

cluster_numbers clusters_of_file(const format::file_parts& parts) {
  // The cluster of each polygon in its draw or draw group, then numbers in source order.
  std::vector<std::uint64_t> stored_cluster(parts.facts.polygon_count);
  std::uint64_t count = 0;
  const bool merged = parts.facts.layout == format::host_layout::merged;
  for (std::size_t begin = 0, end = 0; begin < parts.draws.size(); begin = end) {
    const std::uint32_t number = parts.order_of_draw[begin];
    std::vector<std::uint32_t> sources;
    for (end = begin; end < parts.draws.size() && (end == begin || (merged && parts.order_of_draw[end] == number));
         ++end) {
      const format::draw_record& d = parts.draws[end];
      for (std::uint32_t t = 0; t < d.polygon_count; ++t) sources.push_back(d.first_source + t);
    }
    std::size_t at = 0;
    for (const std::uint32_t polygons : parts.clusters[number]) {
      for (std::uint32_t i = 0; i < polygons; ++i) stored_cluster[sources[parts.orders[number][at++]]] = count;
      ++count;
    }
  }
  cluster_numbers numbers(parts.facts.polygon_count);
  std::uint32_t next = 0;
  for (const format::draw_record& d : by_source(parts.draws)) {
    std::map<std::uint64_t, std::uint32_t> own;  // in the order of first polygons
    for (std::uint32_t t = 0; t < d.polygon_count; ++t) {
      const auto [found, fresh] = own.try_emplace(stored_cluster[d.first_source + t], next);
      if (fresh) ++next;
      numbers[d.first_source + t] = found->second;
    }
  }
  return numbers;
}

void order_clusters_of(format::file_parts& parts, polygon_order_kind kind, const cluster_numbers& clusters,
                       const set_source& set_of) {
  const clustered_draws made(parts.draws, clusters);
  const auto cells = static_cast<std::uint32_t>(parts.cells.size());
  const auto clusters_in = [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
    std::vector<std::uint32_t> polygons;
    set_of(cell, polygons);
    std::vector<bool> seen(made.count());
    for (const std::uint32_t polygon : polygons) {
      const std::uint32_t cluster = clusters[polygon];
      if (seen[cluster]) continue;
      seen[cluster] = true;
      set.push_back(cluster);
    }
    std::sort(set.begin(), set.end());
  };
  const stored_draws stored = store_draws(made.draws(), parts.facts.layout, kind, cells, clusters_in);
  made.expand(stored, parts);
}

}  // namespace sightcell::bake
