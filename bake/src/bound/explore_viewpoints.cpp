#include "bound/explore_viewpoints.h"

#include <algorithm>
#include <span>
#include <utility>

#include "bound/clopper_pearson.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

constexpr double common = 0.25;            // a box with this share of valid points needs no region
constexpr std::uint64_t own_tests = 4096;  // points of the view cell itself
constexpr std::size_t fewest_of_own = 2;   // valid ones among them, or the cell is left out
constexpr std::uint64_t first_tests = 1024, most_first_tests = 8192;  // all over the box
constexpr std::size_t valid_for_tree = 24;                            // valid points with which the first tree is made
constexpr std::uint64_t later_tests = 512;                            // in the region, before it is split again
constexpr int rounds = 3;                                             // of splitting and testing
constexpr std::uint64_t most_in_region = 32;                          // tests per viewpoint of the region
constexpr float smallest_side = 0.1f;                                 // meters: leaves are not split further
constexpr std::size_t fewest_to_split = 12, fewest_to_exclude = 10;   // tested points of a node
constexpr double risk_outside = 0.05 / rounds;  // of each bound of what lies outside; the last one is used

struct tested_point {
  glm::vec3 at{0.0f};
  bool valid = false;
};

// Returns the number of points to test in what a region leaves out: the fewer valid points there are inside, the less
// of the rest may be valid. With this number about 3 % of all valid points is what the bound allows outside.
std::uint64_t outside_tests(const viewpoint_region& region, std::span<const tested_point> points) {
  double tested = 0.0, valid = 0.0;
  for (const tested_point& p : points)
    if (region.contains(p.at)) tested += 1.0, valid += p.valid ? 1.0 : 0.0;
  const double inside = std::max(region.share() * valid / std::max(tested, 1.0), 1e-6);
  return static_cast<std::uint64_t>(std::clamp(128.0 / inside, 1024.0, 8192.0));
}

// Tests `count` points and appends them.
template <typename Draw>
std::size_t test_points(const ray_scene& rays, float radius, std::uint64_t count, const Draw& draw,
                        std::vector<tested_point>& points) {
  std::vector<glm::vec3> at(count);
  for (glm::vec3& p : at) p = draw();
  std::vector<std::uint8_t> valid(count);
  rays.find_valid(at, radius, valid);
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back({at[i], valid[i] != 0});
    found += valid[i];
  }
  return found;
}

// Returns the tree whose leaves inside have valid points: most of those tested, or too few to split further.
viewpoint_region region_of(const box& whole, std::vector<tested_point> points) {
  using kind = viewpoint_region::kind;
  // The points of the nodes that follow in preorder, the next one at the end.
  std::vector<std::span<tested_point>> open{std::span(points)};
  return viewpoint_region::build(whole, [&](const box& node, int depth) {
    const std::span<tested_point> here = open.back();
    open.pop_back();
    const auto valid = static_cast<std::size_t>(
        std::count_if(here.begin(), here.end(), [](const tested_point& p) { return p.valid; }));
    if (valid == 0) return here.size() < fewest_to_exclude ? kind::inside : kind::outside;
    const int axis = viewpoint_region::longest_axis(node);
    const bool small = node.max[axis] - node.min[axis] <= smallest_side || !viewpoint_region::can_split(node, depth);
    if (small || 4 * valid >= 3 * here.size() || here.size() < fewest_to_split) return kind::inside;
    const float middle = viewpoint_region::middle_of(node, axis);
    const auto upper =
        std::partition(here.begin(), here.end(), [&](const tested_point& p) { return p.at[axis] < middle; });
    open.emplace_back(upper, here.end());
    open.emplace_back(here.begin(), upper);
    return kind::split;
  });
}

}  // namespace

std::optional<cell_viewpoints> explore_viewpoints(const ray_scene& rays, const explored_cell& cell,
                                                  random_stream& random, std::uint64_t& tests) {
  // The runtime looks up the cell by its own box. It uses the margin only for a camera that leaves the box. So only the
  // box without margin decides whether the cell is stored.
  std::uint64_t tries = 0;
  std::vector<glm::vec3> own = draw_viewpoints(rays, cell.own, cell.radius, 1, own_tests, random, tries);
  if (own.empty()) return tests += tries, std::nullopt;

  cell_viewpoints found{.region = cell.grown, .viewpoints = {}, .own = own};
  std::uint64_t tried = 0;
  const auto most = static_cast<std::uint64_t>(static_cast<double>(cell.wanted) / common);
  found.viewpoints = draw_viewpoints(rays, cell.grown, cell.radius, cell.wanted, most, random, tried);
  found.valid_share = static_cast<double>(found.viewpoints.size()) / static_cast<double>(tried);
  if (found.viewpoints.size() == cell.wanted) return tests += tries + tried, found;

  // Valid points are rare.
  while (own.size() < fewest_of_own && tries < own_tests) {
    const auto more = draw_viewpoints(rays, cell.own, cell.radius, 1, own_tests - tries, random, tries);
    own.insert(own.end(), more.begin(), more.end());
  }
  tests += tries + tried;
  if (own.size() < fewest_of_own) return std::nullopt;
  found.own = own;

  std::vector<tested_point> points;
  for (const glm::vec3& eye : own) points.push_back({eye, true});
  std::size_t valid = 0;
  for (std::uint64_t tested = 0; tested < most_first_tests && valid < valid_for_tree; tested += first_tests)
    valid += test_points(
        rays, cell.radius, first_tests, [&] { return random.in_box(cell.grown.min, cell.grown.max); }, points);
  found.region = region_of(cell.grown, points);
  for (int round = 0; round < rounds && !found.region.is_whole(); ++round) {
    const std::size_t now = test_points(
        rays, cell.radius, later_tests, [&] { return found.region.draw(random); }, points);
    found.region = region_of(cell.grown, points);
    if (2 * now >= later_tests) break;
  }
  for (int round = 0; round < rounds && !found.region.is_whole(); ++round) {
    const std::uint64_t count = outside_tests(found.region, points);
    const std::size_t outside = test_points(
        rays, cell.radius, count, [&] { return found.region.draw_outside(random); }, points);
    found.outside_share = clopper_pearson_upper(outside, count, 1.0 - risk_outside) * (1.0 - found.region.share());
    if (outside == 0 || round + 1 == rounds) break;
    found.region = region_of(cell.grown, points);
  }
  tests += points.size() - own.size();

  tried = 0;
  found.viewpoints =
      draw_viewpoints(rays, found.region, cell.radius, cell.wanted, most_in_region * cell.wanted, random, tried);
  tests += tried;
  // Valid points that are scattered among invalid ones in all parts of the box: the votes of a point beyond the border
  // of the scene, where backs fill much of the view, come out either way.
  if (found.viewpoints.size() < cell.wanted) return std::nullopt;
  found.valid_share = static_cast<double>(found.viewpoints.size()) / static_cast<double>(tried);
  const double inside = found.valid_share * found.region.share();
  if (!found.region.is_whole()) found.outside_share /= found.outside_share + inside;
  return found;
}

}  // namespace sightcell::bake
