#pragma once
// A .pvs file written anew without a bake: in this version of the format, in another profile, order or layout.
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

// What shall be other than it is.
struct recode_settings {
  // Exact cannot be asked of a file that holds slack: which polygons nobody sees is not known any more. Nor can less
  // slack than it has.
  std::optional<slack_profile> profile;
  std::optional<polygon_order_kind> order;  // polygons and draws are ordered anew, by the sets that the file holds
  // Polygons and draws are ordered anew, as for another order. To merged it takes layout_from, the scene that the file
  // was baked from: a file does not say which draws its host shows when it likes. Outlives the call.
  std::optional<host_layout> layout = {};
  const scene::scene* layout_from = nullptr;
  // The scene that the file was baked from, to measure in it how much of what is seen from its cell each polygon covers
  // (file_settings::importance), as a bake would have done; null: what the file knows of it stays. Outlives the call.
  const scene::scene* importance_in = nullptr;
  std::uint32_t threads = 0;  // for that, 0: all
  // Told while that is measured: cells done, of how many; false cancels. On the calling thread. Optional.
  std::function<bool(std::uint32_t done, std::uint32_t total)> on_progress = {};
};

struct recode_result {
  std::uint32_t version_before = 0;
  std::uint64_t bytes_before = 0, bytes = 0;
  double slack = 0.0;      // share of polygons that the new file's sets hold though nobody sees them
  bool cancelled = false;  // nothing was written
};

// Checks the file, then writes it to output by rename: the bytes may come from the same file. Without settings the sets
// stay what they are, also those of a file of an older version, whose polygons and lattice cells are put in order.
// Bounds and certificate stay, rounded to the safe side; so does the importance of polygons, but
// what slack adds is least important. With importance_in alone a file of this version stays what it is besides. The
// settings text names the new profile, order and layout. file, name: as for verify. Throws sightcell::error when the
// file is broken, cannot have the profile or the layout, is of another scene than importance_in or layout_from, or
// cannot be written; then nothing was changed. Runs on all cores.
recode_result recode(std::span<const std::byte> file, const std::string& name, const recode_settings& how,
                     const std::filesystem::path& output);

}  // namespace sightcell::bake
