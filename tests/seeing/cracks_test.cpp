// Rule 3: nothing is seen through cracks, and a gap of 5 mm is none.
#include <cmath>

#include "seeing_test.h"

namespace sightcell::test {
namespace {

class seeing_cracks : public seeing_test {};

constexpr float wide = 14.0f;  // walls reach through the room's sides, also when turned

// The room, two walls across it with a crack between them, and one more wall behind them. The crack lies in a plane
// through the x axis; turned: by so many degrees from upright.
struct cracked_room {
  tiny_scene tiny;
  std::uint32_t room, low, high, behind;

  cracked_room(float place, float width, float depth, float turned = 0.0f) {
    const float angle = turned * 3.14159265f / 180.0f, c = std::cos(angle), s = std::sin(angle);
    const auto at = [&](float y, float z) { return glm::vec3(place, y * c - z * s, y * s + z * c); };
    const float half = width / 2;
    room = tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
    low = tiny.quad(at(-wide, -wide), at(-wide, -half), at(wide, -half), at(wide, -wide));
    high = tiny.quad(at(-wide, half), at(-wide, wide), at(wide, wide), at(wide, half));
    // One triangle, so that all rays through the crack find the same polygon.
    const float far = place + depth;
    behind = tiny.triangle({far, -30, -30}, {far, -30, 50}, {far, 50, -30});
  }

