#include "trace/duplicates.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <xxhash.h>

#include <algorithm>
#include <compare>
#include <numeric>

#include "sightcell/bake/inspect.h"
#include "sightcell/scene/polygon_corners.h"

namespace sightcell::bake {
namespace {

// The properties that all polygons of a group share.
struct group_key {
  scene::polygon_corners place;
  std::uint32_t kind = 0;

  auto operator<=>(const group_key&) const = default;
};
static_assert(sizeof(group_key) == 40, "hashed as it lies in memory");

// Groups of at least two polygons, one after the other. Polygons ascend inside a group; groups are sorted by their
// first polygon.
struct polygon_groups {
  std::vector<std::uint32_t> members, begins{0};
};

// Hashes are at least 1, because 0 marks absent polygons.
std::uint64_t hash_of(const group_key& key) {
  return std::max<std::uint64_t>(XXH3_64bits(&key, sizeof key), 1);
}

// Returns the hashes that more than one polygon has, ascending. If there are none, the caller needs no second pass over
// the polygons.
template <typename KeyOf>
std::vector<std::uint64_t> repeated_hashes(const scene::world_geometry& geometry, const KeyOf& key_of) {
  std::vector<std::uint64_t> hashes(geometry.kinds.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, hashes.size()), [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p)
      if (!geometry.kinds[p].absent) hashes[p] = hash_of(key_of(static_cast<std::uint32_t>(p)));
  });
  tbb::parallel_sort(hashes.begin(), hashes.end());
  std::vector<std::uint64_t> repeated;
  for (std::size_t i = 1; i < hashes.size(); ++i) {
    const std::uint64_t hash = hashes[i];
    if (hash != 0 && hash == hashes[i - 1] && (repeated.empty() || repeated.back() != hash)) repeated.push_back(hash);
  }
  return repeated;
}

struct candidate {
  std::uint64_t hash = 0;
  std::uint32_t polygon = 0;
  auto operator<=>(const candidate&) const = default;
};

template <typename KeyOf>
polygon_groups groups_by(const scene::world_geometry& geometry, const KeyOf& key_of) {
  const std::vector<std::uint64_t> repeated = repeated_hashes(geometry, key_of);
  std::vector<candidate> candidates;
  if (!repeated.empty()) {
    for (std::uint32_t p = 0; p < geometry.kinds.size(); ++p) {
      if (geometry.kinds[p].absent) continue;
      const std::uint64_t hash = hash_of(key_of(p));
      if (std::binary_search(repeated.begin(), repeated.end(), hash)) candidates.push_back({hash, p});
    }
  }
  // Different keys can share a hash, so the keys are compared inside equal hashes.
  std::sort(candidates.begin(), candidates.end(), [&](const candidate& a, const candidate& b) {
    if (a.hash != b.hash) return a.hash < b.hash;
    const auto order = key_of(a.polygon) <=> key_of(b.polygon);
    return order != 0 ? order < 0 : a.polygon < b.polygon;
  });
  std::vector<std::span<const candidate>> found;
  for (std::size_t i = 0; i < candidates.size();) {
    std::size_t end = i + 1;
    while (end < candidates.size() && candidates[end].hash == candidates[i].hash &&
           key_of(candidates[end].polygon) == key_of(candidates[i].polygon))
      ++end;
    if (end - i > 1) found.emplace_back(candidates.data() + i, end - i);
    i = end;
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a[0].polygon < b[0].polygon; });
  polygon_groups groups;
  for (const auto& group : found) {
    for (const candidate& c : group) groups.members.push_back(c.polygon);
    groups.begins.push_back(static_cast<std::uint32_t>(groups.members.size()));
  }
  return groups;
}

group_key duplicate_key(const scene::world_geometry& geometry, std::uint32_t polygon, bool all_double_sided) {
  const scene::polygon_kind kind = geometry.kinds[polygon];
  const bool both_sides = kind.double_sided || all_double_sided;
  const scene::polygon_corners corners = scene::corners_of(geometry, polygon);
  std::uint32_t bits = static_cast<std::uint32_t>(kind.alpha);
  bits |= (both_sides ? 4u : 0u) | (kind.alpha_tested ? 8u : 0u) | (kind.non_occluder ? 16u : 0u);
  return {both_sides ? corners.sorted() : corners.rotated(), bits};
}

}  // namespace

duplicate_classes::duplicate_classes(const scene::world_geometry& geometry, bool all_double_sided) {
  polygon_groups groups =
      groups_by(geometry, [&](std::uint32_t polygon) { return duplicate_key(geometry, polygon, all_double_sided); });
  members_ = std::move(groups.members);
  begins_ = std::move(groups.begins);
  std::vector<std::uint32_t> class_at(members_.size());
  for (std::uint32_t number = 0; number < class_count(); ++number)
    std::fill(class_at.begin() + begins_[number], class_at.begin() + begins_[number + 1], number);
  std::vector<std::uint32_t> order(members_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return members_[a] < members_[b]; });
  for (const std::uint32_t at : order) {
    sorted_.push_back(members_[at]);
    numbers_.push_back(class_at[at]);
  }
}

std::span<const std::uint32_t> duplicate_classes::class_of(std::uint32_t polygon) const {
  const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), polygon);
  if (at == sorted_.end() || *at != polygon) return {};
  const std::uint32_t number = numbers_[static_cast<std::size_t>(at - sorted_.begin())];
  return std::span(members_).subspan(begins_[number], begins_[number + 1] - begins_[number]);
}

coincident_counts count_coincident(const scene::world_geometry& geometry) {
  coincident_counts counts;
  counts.duplicates = duplicate_classes(geometry, false).polygon_count();
  const auto place_of = [&](std::uint32_t polygon) {
    return group_key{scene::corners_of(geometry, polygon).sorted(), 0};
  };
  const polygon_groups groups = groups_by(geometry, place_of);
  counts.any_winding = static_cast<std::uint32_t>(groups.members.size());
  for (std::size_t i = 0; i + 1 < groups.begins.size(); ++i) {
    const auto group = std::span(groups.members).subspan(groups.begins[i], groups.begins[i + 1] - groups.begins[i]);
    const scene::polygon_corners first = scene::corners_of(geometry, group[0]).rotated();
    if (std::any_of(group.begin(), group.end(),
                    [&](std::uint32_t p) { return scene::corners_of(geometry, p).rotated() != first; }))
      counts.opposite += static_cast<std::uint32_t>(group.size());
  }
  return counts;
}

}  // namespace sightcell::bake
