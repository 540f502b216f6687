#pragma once
// MSFT_lod and extras.sightcell.level_of: finds the object that each node of a scene belongs to, and its level of
// detail.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gltf_nodes.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// The object and level of a node.
struct lod_place {
  std::uint32_t object = no_index;  // number of its node with levels
  std::uint32_t level = 0;
};

// Where the levels of an object begin.
struct object_switches {
  std::vector<level_switch> begins;  // of the levels from 1 on
  float least_coverage = 0.0f;       // below it nothing is drawn
};

// Objects whose levels contain each other are united, because a draw has one object and one level, and drawing too
// much is better than drawing too little.
class lod_levels {
 public:
  // children: returns the children of a node. Nodes below no root have no levels here. Contradictions cause warnings.
  lod_levels(const node_list& nodes, const std::vector<int>& roots,
             const std::function<const std::vector<int>&(std::size_t)>& children, std::vector<std::string>& warnings);

  // Returns the object and level of a node below a parent. Must be called once per node, parents before children.
  lod_place below(const lod_place& parent, std::uint32_t node);

  // Numbers objects from 0 in the order of their first draws. draws: with objects and levels from below(). Objects
  // with a single level are removed. switches: by object; may be null.
  void settle(std::vector<draw>& draws, std::vector<object_switches>* switches);

 private:
  void claim(std::uint32_t object, std::uint32_t level, std::uint32_t node);
  bool reached(std::uint32_t node) const { return first_visit_[node] != no_index; }
  bool is_above(std::uint32_t node, std::uint32_t other) const {
    return first_visit_[node] <= first_visit_[other] && first_visit_[other] <= last_visit_[node];
  }
  void visit(const std::vector<int>& roots, const std::function<const std::vector<int>&(std::size_t)>& children);
  std::uint32_t united(std::uint32_t object);
  void unite(std::uint32_t one, std::uint32_t other) { same_as_[united(other)] = united(one); }

  const node_list& nodes_;
  std::vector<std::string>& warnings_;
  std::size_t missing_ = 0;
  // By node; empty if the file has no levels.
  std::vector<lod_place> places_;                        // claimed by an object
  std::vector<std::uint32_t> first_visit_, last_visit_;  // depth-first numbers: of the node, of the last node below it
  std::vector<std::uint32_t> same_as_;                   // chains of united objects
};

}  // namespace sightcell::scene
