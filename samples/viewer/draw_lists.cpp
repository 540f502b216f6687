#include "draw_lists.h"

#include <algorithm>
#include <tuple>

namespace viewer {

namespace scene = sightcell::scene;

draw_groups::draw_groups(const scene::scene& s, std::span<const sightcell_draw> draws) {
  const auto group_of = [&](const sightcell_draw& d) {
    if (d.material >= s.materials.size()) {
      const scene::material none;
      return draw_group{none.alpha, none.double_sided, static_cast<std::uint32_t>(s.materials.size())};
    }
    const scene::material& m = s.materials[d.material];
    return draw_group{m.alpha, m.double_sided, d.material};
  };
  const auto key = [](const draw_group& g) { return std::tuple(g.alpha, g.double_sided, g.material); };
  const auto before = [&](const draw_group& a, const draw_group& b) { return key(a) < key(b); };
  for (const sightcell_draw& d : draws) groups_.push_back(group_of(d));
  std::sort(groups_.begin(), groups_.end(), before);
  groups_.erase(
      std::unique(groups_.begin(), groups_.end(), [&](const auto& a, const auto& b) { return key(a) == key(b); }),
      groups_.end());
  for (const sightcell_draw& d : draws) {
    const auto at = std::lower_bound(groups_.begin(), groups_.end(), group_of(d), before);
    group_of_draw_.push_back(static_cast<std::uint32_t>(at - groups_.begin()));
  }
}

std::vector<list_part> parts_of(std::span<const sightcell_range> ranges) {
  std::vector<list_part> parts;
  parts.reserve(ranges.size());
  std::uint64_t at = 0;
  for (const sightcell_range& range : ranges) {
    parts.push_back({range, at});
    at += range.count;
  }
  return parts;
}

void make_stretches(const draw_groups& groups, std::span<const list_part> parts, std::vector<group_stretches>& out) {
  out.resize(groups.groups().size());
  for (group_stretches& g : out) {
    g.counts.clear();
    g.offsets.clear();
  }
  std::uint64_t end_of_last = 0;  // in polygons
  std::uint32_t last_group = scene::no_index;
  for (const list_part& part : parts) {
    const std::uint32_t group = groups.group_of_draw(part.range.draw);
    group_stretches& g = out[group];
    const auto indices = static_cast<std::int32_t>(3 * part.range.count);
    if (group == last_group && part.at == end_of_last) {
      g.counts.back() += indices;  // goes on where the last one ended
    } else {
      g.counts.push_back(indices);
      g.offsets.push_back(reinterpret_cast<const void*>(std::uintptr_t{3 * sizeof(std::uint32_t) * part.at}));
    }
    last_group = group;
    end_of_last = part.at + part.range.count;
  }
}

std::vector<sightcell_range> whole_draws(std::span<const sightcell_draw> draws,
                                         std::span<const sightcell_range> ranges) {
  std::vector<sightcell_range> out;
  for (const sightcell_range& range : ranges) {
    if (out.empty() || out.back().draw != range.draw) out.push_back({range.draw, 0, draws[range.draw].polygon_count});
  }
  return out;
}

std::vector<sightcell_range> complement(std::span<const sightcell_draw> draws,
                                        std::span<const sightcell_range> ranges) {
  std::vector<sightcell_range> out;
  std::size_t next = 0;
  for (std::uint32_t d = 0; d < draws.size(); ++d) {
    std::uint32_t at = 0;
    for (; next < ranges.size() && ranges[next].draw == d; ++next) {
      if (ranges[next].first > at) out.push_back({d, at, ranges[next].first - at});
      at = ranges[next].first + ranges[next].count;
    }
    if (draws[d].polygon_count > at) out.push_back({d, at, draws[d].polygon_count - at});
  }
  return out;
}

void gather_indices(std::span<const sightcell_draw> draws, std::span<const sightcell_range> ranges,
                    std::span<const std::uint32_t> stored_indices, std::vector<std::uint32_t>& out) {
  out.clear();
  out.reserve(3 * polygons_in(ranges));
  for (const sightcell_range& range : ranges) {
    const auto from = stored_indices.begin() + 3 * (std::ptrdiff_t{draws[range.draw].first_stored} + range.first);
    out.insert(out.end(), from, from + 3 * std::ptrdiff_t{range.count});
  }
}

std::uint64_t polygons_in(std::span<const sightcell_range> ranges) {
  std::uint64_t sum = 0;
  for (const sightcell_range& range : ranges) sum += range.count;
  return sum;
}

std::uint64_t polygons_in(std::span<const list_part> parts) {
  std::uint64_t sum = 0;
  for (const list_part& part : parts) sum += part.range.count;
  return sum;
}

}  // namespace viewer
