#include "since/polygon_table.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <span>
#include <utility>

namespace sightcell::bake {
namespace {

constexpr std::size_t polygons_of_task = 4096;

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

// Of the polygons first .. last - 1.
std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted_names(const polygon_table& table, std::size_t first,
                                                                  std::size_t last) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> names;
  for (auto polygon = static_cast<std::uint32_t>(first); polygon < last; ++polygon)
    if (table.names[polygon] != 0) names.emplace_back(table.names[polygon], polygon);
  tbb::parallel_sort(names.begin(), names.end());
  return names;
}

// Fills in names and corners of the polygons first .. last - 1. masks: hashes, by mask.
void name_some(const scene::world_geometry& geometry, const std::vector<std::uint64_t>& masks, std::size_t first,
               std::size_t last, polygon_table& table) {
  auto masked = std::lower_bound(geometry.masked.begin(), geometry.masked.end(), first,
                                 [](const scene::masked_polygon& m, std::size_t polygon) { return m.id < polygon; });
  for (std::size_t polygon = first; polygon < last; ++polygon) {
    const scene::polygon_kind kind = geometry.kinds[polygon];
    while (masked != geometry.masked.end() && masked->id < polygon) ++masked;
    if (kind.absent) continue;
    table.corners[polygon] = corners_of(geometry, static_cast<std::uint32_t>(polygon));
    number_list numbers;
    numbers.add(bits_of(kind));
    for (const glm::vec3& corner : table.corners[polygon])
      for (int axis = 0; axis < 3; ++axis) numbers.add(corner[axis]);
    if (kind.alpha_tested && masked != geometry.masked.end() && masked->id == polygon) {
      numbers.add(masks[masked->mask]);
      for (const glm::vec2& uv : masked->uvs) numbers.add(uv.x), numbers.add(uv.y);
      for (const float alpha : masked->alphas) numbers.add(alpha);
    }
    table.names[polygon] = std::max<std::uint64_t>(numbers.hash(), 1);
  }
}

}  // namespace

polygon_table table_of(const scene::world_geometry& geometry) {
  std::vector<std::uint64_t> masks;
  for (const scene::alpha_mask& mask : geometry.masks) masks.push_back(hash_of(mask));
  polygon_table table;
  const std::size_t count = geometry.kinds.size();
  table.names.resize(count);
  table.near.resize(count);
  table.corners.resize(count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, polygons_of_task),
                    [&](const auto& range) { name_some(geometry, masks, range.begin(), range.end(), table); });
  return table;
}

void put_neighbors(const near_polygons& neighbors, polygon_table& table) {
  std::vector<std::uint64_t> hashes;  // of names, each of which is in about 15 sums
  hashes.reserve(table.names.size());
  for (const std::uint64_t name : table.names) hashes.push_back(XXH3_64bits(&name, sizeof(name)));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, table.names.size(), polygons_of_task), [&](const auto& range) {
    for (std::size_t polygon = range.begin(); polygon < range.end(); ++polygon) {
      if (table.names[polygon] == 0) continue;
      std::uint64_t sum = 0;
      neighbors.for_each(static_cast<std::uint32_t>(polygon), [&](std::uint32_t other) { sum += hashes[other]; });
      table.near[polygon] = sum;
    }
  });
}

polygon_edit edit_between(const polygon_table& before, const polygon_table& now) {
  polygon_edit edit;
  edit.new_of.assign(before.names.size(), polygon_edit::gone);
  // Most edits leave the polygons before and after theirs as they are.
  const std::size_t shorter = std::min(before.names.size(), now.names.size());
  std::size_t first = 0, last = 0;  // equal ones at the beginning and at the end
  while (first < shorter && before.names[first] == now.names[first]) ++first;
  while (last < shorter - first &&
         before.names[before.names.size() - 1 - last] == now.names[now.names.size() - 1 - last])
    ++last;
  const auto match = [&](std::size_t one, std::size_t other) {
    if (before.names[one] != 0) edit.new_of[one] = static_cast<std::uint32_t>(other);
  };
  for (std::size_t i = 0; i < first; ++i) match(i, i);
  for (std::size_t i = 1; i <= last; ++i) match(before.names.size() - i, now.names.size() - i);
  const auto old_names = sorted_names(before, first, before.names.size() - last),
             new_names = sorted_names(now, first, now.names.size() - last);
  std::vector<std::uint32_t> removed;
  auto one = old_names.begin();
  auto other = new_names.begin();
  while (one != old_names.end() || other != new_names.end()) {
    if (other == new_names.end() || (one != old_names.end() && one->first < other->first))
      removed.push_back((one++)->second);
    else if (one == old_names.end() || other->first < one->first)
      edit.added.push_back((other++)->second);
    else
      edit.new_of[(one++)->second] = (other++)->second;
  }
  std::sort(edit.added.begin(), edit.added.end());
  std::sort(removed.begin(), removed.end());
  for (const std::uint32_t polygon : removed) edit.removed_corners.push_back(before.corners[polygon]);
  return edit;
}

std::vector<std::uint8_t> other_neighbors(const polygon_table& before, const polygon_table& now,
                                          const polygon_edit& edit) {
  std::vector<std::uint8_t> differ(before.names.size());
  for (std::size_t polygon = 0; polygon < differ.size(); ++polygon) {
    const std::uint32_t number = edit.new_of[polygon];
    differ[polygon] = number != polygon_edit::gone && before.near[polygon] != now.near[number] ? 1 : 0;
  }
  return differ;
}

}  // namespace sightcell::bake
