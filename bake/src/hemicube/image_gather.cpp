#include "hemicube/image_gather.h"

#include <algorithm>
#include <bit>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {
namespace {

// Eight partial sums. The chains of additions are short enough for an accuracy of about 1e-6, and the compiler can use
// SIMD.
struct lane_sum {
  static constexpr std::uint32_t lanes = 8;
  float lane[lanes] = {};
  double total() const {
    double sum = 0.0;
    for (const float v : lane) sum += static_cast<double>(v);
    return sum;
  }
};

// Calls term(x, lane) for all x below count. Consecutive x go to consecutive lanes.
template <class Term>
void over_row(std::uint32_t count, const Term& term) {
  std::uint32_t x = 0;
  for (; x + lane_sum::lanes <= count; x += lane_sum::lanes) {
    for (std::uint32_t k = 0; k < lane_sum::lanes; ++k) term(x + k, k);
  }
  for (; x < count; ++x) term(x, 0);
}

}  // namespace

image_gather::image_gather(std::uint32_t polygon_count) : counts_(polygon_count), found_((polygon_count + 63) / 64) {}

void image_gather::add(std::uint32_t id, std::uint32_t pixels, std::uint32_t first) {
  count& c = counts_[id];
  c.first = c.pixels == 0 ? first : std::min(c.first, first);
  c.pixels += pixels;
  found_[id / 64] |= std::uint64_t{1} << (id % 64);
}

bool image_gather::list(std::span<const std::uint32_t> ids, std::vector<seen_polygon>& seen) {
  const bool known = count_pixels(ids);
  list_found(seen);  // after a failure too, because it clears the counts
  return known;
}

void image_gather::sum(std::span<const face_view, face_count> faces, std::span<const float> depths, float at_far_plane,
                       std::array<double, 4>& importance) {
  importance = {};
  const std::size_t stride = 3 * std::size_t{faces[face_front].width};
  for (const face_view& face : faces)
    add_importance(&depths[face.y * stride + face.x], stride, face, at_far_plane, importance);
}

bool image_gather::count_pixels(std::span<const std::uint32_t> ids) {
  for (std::size_t i = 0; i < ids.size();) {
    const std::uint32_t id = ids[i];
    std::size_t end = i + 1;
    while (end < ids.size() && ids[end] == id) ++end;
    if (id != scene::no_index) {
      if (id >= counts_.size()) return false;
      add(id, static_cast<std::uint32_t>(end - i), static_cast<std::uint32_t>(i));
    }
    i = end;
  }
  return true;
}

// Lists the counted polygons and clears the counts for the next hemicube. The bits give ascending ids without sorting.
void image_gather::list_found(std::vector<seen_polygon>& seen) {
  seen.clear();
  for (std::size_t word = 0; word < found_.size(); ++word) {
    for (std::uint64_t bits = found_[word]; bits != 0; bits &= bits - 1) {
      const auto id = static_cast<std::uint32_t>(word * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
      seen.push_back({id, counts_[id].pixels, counts_[id].first});
      counts_[id] = {};
    }
    found_[word] = 0;
  }
}

// Adds the importance of one face. depths points at its lower left pixel. With q = c / depth, clamped to at_far_plane,
// the gap (d(n) - d) / d is (1/q(n) - 1/q) q for any constant c.
void image_gather::add_importance(const float* depths, std::size_t stride, const face_view& face, float at_far_plane,
                                  std::array<double, 4>& importance) {
  const std::uint32_t width = face.width, height = face.height;
  for (std::vector<float>* row : {&q_, &inverse_, &q_below_, &inverse_below_, &weight_}) row->resize(width);
  for (std::uint32_t x = 0; x < width; ++x) {
    weight_[x] = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
  }
  for (std::uint32_t y = 0; y < height; ++y, depths += stride) {
    q_.swap(q_below_);
    inverse_.swap(inverse_below_);
    float *q = q_.data(), *inverse = inverse_.data();
    const float* weight = weight_.data();
    for (std::uint32_t x = 0; x < width; ++x) {
      q[x] = std::max(depths[x], at_far_plane);
      inverse[x] = 1.0f / q[x];
    }
    lane_sum right, left;
    over_row(width - 1, [&](std::uint32_t x, std::uint32_t k) {
      const float further = inverse[x + 1] - inverse[x];
      right.lane[k] += weight[x] * std::max(0.0f, further * q[x]);
      left.lane[k] += (1.0f - weight[x + 1]) * std::max(0.0f, -further * q[x + 1]);
    });
    importance[toward_right] += right.total();
    importance[toward_left] += left.total();
    if (y == 0) continue;

    const float *q_below = q_below_.data(), *inverse_below = inverse_below_.data();
    lane_sum up, down;
    over_row(width, [&](std::uint32_t x, std::uint32_t k) {
      const float further = inverse[x] - inverse_below[x];
      up.lane[k] += std::max(0.0f, further * q_below[x]);
      down.lane[k] += std::max(0.0f, -further * q[x]);
    });
    const double rows = height;
    importance[toward_up] += (y - 0.5) / rows * up.total();              // for the pixels of row y - 1
    importance[toward_down] += (1.0 - (y + 0.5) / rows) * down.total();  // for those of row y
  }
}

}  // namespace sightcell::bake
