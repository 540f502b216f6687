#pragma once
// The tree of a scene, to which levels of detail outside it can be joined.
#include <cstddef>
#include <functional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "gltf_nodes.h"

namespace sightcell::scene {

class joined_tree {
 public:
  // children: returns the children of a node; must outlive the tree.
  joined_tree(std::vector<int> roots, const std::function<const std::vector<int>&(std::size_t)>& children)
      : roots_(std::move(roots)), children_(children) {}

  // Makes each level that the tree does not have a sibling of its object, after all others. A level of several objects
  // becomes one of the first.
  void join(const node_list& nodes);

  const std::vector<int>& roots() const { return roots_; }
  const std::vector<int>& children(std::size_t node) const;

 private:
  std::vector<int> roots_;
  const std::function<const std::vector<int>&(std::size_t)>& children_;
  std::unordered_map<std::size_t, std::vector<int>> longer_;  // lists with joined children
};

}  // namespace sightcell::scene
