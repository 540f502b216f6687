#pragma once
// A .pvs file written anew without a bake: in this version of the format, in another profile or order.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "sightcell/bake/file_settings.h"

namespace sightcell::bake {

// What shall be other than it is.
struct recode_settings {
  // Exact cannot be asked of a file that holds slack: which polygons nobody sees is not known any more. Nor can less
  // slack than it has.
  std::optional<slack_profile> profile;
  std::optional<polygon_order_kind> order;  // polygons and draws are ordered anew, by the sets that the file holds
};

struct recode_result {
  std::uint32_t version_before = 0;
  std::uint64_t bytes_before = 0, bytes = 0;
  double slack = 0.0;  // share of polygons that the new file's sets hold though nobody sees them
};

// Checks the file, then writes it to output by rename: the bytes may come from the same file. Without settings the sets
// stay what they are, also those of a file of an older version, whose polygons and lattice cells are put in order.
// Bounds and certificate stay, rounded to the safe side. The settings text names the new profile and order. file, name:
// as for verify. Throws sightcell::error when the file is broken, cannot have the profile, or cannot be written; then
// nothing was changed. Runs on all cores.
recode_result recode(std::span<const std::byte> file, const std::string& name, const recode_settings& how,
                     const std::filesystem::path& output);

}  // namespace sightcell::bake
