#pragma once
// Draws the triangles of a cluster: transforms eight at a time, sorts them into small and large ones, and draws them.
#include "hemicube/cpu/large_triangle.h"
#include "hemicube/cpu/small_triangle.h"

namespace sightcell::bake::cpu {
namespace {

// A triangle is drawn by draw_large if it reaches further from the image's center than guard_band half images, if it is
// larger than largest_small pixels, or if its largest depth is more than depth_range times its smallest depth, where
// differences of 1/Z lose precision.
constexpr float guard_band = 7.5f;
constexpr std::int32_t largest_small = 500;
constexpr float depth_range = 4.0f;

struct floats3 {
  floats x, y, z;
};

inline floats3 to_eye_space(const face_frame& face, floats x, floats y, floats z) {
  x = x - all(face.eye[0]);
  y = y - all(face.eye[1]);
  z = z - all(face.eye[2]);
  const auto along = [&](const float(&axis)[3]) { return x * all(axis[0]) + y * all(axis[1]) + z * all(axis[2]); };
  return {along(face.right), along(face.up), along(face.forward)};
}

// Returns the lanes whose three corners are outside of one side of the frustum. Also correct for corners behind the
// eye.
inline std::uint32_t outside_frustum(const face_frame& face, const floats3 (&v)[3]) {
  ints left = all(-1), right = left, below = left, above = left;
  for (const floats3& p : v) {
    left = left & (all(face.min_x) * p.z > p.x);
    right = right & (p.x > all(face.max_x) * p.z);
    below = below & (all(face.min_y) * p.z > p.y);
    above = above & (p.y > all(face.max_y) * p.z);
  }
  return sign_bits(left | right | below | above);
}

template <pass kind>
inline void draw_large_lane(draw_state& s, const floats3 (&v)[3], std::uint32_t k, bool both_sides) {
  alignas(32) float x[8], y[8], z[8];
  corner3 corners[3];
  for (int c = 0; c < 3; ++c) {
    store(x, v[c].x);
    store(y, v[c].y);
    store(z, v[c].z);
    corners[c] = {static_cast<double>(x[k]), static_cast<double>(y[k]), static_cast<double>(z[k])};
  }
  draw_large<kind>(s, corners, both_sides);
}

// Returns the lanes that can cover a pixel center, and fills b for them.
HWY_INLINE std::uint32_t set_up(const tile_image& image, const floats (&inverse)[3], const ints (&fixed_x)[3],
                                const ints (&fixed_y)[3], std::uint32_t wanted, std::uint32_t both_sides,
                                block_setup& b) {
  const ints low_x = smaller(smaller(fixed_x[0], fixed_x[1]), fixed_x[2]);
  const ints high_x = larger(larger(fixed_x[0], fixed_x[1]), fixed_x[2]);
  const ints low_y = smaller(smaller(fixed_y[0], fixed_y[1]), fixed_y[2]);
  const ints high_y = larger(larger(fixed_y[0], fixed_y[1]), fixed_y[2]);
  // The first pixel center at or after the low end, and the last one at or before the high end.
  const ints before = all(sub_pixel / 2 - 1), half = all(sub_pixel / 2);
  const ints px0 = larger(shift_right<16>(low_x + before), all(0));
  const ints py0 = larger(shift_right<16>(low_y + before), all(0));
  const ints px1 = smaller(shift_right<16>(high_x - half), all(static_cast<std::int32_t>(image.tiles_x * 8 - 1)));
  const ints py1 = smaller(shift_right<16>(high_y - half), all(static_cast<std::int32_t>(image.tiles_y * 8 - 1)));
  wanted &= ~sign_bits((px0 > px1) | (py0 > py1));
  if (wanted == 0) return 0;

  ints dx1 = fixed_x[1] - fixed_x[0], dy1 = fixed_y[1] - fixed_y[0];
  ints dx2 = fixed_x[2] - fixed_x[0], dy2 = fixed_y[2] - fixed_y[0];
  floats area = determinant(dx1, dy2, dx2, dy1);
  const ints back = all(0.0f) > area;
  wanted &= sign_bits(area > all(0.0f)) | (sign_bits(back) & both_sides);
  if (wanted == 0) return 0;
  // Of back sides, corners 1 and 2 are swapped.
  const floats q1 = choose(back, inverse[2], inverse[1]), q2 = choose(back, inverse[1], inverse[2]);
  store(b.x[0], fixed_x[0]);
  store(b.y[0], fixed_y[0]);
  store(b.x[1], choose(back, fixed_x[2], fixed_x[1]));
  store(b.y[1], choose(back, fixed_y[2], fixed_y[1]));
  store(b.x[2], choose(back, fixed_x[1], fixed_x[2]));
  store(b.y[2], choose(back, fixed_y[1], fixed_y[2]));
  const floats fx1 = to_floats(choose(back, dx2, dx1)), fx2 = to_floats(choose(back, dx1, dx2));
  const floats fy1 = to_floats(choose(back, dy2, dy1)), fy2 = to_floats(choose(back, dy1, dy2));
  const floats scale = all(static_cast<float>(sub_pixel)) / magnitude(area);
  const floats d1 = q1 - inverse[0], d2 = q2 - inverse[0];
  store(b.q, inverse[0]);
  store(b.step_x, (d1 * fy2 - d2 * fy1) * scale);
  store(b.step_y, (d2 * fx1 - d1 * fx2) * scale);
  store(b.least, smaller(smaller(inverse[0], q1), q2));
  store(b.most, larger(larger(inverse[0], q1), q2));
  store(b.px0, px0);
  store(b.px1, px1);
  store(b.py0, py0);
  store(b.py1, py1);
  return wanted;
}

template <pass kind>
inline void draw_block(draw_state& s, const triangle_block& block, const block_marks& marks,
                       const std::uint32_t* masked) {
  const face_frame& face = s.face;
  floats3 v[3];
  for (int c = 0; c < 3; ++c) v[c] = to_eye_space(face, load(block.x[c]), load(block.y[c]), load(block.z[c]));
  const floats near = all(near_plane);
  const floats least_z = smaller(smaller(v[0].z, v[1].z), v[2].z), most_z = larger(larger(v[0].z, v[1].z), v[2].z);
  std::uint32_t wanted = sign_bits(most_z > near) & marks.valid;
  if (wanted == 0) return;

  floats inverse[3];
  ints fixed_x[3], fixed_y[3];
  ints in_guard = least_z > near;
  const floats scale = all(face.half * static_cast<float>(sub_pixel)), guard = all(guard_band);
  const ints center_x = all(face.center_x * sub_pixel), center_y = all(face.center_y * sub_pixel);
  for (int c = 0; c < 3; ++c) {
    inverse[c] = all(1.0f) / v[c].z;
    const floats x = v[c].x * inverse[c], y = v[c].y * inverse[c];
    in_guard = in_guard & (guard > larger(magnitude(x), magnitude(y)));
    fixed_x[c] = rounded(x * scale) + center_x;
    fixed_y[c] = rounded(y * scale) + center_y;
  }
  const ints size_x =
      larger(larger(fixed_x[0], fixed_x[1]), fixed_x[2]) - smaller(smaller(fixed_x[0], fixed_x[1]), fixed_x[2]);
  const ints size_y =
      larger(larger(fixed_y[0], fixed_y[1]), fixed_y[2]) - smaller(smaller(fixed_y[0], fixed_y[1]), fixed_y[2]);
  const ints too_large = larger(size_x, size_y) > all(largest_small * sub_pixel);
  const ints too_deep = most_z > all(depth_range) * least_z;
  std::uint32_t large = wanted & ~sign_bits(without(without(in_guard, too_large), too_deep));
  wanted &= ~large;

  const auto take = [&](std::uint32_t k) {
    s.id = block.ids[k];
    s.masked = masked != nullptr ? masked[k] : nothing;
    s.lane = k;
    s.has_planes = false;
  };
  if (masked != nullptr) {
    for (int c = 0; c < 3; ++c) {
      store(s.corners[c][0], v[c].x);
      store(s.corners[c][1], v[c].y);
      store(s.corners[c][2], v[c].z);
    }
  }
  if (large != 0) {
    large &= ~outside_frustum(face, v);
    for (; large != 0; large &= large - 1) {
      const auto k = static_cast<std::uint32_t>(__builtin_ctz(large));
      take(k);
      draw_large_lane<kind>(s, v, k, (marks.both_sides >> k & 1u) != 0);
    }
  }
  if (wanted == 0) return;
  block_setup b;
  wanted = set_up(s.image, inverse, fixed_x, fixed_y, wanted, marks.both_sides, b);
  for (; wanted != 0; wanted &= wanted - 1) {
    const auto k = static_cast<std::uint32_t>(__builtin_ctz(wanted));
    take(k);
    draw_small<kind>(s, b, k);
  }
}

template <pass kind>
inline void draw_cluster(draw_state& s, const tree_view& tree, const cluster& c) {
  for (std::uint32_t i = c.first_block; i < c.first_block + c.block_count; ++i)
    draw_block<kind>(s, tree.blocks[i], tree.marks[i],
                     tree.masked != nullptr ? tree.masked + std::size_t{i} * 8 : nullptr);
}

}  // namespace
}  // namespace sightcell::bake::cpu
