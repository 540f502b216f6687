#pragma once
// What a file says about its nodes beside where they stand: marks for the bake (extras.sightcell), what its animations
// move, and levels of detail (MSFT_lod). Straight from the checked JSON.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "json_object.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

inline constexpr std::uint32_t no_group = 0xFFFFFFFEu;  // said, unlike no_index: out of the parent's group

// The keys of extras.sightcell; nothing: the node does not say, so its parent does.
struct node_marks {
  std::optional<bool> is_static, occluder, dynamic, always, never;
  std::uint32_t group = no_index;  // into node_list::groups
  bool invisible = false;          // KHR_node_visibility: not shown at first, with all that hangs on it; the host may
};

struct node_notes {
  node_marks marks;
  bool moves = false;                  // by an animation, with all that hangs on it
  bool morphs = false;                 // the weights of its mesh are animated
  std::vector<std::uint32_t> coarser;  // nodes with its levels of detail, finer ones first
};

struct node_list {
  std::vector<node_notes> nodes;  // by glTF node number
  std::vector<std::string> groups;
};

// Warnings come once per cause. Throws sightcell::error (bad_input) for nodes that are not there; of an animation only
// what its channels aim at is read.
node_list read_nodes(const json_object& root, std::vector<std::string>& warnings);

// A node's own marks over those of its parent, key by key.
node_marks inherited(const node_marks& parent, const node_marks& own);

// What rule 6 of seeing makes of the marks in force. moving: by an animation or a skin.
draw_tags tags_of(const node_marks& marks, bool moving);

}  // namespace sightcell::scene
