#include "viewpoint_samples.h"

#include <algorithm>
#include <array>
#include <string>

#include "random_source.h"

namespace sightcell::test {
namespace {

constexpr std::uint32_t deepest = 18;

// Halves the longest side. False where two floats meet.
bool halve(const format::box& whole, format::box& lower, format::box& upper) {
  std::array<float, 3> sides{};
  for (std::size_t axis = 0; axis < 3; ++axis) sides[axis] = whole.max[axis] - whole.min[axis];
  const auto axis = static_cast<std::size_t>(std::max_element(sides.begin(), sides.end()) - sides.begin());
  const float middle = 0.5f * (whole.min[axis] + whole.max[axis]);
  lower = upper = whole;
  lower.max[axis] = upper.min[axis] = middle;
  return whole.min[axis] < middle && middle < whole.max[axis];
}

class tree_maker {
 public:
  tree_maker(std::uint32_t seed, bool deep) : random_(seed), deep_(deep) {}

  // goes_on: of a deep tree, whether the node is on the way to the deepest leaf.
  void grow(const format::box& bounds, std::uint32_t depth, bool goes_on) {
    format::box lower;
    format::box upper;
    const bool wanted = deep_ ? goes_on && depth < deepest : depth == 0 || (depth < 6 && random_.below(8) > depth + 1);
    if (wanted && halve(bounds, lower, upper)) {
      nodes_ += '2';
      const bool to_lower = random_.below(2) == 0;
      grow(lower, depth + 1, to_lower);
      grow(upper, depth + 1, !to_lower);
      return;
    }
    const bool inside = random_.below(2) == 0;
    nodes_ += inside ? '1' : '0';
    parts_.push_back({bounds, inside});
  }

  sample_region take() {
    if (nodes_.size() == 1) return {{}, {{parts_[0].bounds, true}}};
    if (nodes_.find('1') == std::string::npos) {
      nodes_.back() = '1';  // the last node is a leaf
      parts_.back().inside = true;
    }
    return {packed_nodes(nodes_), std::move(parts_)};
  }

 private:
  random_source random_;
  bool deep_;
  std::string nodes_;
  std::vector<format::region_part> parts_;
};

}  // namespace

std::vector<std::byte> packed_nodes(std::string_view nodes) {
  std::vector<std::byte> bytes((nodes.size() + 3) / 4);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    bytes[i / 4] |= static_cast<std::byte>(static_cast<unsigned>(nodes[i] - '0') << 2 * (i % 4));
  return bytes;
}

sample_region make_region(std::uint32_t seed, const format::box& grown) {
  if (seed % 4 == 0) return {{}, {{grown, true}}};
  tree_maker maker(seed, seed % 4 == 3);
  maker.grow(grown, 0, true);
  return maker.take();
}

void add_viewpoints(sample_contents& contents, std::uint32_t seed) {
  random_source random(seed);
  contents.player_radius = contents.cells.empty() ? 0.0f : 0.05f;
  contents.viewpoints.clear();
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    const format::box grown = format::grown_box(contents.cells[cell], contents.facts.margin);
    format::viewpoint_record record{.cell = cell, .region = make_region(seed + cell, grown).bytes};
    record.valid_share = static_cast<float>(1 + random.below(1000)) / 1000.0f;
    const auto outside = static_cast<float>(random.below(1000)) / 100000.0f;
    if (!record.region.empty()) record.outside_share = static_cast<double>(outside);
    contents.viewpoints.push_back(std::move(record));
  }
}

void add_eyes(sample_contents& contents, std::uint32_t seed) {
  random_source random(seed);
  for (format::viewpoint_record& record : contents.viewpoints) {
    record.eyes.resize(random.below(9));
    for (format::eye_steps& eye : record.eyes) {
      for (std::uint16_t& steps : eye) steps = static_cast<std::uint16_t>(random.below(4096));
    }
  }
  if (!contents.viewpoints.empty()) contents.viewpoints[0].eyes = {{0, 0, 0}, {4095, 4095, 4095}};
}

}  // namespace sightcell::test
