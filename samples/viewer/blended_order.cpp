#include "blended_order.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <tuple>

namespace viewer {

blended_order::blended_order(const draw_groups& groups, std::span<const sightcell_draw> draws,
                             std::span<const glm::vec3> positions, std::span<const std::uint32_t> stored_indices)
    : groups_(groups) {
  for (std::uint32_t d = 0; d < draws.size(); ++d) {
    first_of_draw_.push_back(draws[d].first_stored);
    const std::uint32_t group = groups.group_of_draw(d);
    if (groups.groups()[group].alpha != sightcell::scene::alpha_mode::blend) continue;
    for (std::uint32_t i = 0; i < draws[d].polygon_count; ++i) {
      const std::uint32_t stored = draws[d].first_stored + i;
      const std::uint32_t* corners = stored_indices.data() + 3 * std::size_t{stored};
      polygons_.push_back(
          {stored, group, (positions[corners[0]] + positions[corners[1]] + positions[corners[2]]) / 3.0f});
    }
  }
  std::sort(polygons_.begin(), polygons_.end(), [](const polygon& a, const polygon& b) { return a.stored < b.stored; });
}

void blended_order::add(std::span<const list_part> parts, std::uint32_t list) {
  if (polygons_.empty()) return;
  for (const list_part& part : parts) {
    const std::uint32_t group = groups_.group_of_draw(part.range.draw);
    if (groups_.groups()[group].alpha != sightcell::scene::alpha_mode::blend) continue;
    const std::uint32_t begin = first_of_draw_[part.range.draw] + part.range.first;
    auto at = std::lower_bound(polygons_.begin(), polygons_.end(), begin,
                               [](const polygon& p, std::uint32_t stored) { return p.stored < stored; });
    for (; at != polygons_.end() && at->stored < begin + part.range.count; ++at) {
      chosen_.push_back({0.0f, static_cast<std::uint32_t>(at - polygons_.begin()), list});
    }
  }
}

const std::vector<blended_run>& blended_order::sorted(const glm::vec3& eye) {
  for (chosen& c : chosen_) {
    const glm::vec3 toward = polygons_[c.polygon].center - eye;
    c.distance = glm::dot(toward, toward);
  }
  std::sort(chosen_.begin(), chosen_.end(), [](const chosen& a, const chosen& b) {
    return std::tuple(-a.distance, a.polygon) < std::tuple(-b.distance, b.polygon);
  });
  runs_.clear();
  std::uint32_t end = 0;  // stored number behind the last polygon
  for (const chosen& c : chosen_) {
    const polygon& p = polygons_[c.polygon];
    if (runs_.empty() || runs_.back().group != p.group || runs_.back().list != c.list) {
      runs_.push_back({p.group, c.list, {}});
      end = 0;
    }
    group_stretches& s = runs_.back().stretches;
    if (!s.counts.empty() && p.stored == end) {
      s.counts.back() += 3;
    } else {
      s.counts.push_back(3);
      s.offsets.push_back(reinterpret_cast<const void*>(3 * sizeof(std::uint32_t) * std::uintptr_t{p.stored}));
    }
    end = p.stored + 1;
  }
  return runs_;
}

}  // namespace viewer
