#include "sampler/segment_cells.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "trace/line_box.h"

namespace sightcell::bake {
namespace {

constexpr double most_voxels = 4 << 20;
constexpr float slack = 1e-3f;  // of a voxel: margin for rounding

bool clip(const box& within, const glm::vec3& eye, const glm::vec3& direction, float& from, float& to) {
  return clip_line(within.min, within.max, eye, direction, from, to) && from < to;
}

}  // namespace

segment_cells::segment_cells(std::vector<box> cells) : cells_(std::move(cells)) {
  if (cells_.empty()) return;
  all_ = cells_.front();
  glm::dvec3 mean{0.0};
  for (const box& cell : cells_) {
    all_ = {glm::min(all_.min, cell.min), glm::max(all_.max, cell.max)};
    mean += glm::dvec3(cell.max - cell.min) / static_cast<double>(cells_.size());
  }
  const glm::dvec3 extent(all_.max - all_.min);
  double voxels = 1.0;
  for (int axis = 0; axis < 3; ++axis) voxels *= std::max(1.0, extent[axis] / std::max(mean[axis], 1e-6));
  const double coarser = std::cbrt(std::max(1.0, voxels / most_voxels));
  for (int axis = 0; axis < 3; ++axis) {
    const double along = extent[axis] / std::max(mean[axis] * coarser, 1e-6);
    count_[static_cast<std::size_t>(axis)] = static_cast<int>(std::clamp(std::ceil(along), 1.0, 4096.0));
    const auto n = static_cast<float>(count_[static_cast<std::size_t>(axis)]);
    size_[axis] = std::max((all_.max[axis] - all_.min[axis]) / n, std::numeric_limits<float>::min());
  }
  begins_.assign(number_of({count_[0] - 1, count_[1] - 1, count_[2] - 1}) + 2, 0);
  for (const box& cell : cells_) for_each_voxel(cell, [&](std::size_t v) { ++begins_[v + 1]; });
  for (std::size_t v = 1; v < begins_.size(); ++v) begins_[v] += begins_[v - 1];
  members_.resize(begins_.back());
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
  for (std::uint32_t cell = 0; cell < cells_.size(); ++cell)
    for_each_voxel(cells_[cell], [&](std::size_t v) { members_[next[v]++] = cell; });
}

segment_cells::voxel segment_cells::voxel_of(const glm::vec3& point) const {
  voxel v{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const float place = (point[axis] - all_.min[axis]) / size_[axis];
    v[a] = static_cast<int>(std::clamp(place, 0.0f, static_cast<float>(count_[a] - 1)));
  }
  return v;
}

template <typename Visit>
void segment_cells::for_each_voxel(const box& of, Visit visit) const {
  const voxel low = voxel_of(of.min - size_ * slack), high = voxel_of(of.max + size_ * slack);
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) visit(number_of({x, y, z}));
}

void segment_cells::find(const glm::vec3& eye, const glm::vec3& direction, float from, float to,
                         std::vector<crossing>& out) const {
  out.clear();
  if (cells_.empty() || !clip(all_, eye, direction, from, to)) return;
  // Voxel by voxel: along each axis the parameter at which the next voxel begins (Amanatides and Woo 1987).
  voxel at = voxel_of(eye + direction * from);
  std::array<float, 3> next{}, step{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const float d = direction[axis];
    next[a] = step[a] = std::numeric_limits<float>::infinity();
    if (d == 0.0f) continue;
    const float border = all_.min[axis] + size_[axis] * static_cast<float>(at[a] + (d > 0.0f ? 1 : 0));
    next[a] = (border - eye[axis]) / d;
    step[a] = size_[axis] / std::abs(d);
  }
  for (;;) {
    const std::size_t v = number_of(at);
    for (std::uint32_t i = begins_[v]; i < begins_[v + 1]; ++i) out.push_back({members_[i], from, to});
    const auto axis = static_cast<std::size_t>(std::min_element(next.begin(), next.end()) - next.begin());
    if (next[axis] > to) break;
    at[axis] += direction[static_cast<int>(axis)] > 0.0f ? 1 : -1;
    if (at[axis] < 0 || at[axis] >= count_[axis]) break;
    next[axis] += step[axis];
  }
  std::sort(out.begin(), out.end(), [](const crossing& a, const crossing& b) { return a.cell < b.cell; });
  out.erase(std::unique(out.begin(), out.end(), [](const crossing& a, const crossing& b) { return a.cell == b.cell; }),
            out.end());
  std::erase_if(out, [&](crossing& c) { return !clip(cells_[c.cell], eye, direction, c.from, c.to); });
}

}  // namespace sightcell::bake
