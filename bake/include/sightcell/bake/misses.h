#pragma once
// Polygons that a host found missing at run time, asked of the file that it had: are they really?
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/bake.h"

namespace sightcell::bake {

// A cell that an eye can be in and whose set lacks what the eye sees.
struct reproduced_miss {
  std::uint32_t cell = 0, polygon = 0;  // of the file, of the scene
  std::array<float, 3> eye{};
};

// Reports that are the same count once; each is counted in one of the five.
struct miss_check {
  std::uint64_t reports = 0;
  std::uint64_t reproduced = 0;   // a set lacks it, and a ray from the eye sees it
  std::uint64_t not_missing = 0;  // it is in the sets of all cells that the eye can be in, or what lies in its place is
  std::uint64_t not_visible = 0;  // no ray from the eye sees it
  std::uint64_t not_free = 0;     // the eye is no free place: inside a solid, or nearer to a surface than player_radius
  std::uint64_t outside = 0;      // the eye is in no cell
  std::vector<reproduced_miss> list;  // by cell, eye and polygon; a report may be in several cells
};

// misses: {"misses":[{"eye":[x,y,z],"polygon":1234}]}. Asks every cell whose box, grown by the margin, holds the eye: a
// host may be in any of them. Builds its own ray scene, as verify() does, and casts rays at each polygon that is not in
// a set: as close as the pixels of a picture, and 2^18 at most. file, name, on_progress: as for verify(); of how the
// rays mean nothing. Throws sightcell::error when the file is broken or belongs to another scene, or the misses cannot
// be read.
miss_check check_misses(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                        const std::filesystem::path& misses, const verify_settings& how,
                        const std::function<void(std::uint32_t done, std::uint32_t total)>& on_progress);
miss_check check_misses(const host_scene& s, std::span<const std::byte> file, const std::string& name,
                        const std::filesystem::path& misses, const verify_settings& how,
                        const std::function<void(std::uint32_t done, std::uint32_t total)>& on_progress);

}  // namespace sightcell::bake
