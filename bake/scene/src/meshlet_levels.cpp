#include "meshlet_levels.h"

#include <algorithm>
#include <map>
#include <utility>

#include "meshlet_bytes.h"

namespace sightcell::scene {
namespace {

constexpr std::uint32_t levels_header_bytes = 32, range_bytes = 16, group_record_bytes = 32, link_bytes = 8;

}  // namespace

meshlet_levels::meshlet_levels(std::span<const meshlet_group> groups, const scene& packed,
                               const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, const draw*> draws;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> simplified;  // of all draws of a primitive
  for (const draw& d : packed.draws) {
    draws.try_emplace({d.mesh, d.primitive}, &d);
    bool& of_all = simplified.try_emplace({d.mesh, d.primitive}, true).first->second;
    of_all = of_all && may_have_levels(packed, d);
  }
  std::uint64_t total = 0, done = 0;
  for (const meshlet_group& group : groups)
    total += packed.geometries[draws.at({group.mesh, group.primitive})->geometry].indices.size() / 3;
  for (const meshlet_group& group : groups) {
    const draw& d = *draws.at({group.mesh, group.primitive});
    primitive_levels& made = all_.emplace_back();
    made.mesh = &packed.geometries[d.geometry];
    made.sided = d.material != no_index && packed.materials[d.material].double_sided;
    made.dag = build_cluster_dag(*made.mesh, !group.deforms && simplified.at({group.mesh, group.primitive}));
    made.first_leaf = leaves_;
    made.first_coarse = coarse_;
    made.first_group = groups_;
    leaves_ += made.dag.leaf_count;
    coarse_ += static_cast<std::uint32_t>(made.dag.clusters.size()) - made.dag.leaf_count;
    groups_ += static_cast<std::uint32_t>(made.dag.groups.size());
    indices_ += static_cast<std::uint32_t>(made.dag.indices.size() - made.mesh->indices.size());
    done += made.mesh->indices.size() / 3;
    if (progress) progress(done, total);
  }
}

std::uint64_t meshlet_levels::bytes() const {
  return levels_header_bytes + std::uint64_t{range_bytes} * all_.size() +
         std::uint64_t{meshlet_record_bytes} * coarse_ + std::uint64_t{group_record_bytes} * groups_ +
         std::uint64_t{link_bytes} * (leaves_ + coarse_) + std::uint64_t{4} * indices_;
}

std::uint32_t meshlet_levels::number_of(const primitive_levels& p, std::uint32_t cluster) const {
  return cluster < p.dag.leaf_count ? p.first_leaf + cluster : leaves_ + p.first_coarse + cluster - p.dag.leaf_count;
}

void meshlet_levels::write(std::span<std::byte> into) const {
  byte_writer out(into);
  for (const std::uint32_t value :
       {coarse_, groups_, indices_, meshlet_record_bytes, group_record_bytes, link_bytes, 0u, 0u})
    out.put(value);
  for (const primitive_levels& p : all_) {
    out.put(leaves_ + p.first_coarse);
    out.put(static_cast<std::uint32_t>(p.dag.clusters.size()) - p.dag.leaf_count);
    out.put(p.first_group);
    out.put(static_cast<std::uint32_t>(p.dag.groups.size()));
  }
  std::uint32_t index = 0;
  for (std::uint32_t number = 0; number < all_.size(); ++number) {
    const primitive_levels& p = all_[number];
    for (std::size_t c = p.dag.leaf_count; c < p.dag.clusters.size(); ++c) {
      const dag_cluster& cluster = p.dag.clusters[c];
      const auto corners =
          std::span(p.dag.indices)
              .subspan(std::size_t{3} * cluster.first_triangle, std::size_t{3} * cluster.triangle_count);
      put_meshlet(out, {number, index}, *p.mesh, corners, true, !p.sided);
      index += 3 * cluster.triangle_count;
    }
  }
  for (const primitive_levels& p : all_)
    for (const dag_group& group : p.dag.groups) {
      out.put(number_of(p, group.first_cluster));
      out.put(group.cluster_count);
      out.put(group.level);
      out.put(group.error);
      const float center[3] = {group.bounds.center.x, group.bounds.center.y, group.bounds.center.z};
      out.put(center);
      out.put(group.bounds.radius);
    }
  const auto put_links = [&](bool coarse) {
    for (const primitive_levels& p : all_) {
      const auto placed = [&](std::uint32_t group) { return group == no_index ? no_index : p.first_group + group; };
      const std::size_t first = coarse ? p.dag.leaf_count : 0;
      const std::size_t end = coarse ? p.dag.clusters.size() : p.dag.leaf_count;
      for (std::size_t c = first; c < end; ++c) {
        out.put(placed(p.dag.clusters[c].made_by));
        out.put(placed(p.dag.clusters[c].group));
      }
    }
  };
  put_links(false);
  put_links(true);
  for (const primitive_levels& p : all_)
    for (std::size_t i = p.mesh->indices.size(); i < p.dag.indices.size(); ++i) out.put(p.dag.indices[i]);
}

}  // namespace sightcell::scene
