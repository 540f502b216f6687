#include "sampler/uniform_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sightcell::bake {
namespace {

// Returns the number with its binary digits mirrored: neighbors on the grid get numbers far from each other, so that
// a face whose time ends early is covered all the same.
std::uint32_t mirrored(std::uint32_t number) {
  std::uint32_t out = 0;
  for (int bit = 0; bit < 32; ++bit) out = out << 1 | (number >> bit & 1);
  return out;
}

}  // namespace

uniform_grid::uniform_grid(const glm::vec2& face_size, std::uint32_t samples) {
  samples = std::max(samples, 1u);
  const double aspect = static_cast<double>(face_size.y) / std::max(static_cast<double>(face_size.x), 1e-6);
  const auto rows = static_cast<std::uint32_t>(
      std::clamp(std::round(std::sqrt(samples * aspect)), 1.0, static_cast<double>(samples)));
  std::vector<glm::vec2> grid;
  for (std::uint32_t row = 0; row < rows; ++row) {
    const std::uint32_t columns = samples * (row + 1) / rows - samples * row / rows;  // together all samples
    for (std::uint32_t column = 0; column < columns; ++column)
      grid.emplace_back((static_cast<float>(column) + 0.5f) / static_cast<float>(columns),
                        (static_cast<float>(row) + 0.5f) / static_cast<float>(rows));
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < samples; ++i) order.emplace_back(mirrored(i), i);
  std::sort(order.begin(), order.end());
  for (const auto& [key, i] : order) positions_.push_back(grid[i]);
}

std::optional<glm::vec2> uniform_grid::next() {
  if (next_ == positions_.size()) return std::nullopt;
  return positions_[next_++];
}

}  // namespace sightcell::bake
