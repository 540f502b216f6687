#pragma once
// How a .pvs file stores the result of a bake. `sightcell recode` changes all of it without a bake. bake.h has the
// conventions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace sightcell::bake {

// ---- Profile --------------------------------------------------------------------------------------------------------

// --profile: how much slack sets may have, which makes files smaller and lists of ranges shorter. Slack is invisible
// polygons, or clusters in a file with clusters: pictures do not change.
enum class slack_profile : std::uint8_t { exact, balanced, small };

// As the command line and the settings text call them, in the order of the values.
inline constexpr std::array<std::string_view, 3> slack_profile_names = {"exact", "balanced", "small"};

// Slack as a share of the visible polygons, at most.
inline constexpr std::array<double, 3> slack_of_profile = {0.0, 0.05, 0.10};

// ---- Order ----------------------------------------------------------------------------------------------------------

// --order: which draws share one stored order of polygons.
enum class polygon_order_kind : std::uint8_t {
  per_mesh,     // all instances of a primitive: they share an index buffer in the host
  per_instance  // none: fewer ranges, but the host needs an index buffer for each draw
};
inline constexpr std::array<std::string_view, 2> polygon_order_names = {"per-mesh", "per-instance"};

// ---- Layout ---------------------------------------------------------------------------------------------------------

// --layout: how the host stores its polygons.
enum class host_layout : std::uint8_t {
  instanced,  // per primitive, shared by instances; the host issues draws
  merged      // in world space, in one list for each draw group; the host issues draw groups
};
inline constexpr std::array<std::string_view, 2> host_layout_names = {"instanced", "merged"};

// ---- Granularity ----------------------------------------------------------------------------------------------------

// --granularity: what sets consist of.
enum class set_granularity : std::uint8_t {
  polygon,
  cluster  // up to 128 triangles (meshlets), for hosts that draw whole clusters; rows are much smaller
};
inline constexpr std::array<std::string_view, 2> set_granularity_names = {"polygon", "cluster"};

// ---- All of it ------------------------------------------------------------------------------------------------------

struct file_settings {
  slack_profile profile = slack_profile::balanced;
  polygon_order_kind order = polygon_order_kind::per_mesh;  // per_mesh only, for host_layout::merged
  host_layout layout = host_layout::instanced;

  // With clusters, those of scene::geometry::clusters where the host has given any.
  set_granularity granularity = set_granularity::polygon;

  // --importance: stores how large a part of the view from its cell each polygon covers, in 16 classes. Not in the
  // settings text: the other sections of the file do not depend on it.
  bool importance = false;

  // --residency: stores the finest mip level of each texture that a picture from each cell can need. Needs the textures
  // of the scene (scene::read_texture_uses); without them the file has none. Not in the settings text, for the same
  // reason. anisotropy: the largest one of the host's filter, 1 .. 16; 1 for a filter without.
  bool residency = false;
  float anisotropy = 16.0f;

  // --names: stores a hash of the geometry of each draw and the names of nodes and meshes, by which a host finds its
  // objects. Not in the settings text, for the same reason.
  bool names = false;
};

// Returns the value with this name, nothing for an unknown name.
// names: one of the lists above.
template <class Kind, std::size_t Count>
constexpr std::optional<Kind> kind_of(const std::array<std::string_view, Count>& names, std::string_view name) {
  for (std::size_t i = 0; i < Count; ++i)
    if (names[i] == name) return static_cast<Kind>(i);
  return std::nullopt;
}

// Returns what the settings text of a file names. What it does not name has the default, except that a file without a
// profile is exact: it is older than slack.
file_settings file_settings_of(std::string_view settings);

}  // namespace sightcell::bake
