#include "trace/masked_parts.h"

#include <array>
#include <cstddef>

namespace sightcell::bake {
namespace {

// Edges of a polygon are divided into this many pieces at most. Rays from cells of a scene of leaves (temple.glb) take
// 0.93 us without parts, 0.76 us with 2, 4 or 8 pieces. Sizes of 4 pieces make 2.5 parts of a polygon there.
constexpr std::uint32_t most_pieces = 4;
// A triangle of which this share may pass is not divided. With three quarters there are twice as many parts, and rays
// take as long or longer.
constexpr double enough = 0.5;
constexpr masked_part whole_polygon{};

// A triangle in a polygon, in units of the parts of its map. Upright: its corners are (u, v), (u + size, v) and
// (u, v + size). Turned: (u + size, v + size), (u, v + size) and (u + size, v).
struct node {
  std::uint32_t u = 0, v = 0, size = 1;
  bool turned = false;
};

std::array<node, 4> quarters_of(const node& n) {
  const std::uint32_t half = n.size / 2;
  const node right{n.u + half, n.v, half, n.turned}, up{n.u, n.v + half, half, n.turned};
  if (n.turned) return {node{n.u + half, n.v + half, half, true}, right, up, node{n.u + half, n.v + half, half, false}};
  return {node{n.u, n.v, half, false}, right, up, node{n.u, n.v, half, true}};
}

// Divides the polygons of a map.
class divider {
 public:
  divider(const scene::opacity_maps& maps, const scene::opacity_map& map, std::vector<masked_part>& out)
      : maps_(maps), map_(map), out_(out) {}

  // Appends what may pass of a triangle. Returns the number of parts of the map in it that may pass.
  std::uint32_t divide(const node& n) {
    const std::size_t before = out_.size();
    std::uint32_t may_pass = 0;
    if (n.size == 1)
      may_pass = opacity_of(n) == scene::opacity::fails ? 0 : 1;
    else
      for (const node& quarter : quarters_of(n)) may_pass += divide(quarter);
    if (may_pass == 0) return 0;
    const bool is_finest = n.size * most_pieces <= map_.side || n.size == 1;
    if (!is_finest && may_pass < enough * n.size * n.size) return may_pass;
    out_.resize(before);
    out_.push_back(part_of(n));
    return may_pass;
  }

 private:
  scene::opacity opacity_of(const node& n) const {
    return maps_.parts[map_.first + 2 * (std::size_t{n.v} * map_.side + n.u) + (n.turned ? 1 : 0)];
  }
  masked_part part_of(const node& n) const {
    const float unit = 1.0f / static_cast<float>(map_.side), size = unit * static_cast<float>(n.size);
    const float u = unit * static_cast<float>(n.u), v = unit * static_cast<float>(n.v);
    return n.turned ? masked_part{u + size, v + size, -size} : masked_part{u, v, size};
  }

  const scene::opacity_maps& maps_;
  const scene::opacity_map& map_;
  std::vector<masked_part>& out_;
};

}  // namespace

masked_parts::masked_parts(const scene::opacity_maps& maps) : maps_(maps) {
  for (const scene::opacity_map& map : maps.maps) {
    begins_.push_back(static_cast<std::uint32_t>(parts_.size()));
    if (map.side > 0)
      divider(maps, map, parts_).divide({0, 0, map.side, false});
    else if (map.whole != scene::opacity::fails)
      parts_.push_back(whole_polygon);
  }
  begins_.push_back(static_cast<std::uint32_t>(parts_.size()));
}

std::span<const masked_part> masked_parts::of(std::size_t masked) const {
  if (maps_.map_of.empty()) return {&whole_polygon, 1};
  const std::uint32_t map = maps_.map_of[masked];
  return std::span(parts_).subspan(begins_[map], begins_[map + 1] - begins_[map]);
}

}  // namespace sightcell::bake
