#pragma once
// Reproduces misses that a host reported at run time. bake.h has the conventions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/verify.h"

namespace sightcell::bake {

// A cell whose set lacks a polygon that is visible from an eye in it.
struct reproduced_miss {
  std::uint32_t cell = 0;
  std::uint32_t polygon = 0;  // source id
  std::array<float, 3> eye{};
};

// Result for a file of reported misses. Equal reports count once, and each report is in one of the five counts.
struct miss_check {
  std::uint64_t reports = 0;

  std::uint64_t reproduced = 0;   // the set of some cell lacks the polygon, and a ray from the eye hits it
  std::uint64_t not_missing = 0;  // the polygon, or one that coincides with it, is in the sets of all cells of the eye
  std::uint64_t not_visible = 0;  // no ray from the eye hits the polygon
  std::uint64_t not_free = 0;     // the eye is no valid viewpoint: inside a solid, or too near to a surface
  std::uint64_t outside = 0;      // the eye is in no cell

  std::vector<reproduced_miss> list;  // by cell, eye and polygon; one report may be in it for several cells
};

// Tries each reported miss in each cell whose box, grown by the margin, contains the eye: a host may be in any of them.
// s, file, name: as for verify().
// misses: a JSON file, {"misses": [{"eye": [x, y, z], "polygon": 1234}]}.
// how: threads and cells_from are used, the rest is not.
// on_progress: called after each cell of the file.
// Fails with misses.* for the file of misses, and as verify().
// Cost: builds a ray scene, as verify() does; then up to 2^18 rays for each report, as dense as the pixels of a
// picture.
miss_check check_misses(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                        const std::filesystem::path& misses, const verify_settings& how,
                        const verify_progress& on_progress);

// As above, for the arrays of an engine.
miss_check check_misses(const host_scene& s, std::span<const std::byte> file, const std::string& name,
                        const std::filesystem::path& misses, const verify_settings& how,
                        const verify_progress& on_progress);

}  // namespace sightcell::bake
