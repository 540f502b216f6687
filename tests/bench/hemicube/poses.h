#pragma once
// Where the hemicubes of the benchmark stand.
#include <cstdint>
#include <string>
#include <vector>

#include "bench/hemicube/cache.h"
#include "hemicube/hemicube_source.h"

namespace sightcell::bench {

inline constexpr const char* all_heights[] = {"street", "20", "70", "200"};

// Meters above the street's places; 0 for the street itself.
float metres_of(const std::string& height);

// Job "poses": scene (a file), cells (a cells file, or empty: over walkable floor), poses, seed. The answer has for
// each height a list of poses.
//
// A place is a free point of one of the cells, which are taken evenly spread, put 1.6 m above the floor below it where
// that is free too. The heights lie straight above the places; a pose says whether it is free there. Headings are the
// golden angle apart. On the street all poses look at the horizon; above it every second one looks 45 degrees down.
// Of each two poses that look alike one is upright and one is turned by 45 degrees about where it looks.
json make_poses(const json& job);

// What make_poses depends on beside the scene: raised when it changes.
inline constexpr int poses_version = 1;

std::vector<bake::pose> read_poses(const json& list);

}  // namespace sightcell::bench
