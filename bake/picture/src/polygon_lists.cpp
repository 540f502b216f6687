#include "polygon_lists.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "sightcell/base/error.h"

namespace sightcell::picture {
namespace {

auto order_of(const draw_group& g) {
  return std::tuple(g.alpha, g.double_sided, g.material);
}

bool less(const draw_group& a, const draw_group& b) {
  return order_of(a) < order_of(b);
}

}  // namespace

polygon_lists::polygon_lists(const scene::scene& s, const scene::world_geometry& geometry) : geometry_(geometry) {
  // The kind comes from the flattened polygons and not from the material, because a host may have changed sidedness
  // there.
  const auto group_of = [&](const scene::draw& d, std::uint32_t id) {
    const scene::polygon_kind kind = geometry.kinds[id];
    return draw_group{kind.alpha, kind.double_sided, d.material};
  };
  const auto for_each_polygon = [&](const auto& visit) {
    for (const scene::draw& d : s.draws) {
      for (std::uint32_t id = d.first_source; id < d.first_source + d.polygon_count; ++id) {
        if (!geometry.kinds[id].absent) visit(d, id);
      }
    }
  };
  for_each_polygon([&](const scene::draw& d, std::uint32_t id) {
    const draw_group g = group_of(d, id);
    if (groups_.empty() || order_of(groups_.back()) != order_of(g)) groups_.push_back(g);
  });
  std::sort(groups_.begin(), groups_.end(), less);
  const auto same = [](const draw_group& a, const draw_group& b) { return order_of(a) == order_of(b); };
  groups_.erase(std::unique(groups_.begin(), groups_.end(), same), groups_.end());

  group_of_.assign(geometry.kinds.size(), scene::no_index);
  std::uint32_t last = 0;  // neighbors mostly share their group
  for_each_polygon([&](const scene::draw& d, std::uint32_t id) {
    const draw_group g = group_of(d, id);
    if (!same(groups_[last], g)) {
      last = static_cast<std::uint32_t>(std::lower_bound(groups_.begin(), groups_.end(), g, less) - groups_.begin());
    }
    group_of_[id] = last;
  });
}

void polygon_lists::gather(std::optional<std::span<const std::uint32_t>> source_ids,
                           std::vector<std::uint32_t>& indices, std::vector<index_range>& ranges) const {
  const std::size_t listed = source_ids ? source_ids->size() : group_of_.size();
  const auto id_at = [&](std::size_t i) { return source_ids ? (*source_ids)[i] : static_cast<std::uint32_t>(i); };

  std::vector<std::uint32_t> counts(groups_.size(), 0);
  for (std::size_t i = 0; i < listed; ++i) {
    const std::uint32_t id = id_at(i);
    if (id >= group_of_.size()) {
      throw error(error_kind::wrong_use, "picture.no-such-polygon", "polygon " + std::to_string(id),
                  "the scene has only " + std::to_string(group_of_.size()), "draw polygons of this scene");
    }
    if (group_of_[id] != scene::no_index) counts[group_of_[id]] += 3;
  }
  ranges.clear();
  std::vector<std::uint32_t> next(groups_.size(), 0);
  std::uint32_t total = 0;
  for (std::uint32_t g = 0; g < groups_.size(); ++g) {
    next[g] = total;
    if (counts[g] > 0) ranges.push_back({g, total, counts[g]});
    total += counts[g];
  }
  indices.resize(total);
  for (std::size_t i = 0; i < listed; ++i) {
    const std::uint32_t id = id_at(i);
    if (group_of_[id] == scene::no_index) continue;
    std::uint32_t& at = next[group_of_[id]];
    for (std::size_t k = 0; k < 3; ++k) indices[at++] = geometry_.indices[3 * std::size_t{id} + k];
  }
}

}  // namespace sightcell::picture
