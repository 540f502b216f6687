#include "hemicube/cpu/cluster_scene.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <span>

#include "trace/place_order.h"

namespace sightcell::bake::cpu {
namespace {

struct bounds {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{-std::numeric_limits<float>::max()};
  void add(const glm::vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  void add(const bounds& b) {
    low = glm::min(low, b.low);
    high = glm::max(high, b.high);
  }
  // Half the surface area. In double precision, because sides may be up to 1e38.
  double area() const {
    const glm::dvec3 s = glm::max(glm::dvec3(high) - glm::dvec3(low), 0.0);
    return s.x * s.y + s.y * s.z + s.z * s.x;
  }
};

struct placed {
  bounds box;
  glm::vec3 center() const { return box.low * 0.5f + box.high * 0.5f; }
  std::uint32_t id = 0;
};

struct branch {
  bounds box;
  std::size_t first = 0, last = 0;  // triangles of a leaf
  std::unique_ptr<branch> left, right;
};

bounds bounds_of(const std::span<const placed> triangles) {
  bounds b;
  for (const placed& t : triangles) b.add(t.box);
  return b;
}

constexpr std::size_t bins = 16;

// The best split of triangles: the axis and the bin border with the smallest sum of surface area times number of
// triangles. Bins divide the box of the centers into equal parts.
struct cut {
  int axis = -1;
  float low = 0.0f, scale = 0.0f;
  std::size_t border = 0;
  std::size_t bin_of(const placed& t) const {
    const float at = (t.center()[axis] - low) * scale;
    return std::min(bins - 1, static_cast<std::size_t>(std::max(at, 0.0f)));
  }
};

cut best_cut(std::span<const placed> triangles) {
  bounds centers;
  for (const placed& t : triangles) centers.add(t.center());
  cut best;
  double best_cost = std::numeric_limits<double>::max();
  for (int axis = 0; axis < 3; ++axis) {
    cut tried{axis, centers.low[axis], 0.0f, 0};
    tried.scale = static_cast<float>(bins) / (centers.high[axis] - centers.low[axis]);
    if (!(tried.scale > 0.0f) || !(tried.scale < std::numeric_limits<float>::max())) continue;
    std::array<bounds, bins> boxes;
    std::array<std::size_t, bins> counts{};
    for (const placed& t : triangles) {
      const std::size_t bin = tried.bin_of(t);
      boxes[bin].add(t.box);
      ++counts[bin];
    }
    std::array<double, bins> right_cost{};
    bounds right;
    std::size_t on_right = 0;
    for (std::size_t b = bins - 1; b > 0; --b) {
      right.add(boxes[b]);
      on_right += counts[b];
      right_cost[b] = on_right > 0 ? right.area() * static_cast<double>(on_right) : 0.0;
    }
    bounds left;
    std::size_t on_left = 0;
    for (std::size_t b = 1; b < bins; ++b) {
      left.add(boxes[b - 1]);
      on_left += counts[b - 1];
      if (on_left == 0 || on_left == triangles.size()) continue;
      const double cost = left.area() * static_cast<double>(on_left) + right_cost[b];
      if (cost < best_cost) {
        best_cost = cost;
        best = tried;
        best.border = b;
      }
    }
  }
  return best;
}

std::unique_ptr<branch> split(std::vector<placed>& all, std::size_t first, std::size_t last, std::uint32_t depth) {
  auto made = std::make_unique<branch>();
  const std::span<placed> part(all.data() + first, last - first);
  if (part.size() <= cluster_size) {
    made->box = bounds_of(part);
    made->first = first;
    made->last = last;
    return made;
  }
  std::size_t middle = part.size() / 2;
  const cut where = depth < max_tree_depth / 2 ? best_cut(part) : cut{};
  if (where.axis >= 0) {
    const auto second = std::stable_partition(part.begin(), part.end(),
                                              [&](const placed& t) { return where.bin_of(t) < where.border; });
    middle = static_cast<std::size_t>(second - part.begin());
  }
  const auto left = [&] { made->left = split(all, first, first + middle, depth + 1); };
  const auto right = [&] { made->right = split(all, first + middle, last, depth + 1); };
  if (part.size() > 16 * cluster_size) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
  made->box = made->left->box;
  made->box.add(made->right->box);
  return made;
}

class tree_writer {
 public:
  tree_writer(const scene::world_geometry& world, const std::vector<placed>& triangles, cluster_tree& tree)
      : world_(world), triangles_(triangles), tree_(tree) {}

