#include "lod_levels.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

namespace sightcell::scene {

lod_levels::lod_levels(const node_list& nodes, const std::vector<int>& roots,
                       const std::function<const std::vector<int>&(std::size_t)>& children,
                       std::vector<std::string>& warnings)
    : nodes_(nodes), warnings_(warnings) {
  if (std::all_of(nodes.nodes.begin(), nodes.nodes.end(), [](const node_notes& n) { return n.coarser.empty(); }))
    return;
  const std::size_t count = nodes.nodes.size();
  places_.resize(count);
  first_visit_.assign(count, no_index);
  last_visit_.assign(count, no_index);
  same_as_.resize(count);
  std::iota(same_as_.begin(), same_as_.end(), 0u);
  visit(roots, children);
  for (std::uint32_t object = 0; object < count; ++object) {
    if (!reached(object)) continue;
    std::uint32_t level = 0;
    for (const coarser_node& coarser : nodes.nodes[object].coarser) claim(object, ++level, coarser.node);
  }
  if (missing_ > 0) {
    warnings_.push_back(
        std::to_string(missing_) + (missing_ == 1 ? " level of detail is" : " levels of detail are") +
        " not in the scene (MSFT_lod): left out; the host must draw such a level wherever its finest one is visible");
  }
}

void lod_levels::claim(std::uint32_t object, std::uint32_t level, std::uint32_t node) {
  const auto ignore = [&](const std::string& why) {
    warnings_.push_back("nodes[" + std::to_string(object) + "] has nodes[" + std::to_string(node) +
                        "] as a level of detail, which " + why + ": ignored");
  };
  if (!reached(node)) {
    ++missing_;
  } else if (is_above(node, object)) {
    ignore(node == object ? "is itself" : "is an ancestor of it");
  } else if (places_[node].object != no_index) {
    ignore("is a level of nodes[" + std::to_string(places_[node].object) + "] already");
  } else if (united(node) == united(object)) {
    ignore("has it as a level in turn");
  } else {
    places_[node] = {object, level};
    unite(object, node);  // because the node may be an object too
  }
}

void lod_levels::visit(const std::vector<int>& roots,
                       const std::function<const std::vector<int>&(std::size_t)>& children) {
  struct pending {
    std::uint32_t node;
    bool leaves;
  };
  std::vector<pending> stack;
  const auto push = [&stack](const std::vector<int>& nodes) {
    for (const int node : nodes) stack.push_back({static_cast<std::uint32_t>(node), false});
  };
  push(roots);
  std::uint32_t visits = 0;
  while (!stack.empty()) {
    const auto [node, leaves] = stack.back();
    stack.pop_back();
    if (leaves) {
      last_visit_[node] = visits - 1;
    } else if (!reached(node)) {  // the code that walks the scene rejects a node with two parents
      first_visit_[node] = visits++;
      stack.push_back({node, true});
      push(children(node));
    }
  }
}

std::uint32_t lod_levels::united(std::uint32_t object) {
  while (same_as_[object] != object) object = same_as_[object] = same_as_[same_as_[object]];
  return object;
}

lod_place lod_levels::below(const lod_place& parent, std::uint32_t node) {
  if (places_.empty()) return {};
  const bool is_object = !nodes_.nodes[node].coarser.empty();
  lod_place here = places_[node];
  if (here.object == no_index && is_object) here = {node, 0};
  if (here.object == no_index) return parent;
  if (parent.object == no_index) return here;
  unite(parent.object, here.object);
  return {parent.object, std::max(parent.level, here.level)};
}

void lod_levels::settle(std::vector<draw>& draws, std::vector<object_switches>* switches) {
  if (places_.empty()) return;
  struct levels {
    std::uint32_t finest = no_index, coarsest = 0, number = no_index;
  };
  std::unordered_map<std::uint32_t, levels> objects;
  for (const draw& d : draws) {
    if (d.lod_object == no_index) continue;
    levels& object = objects[united(d.lod_object)];
    object.finest = std::min(object.finest, d.lod_level);
    object.coarsest = std::max(object.coarsest, d.lod_level);
  }
  std::uint32_t count = 0;
  for (draw& d : draws) {
    if (d.lod_object == no_index) continue;
    levels& object = objects[united(d.lod_object)];
    if (object.finest == object.coarsest) {
      d.lod_object = no_index;
      d.lod_level = 0;
      continue;
    }
    // If the finest level has no triangles the next one replaces it; otherwise no polygon of the object would be
    // visible.
    d.lod_level -= object.finest;
    if (object.number == no_index) object.number = count++;
    d.lod_object = object.number;
  }
  if (switches == nullptr) return;
  switches->assign(count, {});
  for (std::uint32_t node = 0; node < places_.size(); ++node) {
    const std::vector<coarser_node>& coarser = nodes_.nodes[node].coarser;
    const auto object = reached(node) ? objects.find(united(node)) : objects.end();
    if (coarser.empty() || object == objects.end() || object->second.number == no_index) continue;
    object_switches& out = (*switches)[object->second.number];
    out.least_coverage = std::max(out.least_coverage, nodes_.nodes[node].least_coverage);
    // Of objects that are one, the first with a level decides where it begins.
    for (std::size_t i = object->second.finest + out.begins.size(); i < coarser.size(); ++i)
      out.begins.push_back(coarser[i].begins);
  }
}

}  // namespace sightcell::scene
