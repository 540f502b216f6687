#pragma once
// Counts the pixels per polygon of a face and sums its importance.
#include "hemicube/cpu/tiles.h"

namespace sightcell::bake::cpu {
namespace {

// Bits of the pixels of a tile that are inside the kept part, row by row.
inline std::uint64_t kept_pixels(const face_frame& face, std::uint32_t tile_x, std::uint32_t tile_y) {
  const std::uint32_t x = tile_x * tile_size, y = tile_y * tile_size;
  std::uint64_t bits = ~std::uint64_t{0};
  if (x + tile_size > face.width) bits &= 0x0101010101010101u * (0xFFu >> (x + tile_size - face.width));
  if (y + tile_size > face.height) bits &= ~std::uint64_t{0} >> (tile_size * (y + tile_size - face.height));
  return bits;
}

inline std::uint64_t pixels_equal(const ints (&rows)[tile_size], std::uint32_t id) {
  const ints wanted = all(static_cast<std::int32_t>(id));
  std::uint64_t bits = 0;
  for (std::uint32_t j = 0; j < tile_size; ++j) {
    bits |= std::uint64_t{sign_bits(rows[j] == wanted)} << (tile_size * j);
  }
  return bits;
}

inline void gather_tile(const face_frame& face, const polygon_counter& counter, const std::uint32_t* ids,
                        std::uint32_t tile_x, std::uint32_t tile_y) {
  ints rows[tile_size];
  for (std::uint32_t j = 0; j < tile_size; ++j) rows[j] = load(ids + j * tile_size);
  const auto add = [&](std::uint32_t id, std::uint64_t bits) {
    const auto first = static_cast<std::uint32_t>(__builtin_ctzll(bits));
    count(counter, id, static_cast<std::uint32_t>(__builtin_popcountll(bits)),
          atlas_pixel(face, tile_x * tile_size + first % tile_size, tile_y * tile_size + first / tile_size));
  };
  std::uint64_t left = kept_pixels(face, tile_x, tile_y);
  ints same = rows[0] == all(static_cast<std::int32_t>(ids[0]));
  for (std::uint32_t j = 1; j < tile_size; ++j) same = same & (rows[j] == rows[0]);
  if (sign_bits(same) == 0xFFu) {
    if (ids[0] != nothing) add(ids[0], left);
    return;
  }
  // Most tiles show a few polygons. In tiles with many, the remaining pixels are counted one by one.
  for (int found = 0; found < 12 && left != 0; ++found) {
    const std::uint32_t id = ids[__builtin_ctzll(left)];
    const std::uint64_t bits = pixels_equal(rows, id) & left;
    left &= ~bits;
    if (id != nothing) add(id, bits);
  }
  for (; left != 0; left &= left - 1) {
    const std::uint32_t id = ids[__builtin_ctzll(left)];
    if (id != nothing) add(id, left & (~left + 1));
  }
}

inline void gather_face(const face_frame& face, const tile_image& image, const polygon_counter& counter) {
  for (std::uint32_t y = 0; y < image.tiles_y; ++y)
    for (std::uint32_t x = 0; x < image.tiles_x; ++x) {
      const std::uint32_t tile = y * image.stride + x;
      if (image.states[tile] != tile_state::empty)
        gather_tile(face, counter, image.ids + std::size_t{tile} * tile_pixels, x, y);
    }
}

inline float sum_of(const floats& a) {
  alignas(32) float lane[8];
  store(lane, a);
  return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

// Sums the importance of a face. With d = depth / far, the gap between a pixel and its neighbor is
// max(0, d(neighbor) - d) / d, so of two neighbors only the nearer one has a gap. With inverse depths q, clamped to
// 1 / far, the gap is (1/q(neighbor) - 1/q) q.
class importance_walk {
 public:
  importance_walk(const face_frame& face, const tile_image& image, float far_plane, importance_sums& sums)
      : face_(face),
        image_(image),
        least_q_(1.0f / far_plane),
        sums_(sums),
        below_q_(sums.row_below),
        below_inverse_(sums.row_below + image.tiles_x * tile_size) {}

  void run() {
    for (std::uint32_t tile_y = 0; tile_y < image_.tiles_y; ++tile_y) {
      row_ = {all(0.0f), all(0.0f), all(0.0f), all(0.0f)};
      left_empty_ = true;
      for (std::uint32_t j = 0; j < tile_size; ++j) {
        left_q_[j] = all(least_q_);
        left_inverse_[j] = all(1.0f) / left_q_[j];
      }
      for (std::uint32_t tile_x = 0; tile_x < image_.tiles_x; ++tile_x) run_tile(tile_x, tile_y);
      // Sums of a row of tiles are floats, sums of the face are doubles.
      sums_.right += static_cast<double>(sum_of(row_.right));
      sums_.up += static_cast<double>(sum_of(row_.up));
      sums_.left += static_cast<double>(sum_of(row_.left));
      sums_.down += static_cast<double>(sum_of(row_.down));
    }
  }

 private:
  struct sums4 {
    floats right, up, left, down;
  };

  void run_tile(std::uint32_t tile_x, std::uint32_t tile_y) {
    const std::uint32_t tile = tile_y * image_.stride + tile_x;
    const bool empty = image_.states[tile] == tile_state::empty;
    const bool below_empty = tile_y > 0 && image_.states[tile - image_.stride] == tile_state::empty;
    if (empty && left_empty_ && below_empty) return;  // the stored rows are the same as those of this tile
    left_empty_ = empty;
    const std::uint32_t x = tile_x * tile_size, y = tile_y * tile_size;
    const std::uint32_t rows = y + tile_size <= face_.height ? tile_size : face_.height - y;
    const float* depths = image_.inverse_depths + std::size_t{tile} * tile_pixels;

    // A pair of neighbors is processed at its right or upper pixel. Its weights are 0 outside of the kept part.
    const floats at = to_floats(count_up() + all(static_cast<std::int32_t>(x)));
    const floats zero = all(0.0f), one = all(1.0f), width = all(static_cast<float>(face_.width));
    const ints inside = width > at, has_left = inside & (at > zero);
    const floats weight_right = choose(has_left, (at - all(0.5f)) / width, zero);
    const floats weight_left = choose(has_left, one - (at + all(0.5f)) / width, zero);
    const floats kept = choose(inside, one, zero);
    const float height = static_cast<float>(face_.height);

    floats below_q = load(below_q_ + x), below_inverse = load(below_inverse_ + x);
    for (std::uint32_t j = 0; j < rows; ++j) {
      const floats q = empty ? all(least_q_) : larger(load(depths + j * tile_size), all(least_q_));
      const floats inverse = one / q;
      const floats beside_q = shifted_in(left_q_[j], q);
      const floats across = inverse - shifted_in(left_inverse_[j], inverse);
      row_.right = row_.right + weight_right * larger(across * beside_q, zero);
      row_.left = row_.left + weight_left * larger((zero - across) * q, zero);
      left_q_[j] = q;
      left_inverse_[j] = inverse;
      if (y + j > 0) {
        const floats up = inverse - below_inverse;
        const float middle = static_cast<float>(y + j);
        row_.up = row_.up + kept * all((middle - 0.5f) / height) * larger(up * below_q, zero);
        row_.down = row_.down + kept * all(1.0f - (middle + 0.5f) / height) * larger((zero - up) * q, zero);
      }
      below_q = q;
      below_inverse = inverse;
    }
    store(below_q_ + x, below_q);
    store(below_inverse_ + x, below_inverse);
  }

  const face_frame& face_;
  const tile_image& image_;
  float least_q_;
  importance_sums& sums_;
  // The top row of pixels of the tiles below, and all rows of the tile on the left.
  float *below_q_, *below_inverse_;
  floats left_q_[tile_size], left_inverse_[tile_size];
  bool left_empty_ = true;
  sums4 row_;
};

}  // namespace
}  // namespace sightcell::bake::cpu
