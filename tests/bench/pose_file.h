#pragma once
// The file of poses that stream_truth writes, and two_pictures and stream_poses.py read:
//
// "SIGHTPOS", u32 version (2), u32 number of poses; then of each pose: f32 eye[3], f32 heading in radians, u32 cell,
// u32 number of polygons n, u32 ids[n] (source ids, ascending), f32 angles[n][5], f32 depths[4][36][64]. The angles are
// solid angles in sr: in all directions, and in four views of 60 degrees (vertically) at 16:9, each turned by a further
// 90 degrees. The depths are those of tiles of these views, from the lower left on, row by row: the largest one in the
// tile along the axis of the view, in meters; infinite where something of it shows no polygon. All numbers are
// little-endian.
#include <cstddef>
#include <cstdint>

namespace sightcell::bench {

inline constexpr std::uint32_t pose_file_version = 2;
inline constexpr std::size_t views_of_pose = 4, tiles_across = 64, tiles_up = 36;

}  // namespace sightcell::bench
