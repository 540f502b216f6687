#include <algorithm>
#include <bit>

#include "shared/hemicube_layout.h"
#include "sightcell/scene/error.h"
#include "source/gpu_gather.h"

namespace sightcell::bake {
namespace {

// Sums in eight lanes: short enough chains to be exact to about 1e-6, and the compiler can use vector registers.
struct lane_sum {
  static constexpr std::uint32_t lanes = 8;
  float lane[lanes] = {};
  double total() const {
    double sum = 0.0;
    for (const float v : lane) sum += static_cast<double>(v);
    return sum;
  }
};

// Calls term(x, lane) for all x, lane by lane.
template <class Term>
void over_row(std::uint32_t count, const Term& term) {
  std::uint32_t x = 0;
  for (; x + lane_sum::lanes <= count; x += lane_sum::lanes) {
    for (std::uint32_t k = 0; k < lane_sum::lanes; ++k) term(x + k, k);
  }
  for (; x < count; ++x) term(x, 0);
}

class gather_read_back final : public gpu_gather {
 public:
  gather_read_back(std::uint32_t polygon_count, polygon_counts* marked)
      : marked_(marked), counts_(polygon_count), found_((polygon_count + 63) / 64) {}

  void run(const hemicube_atlas& atlas, std::span<const face_view, face_count> faces, hemicube_view& view) override {
    const std::uint32_t s = atlas.resolution;
    ids_.resize(3 * std::size_t{s} * s);
    depths_.resize(ids_.size());
    read_atlas(atlas, ids_, depths_);
    count_pixels();
    if (marked_ != nullptr) {
      marked_->collect(marked_list_, no_sums_);
      for (const seen_polygon& p : marked_list_) add(p.id, p.pixels, p.pixel);
    }
    list_found(view.seen);

    view.importance = {};
    for (const face_view& face : faces) {
      add_importance(&depths_[face.y * std::size_t{3} * s + face.x], 3 * std::size_t{s}, face, atlas.near_over_far,
                     view.importance);
    }
  }

 private:
  void add(std::uint32_t id, std::uint32_t pixels, std::size_t first) {
    count& c = counts_[id];
    if (c.pixels == 0) c.first = static_cast<std::uint32_t>(first);
    c.pixels += pixels;
    found_[id / 64] |= std::uint64_t{1} << (id % 64);
  }

  void count_pixels() {
    for (std::size_t i = 0; i < ids_.size();) {
      const std::uint32_t id = ids_[i];
      std::size_t end = i + 1;
      while (end < ids_.size() && ids_[end] == id) ++end;
      if (id != shaders::hemicube_background) {
        if (id >= counts_.size()) {
          throw error(error_kind::failed, "gl.error", "OpenGL source", "the device drew a polygon that does not exist",
                      "use another source and report this with the name of your graphics driver");
        }
        add(id, static_cast<std::uint32_t>(end - i), i);
      }
      i = end;
    }
  }

  // The bits give ascending ids without sorting. Leaves everything 0 for the next hemicube.
  void list_found(std::vector<seen_polygon>& seen) {
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

  // One face; depths points at its lower left pixel. With q = near / (far d) and 1/q the gap (d(n) - d) / d becomes
  // (1/q(n) - 1/q) q.
  void add_importance(const float* depths, std::size_t stride, const face_view& face, float near_over_far,
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
        q[x] = std::max(depths[x], near_over_far);
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

  polygon_counts* marked_;
  struct count {
    std::uint32_t pixels = 0, first = 0;
  };
  std::vector<count> counts_;         // by source id; all 0 between hemicubes
  std::vector<std::uint64_t> found_;  // a bit per source id with pixels
  std::vector<std::uint32_t> ids_;
  std::vector<float> depths_;
  std::vector<seen_polygon> marked_list_;
  std::vector<float> no_sums_;
  std::vector<float> q_, inverse_, q_below_, inverse_below_, weight_;  // a row of pixels, and the one below it
};

}  // namespace

void read_atlas(const hemicube_atlas& atlas, std::span<std::uint32_t> ids, std::span<float> depths) {
  const auto width = static_cast<GLsizei>(3 * atlas.resolution), height = static_cast<GLsizei>(atlas.resolution);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, atlas.framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, ids.data());
  glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
}

std::unique_ptr<gpu_gather> make_gather_read_back(std::uint32_t polygon_count, polygon_counts* marked) {
  return std::make_unique<gather_read_back>(polygon_count, marked);
}

}  // namespace sightcell::bake
