#include "trace/viewpoint_region.h"

#include <algorithm>
#include <utility>

namespace sightcell::bake {
namespace {

// Returns the lower and the upper half.
std::pair<box, box> halves(const box& of) {
  const int axis = viewpoint_region::longest_axis(of);
  const float middle = viewpoint_region::middle_of(of, axis);
  box lower = of, upper = of;
  lower.max[axis] = middle;
  upper.min[axis] = middle;
  return {lower, upper};
}

}  // namespace

int viewpoint_region::longest_axis(const box& node) {
  const glm::vec3 size = node.max - node.min;
  int axis = 0;
  for (int other = 1; other < 3; ++other)
    if (size[other] > size[axis]) axis = other;
  return axis;
}

bool viewpoint_region::can_split(const box& node, int depth) {
  const int axis = longest_axis(node);
  const float middle = middle_of(node, axis);
  return depth < deepest && middle > node.min[axis] && middle < node.max[axis];
}

void viewpoint_region::add(kind what, const box& at, int depth) {
  nodes_.push_back(what);
  if (what == kind::split) return;
  std::vector<leaf>& leaves = what == kind::inside ? inside_ : outside_;
  leaves.push_back({at, (leaves.empty() ? 0 : leaves.back().end) + (std::uint64_t{1} << (deepest - depth))});
}

viewpoint_region viewpoint_region::build(const box& whole,
                                         const std::function<kind(const box& node, int depth)>& decide) {
  viewpoint_region region(whole);
  const auto visit = [&](const auto& self, const box& at, int depth) -> void {
    kind what = decide(at, depth);
    if (what == kind::split && !can_split(at, depth)) what = kind::inside;
    region.add(what, at, depth);
    if (what != kind::split) return;
    const auto [lower, upper] = halves(at);
    self(self, lower, depth + 1);
    self(self, upper, depth + 1);
  };
  visit(visit, whole, 0);
  if (region.nodes_.size() == 1 && region.nodes_.front() == kind::inside) return viewpoint_region(whole);
  region.share_ = region.inside_.empty() ? 0.0
                                         : static_cast<double>(region.inside_.back().end) /
                                               static_cast<double>(std::uint64_t{1} << deepest);
  return region;
}

std::vector<std::uint8_t> viewpoint_region::encode() const {
  std::vector<std::uint8_t> bytes((nodes_.size() + 3) / 4);
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    bytes[i / 4] |= static_cast<std::uint8_t>(static_cast<unsigned>(nodes_[i]) << (2 * (i % 4)));
  return bytes;
}

std::optional<viewpoint_region> viewpoint_region::decode(const box& whole, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return viewpoint_region(whole);
  std::size_t next = 0;
  bool good = true;
  viewpoint_region region = build(whole, [&](const box& node, int depth) {
    if (next >= 4 * bytes.size()) good = false;
    const unsigned bits = good ? bytes[next / 4] >> (2 * (next % 4)) & 3u : 0u;
    ++next;
    if (bits == 3 || (bits == 2 && !can_split(node, depth))) good = false;
    return good ? static_cast<kind>(bits) : kind::outside;
  });
  if (!good || region.is_whole() || region.inside_.empty()) return std::nullopt;
  if (region.encode().size() != bytes.size() || !std::equal(bytes.begin(), bytes.end(), region.encode().begin()))
    return std::nullopt;
  return region;
}

std::vector<box> viewpoint_region::parts() const {
  if (is_whole()) return {whole_};
  std::vector<box> found;
  for (const leaf& one : inside_) found.push_back(one.at);
  return found;
}

std::vector<box> viewpoint_region::rest() const {
  std::vector<box> found;
  for (const leaf& one : outside_) found.push_back(one.at);
  return found;
}

bool viewpoint_region::contains(const glm::vec3& point) const {
  if (is_whole()) return true;
  std::size_t node = 0;
  box at = whole_;
  // Steps over the lower half of a split: the nodes up to the one that completes its subtree.
  const auto after_subtree = [&](std::size_t first) {
    std::size_t open = 1;
    while (open > 0) open = nodes_[first++] == kind::split ? open + 1 : open - 1;
    return first;
  };
  while (nodes_[node] == kind::split) {
    const int axis = longest_axis(at);
    const auto [lower, upper] = halves(at);
    ++node;
    if (point[axis] < upper.min[axis]) {
      at = lower;
    } else {
      at = upper;
      node = after_subtree(node);
    }
  }
  return nodes_[node] == kind::inside;
}

glm::vec3 viewpoint_region::draw_of(const std::vector<leaf>& leaves, random_stream& random) {
  // The volumes are whole numbers below 2^18, so 24 random bits choose each leaf almost in proportion to its volume:
  // the shares are off by less than 2^-24 of the region.
  const auto unit =
      static_cast<std::uint64_t>(static_cast<double>(random.uniform()) * static_cast<double>(leaves.back().end));
  const auto chosen = std::upper_bound(leaves.begin(), leaves.end(), unit,
                                       [](std::uint64_t at, const leaf& one) { return at < one.end; });
  return random.in_box(chosen->at.min, chosen->at.max);
}

glm::vec3 viewpoint_region::draw(random_stream& random) const {
  return is_whole() ? random.in_box(whole_.min, whole_.max) : draw_of(inside_, random);
}

glm::vec3 viewpoint_region::draw_outside(random_stream& random) const {
  return draw_of(outside_, random);
}

}  // namespace sightcell::bake
