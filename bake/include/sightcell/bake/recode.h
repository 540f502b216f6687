#pragma once
// Writes a .pvs file again without a bake: in the current version of the format, with another profile, order or layout,
// of clusters, or with importance, texture residency or names. bake.h has the conventions.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "sightcell/bake/file_settings.h"

namespace sightcell::scene {
struct scene;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

// What to change. Without a value, a property stays as it is.
struct recode_settings {
  // Slack of the sets. It can grow and not shrink: the file does not mark which polygons are slack.
  std::optional<slack_profile> profile;

  // Computes the stored order of polygons and draws again, from the sets in the file.
  std::optional<polygon_order_kind> order;

  // Computes the stored order again. host_layout::merged needs layout_from.
  std::optional<host_layout> layout = {};

  // The scene that was baked: it has the names of groups, which decide what can be merged. The caller keeps it during
  // the call.
  const scene::scene* layout_from = nullptr;

  // cluster: sets of polygons become sets of clusters, which needs clusters_from. Bounds still hold, because a cluster
  // is in a set if any of its polygons is. Sets of clusters cannot become sets of polygons again.
  std::optional<set_granularity> granularity = {};

  // The scene that was baked: its triangles are put into clusters, or the host has done that
  // (scene::geometry::clusters). The caller keeps it during the call.
  const scene::scene* clusters_from = nullptr;

  // The scene that was baked: geometry hashes and names are taken from it, as a bake with file_settings::names does.
  // Null keeps those that the file has. The caller keeps it during the call.
  const scene::scene* names_from = nullptr;

  // The scene that was baked: importance is measured in it, as a bake with file_settings::importance does. Null keeps
  // the importance that the file has. The caller keeps it during the call.
  const scene::scene* importance_in = nullptr;

  // The scene that was baked, with its textures (scene::read_texture_uses): texture residency is computed for it, as a
  // bake with file_settings::residency does. Null keeps what the file has. The caller keeps it during the call.
  const scene::scene* residency_of = nullptr;
  float anisotropy = 16.0f;  // with residency_of: the largest one of the filter, 1 .. 16

  std::uint32_t threads = 0;  // for importance and texture residency; 0 for all cores

  // Called while importance is measured or texture residency computed, on the calling thread. false cancels. May be
  // empty.
  std::function<bool(std::uint32_t done, std::uint32_t total)> on_progress = {};
};

struct recode_result {
  std::uint32_t version_before = 0;  // format version of the old file
  std::uint64_t bytes_before = 0;    // size of the old file
  std::uint64_t bytes = 0;           // size of the new file
  double slack = 0.0;                // of the new file: polygons of slack as a share of the others, 0 .. 0.1
  bool cancelled = false;            // by on_progress; no file was written
};

// Checks a file and writes it again. Sets stay the same except for slack and for polygons that fill clusters. Bounds
// and certificate stay, rounded up where the old version has them more precisely. Texture residency stays: slack is not
// visible. Importance stays; added slack has the least. The settings text of the new file has the new profile, order,
// layout and granularity. A file of the current version for which only importance or texture residency is made keeps
// all else, byte for byte. file: the bytes of the .pvs file, of any version. name: of the file, for messages. output:
// the new file; may be the file that was read. Fails with pvs.refused, pvs.broken, pvs.other-scene, scene.bad-field,
// recode.*; then no file has changed. Cost: seconds for a file of thousands of cells; with importance, as much as rays
// of a bake. Uses all cores.
recode_result recode(std::span<const std::byte> file, const std::string& name, const recode_settings& how,
                     const std::filesystem::path& output);

}  // namespace sightcell::bake
