#include "joined_tree.h"

#include <utility>

namespace sightcell::scene {
namespace {

constexpr int unreached = -2, no_parent = -1;

}  // namespace

const std::vector<int>& joined_tree::children(std::size_t node) const {
  const auto found = longer_.find(node);
  return found != longer_.end() ? found->second : children_(node);
}

void joined_tree::join(const node_list& nodes) {
  std::vector<int> parents(nodes.nodes.size(), unreached);
  std::vector<std::pair<int, int>> stack, levels;  // (node, parent), (level, parent of its object)
  const auto visit = [&](int root, int parent_of_root) {
    stack.emplace_back(root, parent_of_root);
    while (!stack.empty()) {
      const auto [node, parent] = stack.back();
      stack.pop_back();
      const auto number = static_cast<std::size_t>(node);
      if (parents[number] != unreached) continue;  // the code that walks the scene rejects a node with two parents
      parents[number] = parent;
      for (const coarser_node& level : nodes.nodes[number].coarser)
        levels.emplace_back(static_cast<int>(level.node), parent);
      for (const int child : children_(number)) stack.emplace_back(child, node);
    }
  };
  for (const int root : std::vector<int>(roots_)) visit(root, no_parent);
  for (std::size_t i = 0; i < levels.size(); ++i) {  // visits add levels
    const auto [level, parent] = levels[i];
    if (parents[static_cast<std::size_t>(level)] != unreached) continue;
    if (parent == no_parent) {
      roots_.push_back(level);
    } else {
      const auto number = static_cast<std::size_t>(parent);
      longer_.try_emplace(number, children_(number)).first->second.push_back(level);
    }
    visit(level, parent);
  }
}

}  // namespace sightcell::scene
