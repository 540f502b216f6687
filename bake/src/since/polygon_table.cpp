#include "since/polygon_table.h"

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <span>
#include <utility>

namespace sightcell::bake {
namespace {

// Numbers of one polygon, hashed as they are in memory.
class number_list {
 public:
  void add(std::uint64_t number) { numbers_[count_++] = number; }
  void add(float number) { add(std::uint64_t{std::bit_cast<std::uint32_t>(number + 0.0f)}); }
  std::uint64_t hash() const { return XXH3_64bits(numbers_.data(), count_ * sizeof(numbers_[0])); }

 private:
  std::array<std::uint64_t, 24> numbers_{};
  std::size_t count_ = 0;
};

std::uint64_t hash_of(const scene::alpha_mask& mask) {
  number_list numbers;
  numbers.add(std::uint64_t{mask.width});
  numbers.add(std::uint64_t{mask.height});
  numbers.add(mask.cutoff);
  numbers.add(static_cast<std::uint64_t>(mask.wrap_u));
  numbers.add(static_cast<std::uint64_t>(mask.wrap_v));
  numbers.add(std::uint64_t{XXH3_64bits(mask.texels.data(), mask.texels.size())});
  return numbers.hash();
}

std::uint64_t bits_of(const scene::polygon_kind& kind) {
  return static_cast<std::uint64_t>(kind.alpha) | std::uint64_t{kind.double_sided} << 8 |
         std::uint64_t{kind.alpha_tested} << 9 | std::uint64_t{kind.non_occluder} << 10 |
         std::uint64_t{kind.always} << 11;
}

std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted_names(const polygon_table& table) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> names;
  for (std::uint32_t polygon = 0; polygon < table.names.size(); ++polygon)
    if (table.names[polygon] != 0) names.emplace_back(table.names[polygon], polygon);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<triangle> corners_of_all(const polygon_table& table, std::vector<std::uint32_t> polygons) {
  std::sort(polygons.begin(), polygons.end());
  std::vector<triangle> corners;
  for (const std::uint32_t polygon : polygons) corners.push_back(table.corners[polygon]);
  return corners;
}

}  // namespace

polygon_table table_of(const scene::world_geometry& geometry, const near_polygons* neighbors) {
  std::vector<std::uint64_t> masks;
  for (const scene::alpha_mask& mask : geometry.masks) masks.push_back(hash_of(mask));
  polygon_table table;
  const auto count = static_cast<std::uint32_t>(geometry.kinds.size());
  table.names.resize(count);
  table.near.resize(count);
  table.corners.resize(count);
  std::size_t masked = 0;
  for (std::uint32_t polygon = 0; polygon < count; ++polygon) {
    const scene::polygon_kind kind = geometry.kinds[polygon];
    while (masked < geometry.masked.size() && geometry.masked[masked].id < polygon) ++masked;
    if (kind.absent) continue;
    table.corners[polygon] = corners_of(geometry, polygon);
    number_list numbers;
    numbers.add(bits_of(kind));
    for (const glm::vec3& corner : table.corners[polygon])
      for (int axis = 0; axis < 3; ++axis) numbers.add(corner[axis]);
    if (kind.alpha_tested && masked < geometry.masked.size() && geometry.masked[masked].id == polygon) {
      const scene::masked_polygon& test = geometry.masked[masked];
      numbers.add(masks[test.mask]);
      for (const glm::vec2& uv : test.uvs) numbers.add(uv.x), numbers.add(uv.y);
      for (const float alpha : test.alphas) numbers.add(alpha);
    }
    table.names[polygon] = std::max<std::uint64_t>(numbers.hash(), 1);
  }
  if (!neighbors) return table;
  for (std::uint32_t polygon = 0; polygon < count; ++polygon) {
    if (table.names[polygon] == 0) continue;
    neighbors->for_each(polygon, [&](std::uint32_t other) {
      table.near[polygon] += XXH3_64bits(&table.names[other], sizeof(table.names[other]));
    });
  }
  return table;
}

polygon_edit edit_between(const polygon_table& before, const polygon_table& now) {
  polygon_edit edit;
  edit.new_of.assign(before.names.size(), polygon_edit::gone);
  edit.near_differs.resize(before.names.size());
  const auto old_names = sorted_names(before), new_names = sorted_names(now);
  std::vector<std::uint32_t> removed, added;
  auto one = old_names.begin();
  auto other = new_names.begin();
  while (one != old_names.end() || other != new_names.end()) {
    if (other == new_names.end() || (one != old_names.end() && one->first < other->first)) {
      removed.push_back((one++)->second);
    } else if (one == old_names.end() || other->first < one->first) {
      added.push_back((other++)->second);
    } else {
      edit.new_of[one->second] = other->second;
      edit.near_differs[one->second] = before.near[one->second] != now.near[other->second] ? 1 : 0;
      ++one, ++other;
    }
  }
  edit.removed = corners_of_all(before, std::move(removed));
  edit.added = corners_of_all(now, std::move(added));
  return edit;
}

}  // namespace sightcell::bake