  expectation sees_behind(bool seen) const {
    expectation e{.sees = {{"room", room, 10}, {"low wall", low}, {"high wall", high}},
                  .does_not_see = {{"room behind", room + 10}}};
    (seen ? e.sees : e.does_not_see).push_back({"behind", behind, 1});
    return e;
  }
};

// What is seen through a crack is seen by few rays.
trial patient() {
  trial t;
  t.least_share = 2e-5;
  t.verify_rays = 120'000;
  return t;
}

constexpr float next_to_the_cell = 1.35f, far_from_it = 7.0f;

TEST_F(seeing_cracks, nothing_through_a_tenth_of_a_millimeter) {
  for (const float place : {next_to_the_cell, far_from_it}) {
    cracked_room r(place, 1e-4f, 1);
    check(r.tiny.finished(), r.sees_behind(false), patient());
  }
}

TEST_F(seeing_cracks, nothing_through_a_millimeter_however_it_is_turned) {
  for (const float turned : {0.0f, 22.5f, 45.0f, 80.0f}) {
    cracked_room r(next_to_the_cell, 1e-3f, 1, turned);
    check(r.tiny.finished(), r.sees_behind(false), patient());
  }
}

TEST_F(seeing_cracks, something_through_five_millimeters) {
  cracked_room near(next_to_the_cell, 5e-3f, 1), far(far_from_it, 5e-3f, 1);
  check(near.tiny.finished(), near.sees_behind(true), patient());
  trial t = patient();
  t.how.max_pixel_error = 2e-5;
  t.effort.directions = 300;
  t.verify_rays = 240'000;
  check(far.tiny.finished(), far.sees_behind(true), t);
}

TEST_F(seeing_cracks, the_smallest_gap_is_a_setting) {
  cracked_room fine(next_to_the_cell, 1e-3f, 1), wide_open(next_to_the_cell, 5e-3f, 1);
  trial t = patient();
  t.how.smallest_gap = 0.0f;
  check(fine.tiny.finished(), fine.sees_behind(true), t);
  t.how.smallest_gap = 0.01f;
  check(wide_open.tiny.finished(), wide_open.sees_behind(false), t);
}

// No crack for what lies right behind it.
TEST_F(seeing_cracks, what_lies_a_centimeter_behind_is_seen) {
  cracked_room near(next_to_the_cell, 1e-3f, 0.01f), further(next_to_the_cell, 1e-3f, 0.1f);
  check(near.tiny.finished(), near.sees_behind(true), patient());
  check(further.tiny.finished(), further.sees_behind(false), patient());
}

TEST_F(seeing_cracks, nothing_through_a_corner_that_does_not_close) {
  tiny_scene tiny;
  const auto room = tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const auto ahead = tiny.quad({1.5f, -wide, -wide}, {1.5f, -wide, 1.4f}, {1.5f, wide, 1.4f}, {1.5f, wide, -wide});
  const auto beside =
      tiny.quad({1.5f, -wide, 1.401f}, {-wide, -wide, 1.401f}, {-wide, wide, 1.401f}, {1.5f, wide, 1.401f});
  const auto behind = tiny.triangle({2.5f, -30, -30}, {2.5f, -30, 50}, {2.5f, 50, -30});
  check(tiny.finished(),
        {.sees = {{"room at low z", room}, {"room at y and low x", room + 4, 6}, {"ahead", ahead}, {"beside", beside}},
         .does_not_see = {{"room at high z", room + 2}, {"room at high x", room + 10}, {"behind", behind, 1}}},
        patient());
}

// A long edge of one wall against the short ones of another, whose corners do not lie on it: far from the origin
// floats are half a millimeter apart.
TEST_F(seeing_cracks, nothing_through_a_t_junction) {
  tiny_scene tiny;
  const float x = 8001.5f;
  const auto on_edge = [&](double t) {  // what a modeler's float arithmetic gives
    return glm::vec3(x, static_cast<float>(7990.0 + 20.0 * t), static_cast<float>(7999.6 + 0.9 * t));
  };
  const glm::vec3 low = on_edge(0.0), high = on_edge(1.0);
  const auto one = tiny.quad({x, low.y, 7980}, low, high, {x, high.y, 7980});
  // Corners that were rounded away from the edge leave a crack.
  std::vector<glm::vec3> corners{low};
  for (int i = 1; i < 2000 && corners.size() < 5; ++i) {
    const double t = i / 2000.0;
    const glm::vec3 corner = on_edge(t);
    const double on_line = static_cast<double>(low.z) + (static_cast<double>(corner.y) - static_cast<double>(low.y)) *
                                                            static_cast<double>(high.z - low.z) /
                                                            static_cast<double>(high.y - low.y);
    if (static_cast<double>(corner.z) - on_line > 2e-4 && t > 0.2 * static_cast<double>(corners.size()))
      corners.push_back(corner);
  }
  ASSERT_EQ(corners.size(), 5u);
  corners.push_back(high);
  std::uint32_t pieces = 0;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const glm::vec3 &a = corners[i], &b = corners[i + 1];
    const auto first = tiny.quad(a, {x, a.y, 8020}, {x, b.y, 8020}, b);
    if (i == 0) pieces = first;
  }
  // Around the cell, up to the wall.
  const auto room = tiny.closed_box({7990, 7992, 7990}, {8009, 8008, 8010}, true);
  const auto behind = tiny.triangle({8002.5f, 7970, 7970}, {8002.5f, 7970, 8050}, {8002.5f, 8050, 7970});
  trial t = patient();
  t.cell = {"", {7999, 7999, 7999}, {8001, 8001, 8001}};
  check(tiny.finished(),
        {.sees = {{"long edge", one}, {"short edges", pieces, 10}, {"room", room, 10}},
         .does_not_see = {{"room behind", room + 10}, {"behind", behind, 1}}},
        t);
}

// Its two triangles meet in a line of 140 km through the cell, which is clipped differently for each.
TEST_F(seeing_cracks, a_ground_of_100_km_crosses_the_cell) {
  tiny_scene tiny;
  const float far = 5e4f;
  const auto ground = tiny.quad({-far, -0.5f, far}, {far, -0.5f, far}, {far, -0.5f, -far}, {-far, -0.5f, -far});
  const auto house = tiny.closed_box({4, -0.5f, -2}, {6, 3, 2});
  const auto cellar = tiny.closed_box({-3, -6, -3}, {3, -2, 3}, true);
  check(tiny.finished(),
        {.sees = {{"ground", ground}, {"house at low x", house + 8}},
         .does_not_see = {{"house at z and y", house, 8}, {"house at high x", house + 10}, {"cellar", cellar, 12}}});
}

}  // namespace
}  // namespace sightcell::test
