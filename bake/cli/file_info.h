#pragma once
// What `sightcell info` prints of a .pvs file, as JSON.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pvs_file.h"

namespace sightcell::cli {

// Returns the object that `info --json` prints; docs/json-files.md has its keys.
// name: of the file, for messages.
// Fails with pvs.refused and pvs.broken.
// Cost: decodes each set once, and encodes the file once if it has visibility volumes.
nlohmann::ordered_json file_info(const pvs_file& file, const std::string& name);

// Returns how the sets were dilated without a visibility test, by the settings of a file: "edge", "vertex"; empty where
// they were not.
std::string safety_ring_of(const nlohmann::ordered_json& settings);

}  // namespace sightcell::cli
