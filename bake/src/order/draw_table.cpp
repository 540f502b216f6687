#include "order/draw_table.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "order/stored_draws.h"

namespace sightcell::bake {
namespace {

// Numbers the draw groups of the merged layout. Draws may be merged if the host issues them with one state and always
// shows them together: they have the same material, the same named group and the same level of detail. A draw that
// moves is a group by itself.
class group_numbers {
 public:
  // Returns the group of the next draw of the scene. To be called for all draws in their order.
  std::uint32_t next(const scene::draw& d) {
    ++draws_;
    const std::tuple key(d.material, d.tags.group, d.lod_object, d.lod_level, d.moves ? draws_ : 0);
    return numbers_.try_emplace(key, static_cast<std::uint32_t>(numbers_.size())).first->second;
  }

 private:
  using number = std::uint32_t;
  number draws_ = 0;
  std::map<std::tuple<number, number, number, number, number>, number> numbers_;
};

}  // namespace

static_assert(scene::no_index == format::no_named_group);

std::vector<format::draw_record> draw_table(const scene::scene& s, format::host_layout layout) {
  const bool merged = layout == format::host_layout::merged;
  group_numbers groups;
  std::vector<format::draw_record> table;
  table.reserve(s.draws.size());
  for (const scene::draw& d : s.draws)
    table.push_back({.node = d.node,
                     .mesh = d.mesh,
                     .primitive = d.primitive,
                     .instance = d.instance,
                     .material = d.material,
                     .group = merged ? groups.next(d) : 0,
                     .first_source = d.first_source,
                     .polygon_count = d.polygon_count,
                     .first_stored = d.first_source,  // until the draws are ordered
                     .base_vertex = d.base_vertex,
                     .host_tag = d.host_tag,
                     .flags = d.moves ? format::draw_moves : 0,
                     .named_group = d.tags.group});
  return merged ? in_groups(table) : table;
}

void remove_closed_groups(std::span<const std::string> closed, std::vector<std::string>& names,
                          std::span<format::draw_record> draws) {
  std::vector<std::uint32_t> number_of(names.size(), format::no_named_group);
  std::vector<std::string> left;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(closed.begin(), closed.end(), names[i]) != closed.end()) continue;
    number_of[i] = static_cast<std::uint32_t>(left.size());
    left.push_back(names[i]);
  }
  for (format::draw_record& d : draws)
    if (d.named_group != format::no_named_group) d.named_group = number_of[d.named_group];
  names = std::move(left);
}

}  // namespace sightcell::bake
