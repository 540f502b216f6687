#pragma once
// MSFT_lod: which object each node of a scene belongs to, and at which level of detail.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gltf_nodes.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct lod_place {
  std::uint32_t object = no_index;  // its node with the extension
  std::uint32_t level = 0;
};

// Objects whose levels lie inside one another become one: a draw has one place, and what is shown together too often is
// better than what is shown too seldom.
class lod_levels {
 public:
  // children: of a node; nodes that no root leads to have no levels here. What contradicts itself is a warning.
  lod_levels(const node_list& nodes, const std::vector<int>& roots,
             const std::function<const std::vector<int>&(std::size_t)>& children, std::vector<std::string>& warnings);

  // The place of a node under a parent with that place. Once per node, in any order from parents to children.
  lod_place below(const lod_place& parent, std::uint32_t node);

  // From places as below() gave them: objects numbered from 0 in the order of their first draws; those of one level
  // alone are none.
  void settle(std::vector<draw>& draws);

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
  // By node; empty where the file has no levels.
  std::vector<lod_place> places_;                        // claimed by an object
  std::vector<std::uint32_t> first_visit_, last_visit_;  // depth-first numbers: of the node, of the last below it
  std::vector<std::uint32_t> same_as_;                   // chains of united objects
};

}  // namespace sightcell::scene
