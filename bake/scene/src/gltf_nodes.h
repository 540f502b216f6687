#pragma once
// Reads from the checked JSON what a file states about its nodes apart from transforms: marks for the bake
// (extras.sightcell), animated nodes, and levels of detail (MSFT_lod, extras.sightcell.level_of).
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "json_object.h"
#include "sightcell/scene/object_levels.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// Explicitly in no group, which overrides the parent's; no_index: no statement.
inline constexpr std::uint32_t no_group = 0xFFFFFFFEu;

// The keys of extras.sightcell; empty: the node inherits the value of its parent.
struct node_marks {
  std::optional<bool> is_static, occluder, dynamic, always, never;
  std::uint32_t group = no_index;        // in node_list::groups
  bool start = false;                    // a player begins here; not inherited
  bool cell = false;                     // the box of the node is a view cell; not inherited
  std::string level_of{};                // name of the node that this one is a level of detail of; not inherited
  std::optional<float> from_distance{};  // where this level begins, meters; not inherited
  bool invisible = false;  // KHR_node_visibility: not shown at first, with all its descendants; the host may show it
};

// A node that is a coarser level of detail of another one.
struct coarser_node {
  std::uint32_t node = 0;
  level_switch begins;
};

// What a file states about one node.
struct node_notes {
  node_marks marks;
  bool moves = false;                 // by an animation, with all its descendants
  bool morphs = false;                // the weights of its mesh are animated
  std::vector<coarser_node> coarser;  // its levels of detail, finer ones first
  float least_coverage = 0.0f;        // MSFT_screencoverage: below it nothing is drawn
};

// What a file states about all nodes.
struct node_list {
  std::vector<node_notes> nodes;  // by glTF node number
  std::vector<std::string> groups;
};

// Reads the nodes. Of animations only the targets of channels are read. Warnings are added once per cause. Throws
// sightcell::error (bad_input) for references to nodes that do not exist.
node_list read_nodes(const json_object& root, std::vector<std::string>& warnings);

// Returns a node's own marks, completed by those of its parent, key by key.
node_marks inherited(const node_marks& parent, const node_marks& own);

// Returns the tags that follow from marks by visibility rule 6. moving: by an animation or a skin.
draw_tags tags_of(const node_marks& marks, bool moving);

}  // namespace sightcell::scene