  // Writes a node. To choose its children, the largest branch is replaced by its two parts until there are eight.
  std::int32_t write(const branch& from) {
    const auto number = static_cast<std::int32_t>(tree_.nodes.size());
    tree_.nodes.emplace_back();
    std::vector<const branch*> children{&from};
    while (children.size() < 8) {
      const auto largest = std::max_element(children.begin(), children.end(), [](const branch* a, const branch* b) {
        return (a->left ? a->box.area() : -1.0) < (b->left ? b->box.area() : -1.0);
      });
      if (!(*largest)->left) break;
      const branch* opened = *largest;
      *largest = opened->left.get();
      children.push_back(opened->right.get());
    }
    tree_node node{};
    node.count = static_cast<std::uint32_t>(children.size());
    for (std::size_t k = 0; k < children.size(); ++k) {
      const branch& c = *children[k];
      for (int axis = 0; axis < 3; ++axis) {
        node.low[axis][k] = c.box.low[axis];
        node.high[axis][k] = c.box.high[axis];
      }
      node.child[k] = c.left ? write(c) : ~write_cluster(c);
    }
    tree_.nodes[static_cast<std::size_t>(number)] = node;
    return number;
  }

 private:
  std::int32_t write_cluster(const branch& from) {
    const auto number = static_cast<std::int32_t>(tree_.clusters.size());
    cluster made{static_cast<std::uint32_t>(tree_.blocks.size()), 0};
    for (std::size_t i = from.first; i < from.last; i += 8) {
      triangle_block block{};
      block_marks marks;
      for (std::size_t k = 0; k < 8; ++k) {
        block.ids[k] = scene::no_index;
        if (i + k >= from.last) continue;
        const std::uint32_t id = triangles_[i + k].id;
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const glm::vec3& p = world_.positions[world_.indices[3 * std::size_t{id} + corner]];
          block.x[corner][k] = p.x;
          block.y[corner][k] = p.y;
          block.z[corner][k] = p.z;
        }
        block.ids[k] = id;
        marks.valid = static_cast<std::uint8_t>(marks.valid | 1u << k);
        if (world_.kinds[id].double_sided) marks.both_sides = static_cast<std::uint8_t>(marks.both_sides | 1u << k);
      }
      tree_.blocks.push_back(block);
      tree_.marks.push_back(marks);
      ++made.block_count;
    }
    tree_.clusters.push_back(made);
    return number;
  }

  const scene::world_geometry& world_;
  const std::vector<placed>& triangles_;
  cluster_tree& tree_;
};

// Returns what is known of the alpha test of a whole polygon; one without a test passes.
scene::opacity opacity_of(const scene::world_geometry& world, std::uint32_t id) {
  return world.kinds[id].alpha_tested ? world.opacity.whole(scene::masked_index(world, id)) : scene::opacity::passes;
}

void note_masks(const scene::world_geometry& world, cluster_tree& tree) {
  if (world.masked.empty()) return;
  tree.masked.reserve(8 * tree.blocks.size());
  for (const triangle_block& block : tree.blocks)
    for (const std::uint32_t id : block.ids)
      tree.masked.push_back(id == scene::no_index || opacity_of(world, id) == scene::opacity::passes
                                ? scene::no_index
                                : scene::masked_index(world, id));
}

template <class Wanted>
void build(const scene::world_geometry& world, const Wanted& wanted, cluster_tree& tree) {
  std::vector<std::uint32_t> drawn;
  for (std::uint32_t id = 0; id < world.kinds.size(); ++id) {
    const scene::polygon_kind kind = world.kinds[id];
    // A non-occluder that is in every set need not be drawn.
    if (kind.absent || (kind.always && !kind.occludes())) continue;
    const scene::opacity tested = opacity_of(world, id);
    if (tested == scene::opacity::fails || !wanted(kind, tested == scene::opacity::unknown)) continue;
    drawn.push_back(id);
  }
  if (drawn.empty()) return;
  sort_by_place(world, drawn);
  std::vector<placed> triangles(drawn.size());
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    triangles[i].id = drawn[i];
    for (std::size_t k = 0; k < 3; ++k)
      triangles[i].box.add(world.positions[world.indices[3 * std::size_t{drawn[i]} + k]]);
  }
  const auto root = split(triangles, 0, triangles.size(), 0);
  tree_writer(world, triangles, tree).write(*root);
}

}  // namespace

cluster_scene::cluster_scene(const scene::world_geometry& world) : alpha(world) {
  build(
      world, [](scene::polygon_kind k, bool has_test) { return k.occludes() && !has_test; }, opaque);
  build(
      world, [](scene::polygon_kind k, bool has_test) { return k.occludes() && has_test; }, masked);
  build(
      world, [](scene::polygon_kind k, bool) { return !k.occludes(); }, see_through);
  note_masks(world, masked);
  note_masks(world, see_through);
}

}  // namespace sightcell::bake::cpu
