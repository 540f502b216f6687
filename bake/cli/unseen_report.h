#pragma once
// Unseen polygons, as people and tools read them.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sightcell/bake/unseen.h"

namespace sightcell::cli {

// "12,345 of 60,000 polygons (20.6 %) are visible from no cell"
std::string unseen_text(const bake::unseen_polygons& found);

// What the bounds of the cells state about unseen polygons, in sentences.
std::string unseen_bound_text(const bake::unseen_bound& bound);

// The keys are documented in docs/json-files.md.
nlohmann::ordered_json unseen_json(const bake::unseen_polygons& found);

// Writes unseen_json to a file.
// Fails with cli.not-writable.
void write_unseen_report(const bake::unseen_polygons& found, const std::filesystem::path& path);

}  // namespace sightcell::cli
