#pragma once
// How a file holds what a bake has found. `sightcell recode` changes it without a bake.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace sightcell::bake {

// --profile: how many polygons that nobody sees may be drawn, so that a file is smaller and lists of ranges shorter.
// Pictures do not change.
enum class slack_profile : std::uint8_t {
  exact,     // none
  balanced,  // 5 % of those that are seen
  small,     // 10 %
};
inline constexpr std::array<std::string_view, 3> slack_profile_names = {"exact", "balanced", "small"};
inline constexpr std::array<double, 3> slack_of_profile = {0.0, 0.05, 0.10};

// --order: what shares one order of polygons.
enum class polygon_order_kind : std::uint8_t {
  per_mesh,      // all instances of a primitive, which share an index buffer in the host
  per_instance,  // nothing: fewer ranges, but each draw needs an index buffer of its own
};
inline constexpr std::array<std::string_view, 2> polygon_order_names = {"per-mesh", "per-instance"};

// --layout: how the host keeps its polygons.
enum class host_layout : std::uint8_t {
  instanced,  // draw by draw
  merged,     // in world space, the static draws of one material as one list, whose polygons are ordered together
};
inline constexpr std::array<std::string_view, 2> host_layout_names = {"instanced", "merged"};

struct file_settings {
  slack_profile profile = slack_profile::balanced;
  polygon_order_kind order = polygon_order_kind::per_mesh;
  host_layout layout = host_layout::instanced;
  // --importance: of each polygon of a cell how much of what is seen it covers. The settings text does not say it, as
  // it changes nothing else of the file: recode adds it to any file.
  bool importance = false;
};

// The place of a name in one of the lists above; nothing where it is not there.
template <class Kind, std::size_t Count>
constexpr std::optional<Kind> kind_of(const std::array<std::string_view, Count>& names, std::string_view name) {
  for (std::size_t i = 0; i < Count; ++i)
    if (names[i] == name) return static_cast<Kind>(i);
  return std::nullopt;
}

// What a file's settings text says. Files from before slack are exact; what the text does not say is as above.
file_settings file_settings_of(std::string_view settings);

}  // namespace sightcell::bake
