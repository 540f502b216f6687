#pragma once
// The scenes of the benchmark by name.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/hemicube/cache.h"

namespace sightcell::bench {

struct bench_scene {
  std::string name;
  std::filesystem::path file, cells;  // cells: empty where the walkable floor is looked for
  std::string hash;                   // of the bytes of both
};

// All that a run without --scenes measures.
const std::vector<std::string>& scene_names();

// The town that --quick makes.
inline constexpr const char* small_town = "small-town";

// A scene by name, or a file by path. Towns are made by the sightcell-city beside this program and kept. Nothing, and a
// line on standard error that says why, where it is missing.
std::optional<bench_scene> find_scene(const std::string& name);

}  // namespace sightcell::bench
