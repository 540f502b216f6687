#include "stream/tile_tree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "stream/short_number.h"

namespace sightcell::bake {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t most_children = 8;
constexpr int halvings = 3;  // make as many parts

// A box of 3D Tiles: Z up, a center and half the lengths, as the text has them.
class stored_box {
 public:
  // A little larger, so that text of few digits contains the box.
  explicit stored_box(const tile_box& box) {
    for (int k = 0; k < 3; ++k) {
      center_[k] = short_number(static_cast<float>(0.5 * (box.min[k] + box.max[k])));
      const double half = std::max(box.max[k] - center_[k], center_[k] - box.min[k]);
      half_[k] = short_number(static_cast<float>(half * (1.0 + 1e-6)));
    }
  }

  tile_box box() const { return {center_ - half_, center_ + half_}; }

  ordered_json json() const {
    ordered_json numbers = ordered_json::array();
    for (int k = 0; k < 3; ++k) numbers.push_back(short_json(static_cast<float>(center_[k])));
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < 3; ++k) numbers.push_back(short_json(k == row ? static_cast<float>(half_[k]) : 0.0f));
    return {{"box", std::move(numbers)}};
  }

 private:
  glm::dvec3 center_{0.0}, half_{0.0};
};

// Viewers turn the glTF of a tile by a quarter around x, from Y up to Z up.
tile_box with_z_up(const tile_box& box) {
  return {{box.min.x, -box.max.z, box.min.y}, {box.max.x, -box.min.z, box.max.y}};
}

struct tree_item {
  const listed_tile* tile = nullptr;
  stored_box box;
};

struct tree_node {
  ordered_json json;
  tile_box box;
};

using tree_items = std::span<tree_item>;

tree_node leaf(const tree_item& item) {
  return {{{"boundingVolume", item.box.json()},
           {"geometricError", 0},
           {"content", {{"uri", item.tile->uri}}},
           {"extras", {{"sightcell", {{"page", item.tile->page}}}}}},
          item.box.box()};
}

// Returns a tile without content: viewers load what is below it where `error` meters are more pixels than they
// tolerate.
tree_node inner(std::vector<tree_node> children, double error) {
  tile_box all;
  ordered_json list = ordered_json::array();
  for (tree_node& child : children) {
    all.add(child.box);
    list.push_back(std::move(child.json));
  }
  const stored_box box(all);
  ordered_json out{{"boundingVolume", box.json()}, {"geometricError", short_json(static_cast<float>(error))}};
  out["children"] = std::move(list);
  return {std::move(out), box.box()};
}

double largest_size(tree_items items) {
  double out = 0.0;
  for (const tree_item& item : items) out = std::max(out, item.tile->shape.size);
  return out;
}

// Halves the tiles at the middle one along the axis on which their centers are farthest apart, and the halves again.
void halve(tree_items items, int times, std::vector<tree_items>& out) {
  if (times == 0 || items.size() < 2) {
    out.push_back(items);
    return;
  }
  const auto center = [](const tree_item& item) {
    const tile_box box = item.box.box();
    return 0.5 * (box.min + box.max);
  };
  tile_box centers;
  for (const tree_item& item : items) centers.add({center(item), center(item)});
  const glm::dvec3 size = centers.max - centers.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::sort(items.begin(), items.end(), [&](const tree_item& a, const tree_item& b) {
    return std::pair(center(a)[axis], a.tile->page) < std::pair(center(b)[axis], b.tile->page);
  });
  halve(items.first(items.size() / 2), times - 1, out);
  halve(items.subspan(items.size() / 2), times - 1, out);
}

tree_node tree_of(tree_items items) {
  std::vector<tree_node> children;
  if (items.size() <= most_children) {
    for (const tree_item& item : items) children.push_back(leaf(item));
  } else {
    std::vector<tree_items> parts;
    halve(items, halvings, parts);
    for (const tree_items part : parts) children.push_back(tree_of(part));
  }
  return inner(std::move(children), largest_size(items));
}

}  // namespace

std::string tileset_json(std::span<const listed_tile> tiles) {
  // A viewer compares the error of a tile with its distance and loads all its children or none. So tiles of about the
  // same size have a tree of their own: in a common one, a large page would take the small ones beside it along.
  std::map<int, std::vector<tree_item>> by_size;
  for (const listed_tile& tile : tiles)
    by_size[tile.shape.size > 0.0 ? std::ilogb(tile.shape.size) : -1000].push_back(
        {&tile, stored_box(with_z_up(tile.shape.box))});
  std::vector<tree_node> trees;
  double largest = 0.0;
  for (auto size = by_size.rbegin(); size != by_size.rend(); ++size) {
    trees.push_back(tree_of(size->second));
    largest = std::max(largest, largest_size(size->second));
  }
  // A tileset needs a root with a box.
  if (trees.empty()) trees.push_back({ordered_json{}, {glm::dvec3(0.0), glm::dvec3(0.0)}});
  tree_node root = inner(std::move(trees), largest);
  if (by_size.empty()) root.json.erase("children");
  root.json["refine"] = "ADD";
  const glm::dvec3 diagonal = root.box.max - root.box.min;
  const double whole = std::max(largest, std::max({diagonal.x, diagonal.y, diagonal.z}));
  // The root has no transform: axes of tiles are those that 3D Tiles wants, with Z up.
  const ordered_json out{{"asset", {{"version", "1.1"}}},
                         {"geometricError", short_json(static_cast<float>(whole))},
                         {"root", std::move(root.json)}};
  return out.dump();
}

}  // namespace sightcell::bake
