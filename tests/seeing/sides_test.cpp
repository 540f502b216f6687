// Rule 1: sides, masks, glass.
#include "seeing_test.h"

namespace sightcell::test {
namespace {

class seeing_sides : public seeing_test {};

// Around everything: without it, a few backs would tell that the cell lies in a solid.
std::uint32_t room(tiny_scene& tiny) {
  return tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
}

TEST_F(seeing_sides, opaque_hides_opaque) {
  tiny_scene tiny;
  const auto around = room(tiny), wall = tiny.wall_x(4, -1, 4), behind = tiny.wall_x(4.5f, -1, 2);
  check(tiny.finished(), {.sees = {{"room", around, 12}, {"wall", wall}}, .does_not_see = {{"behind", behind}}});
}

TEST_F(seeing_sides, a_back_is_not_seen_and_hides_nothing) {
  tiny_scene tiny;
  const auto around = room(tiny), back = tiny.wall_x(4, +1, 1), behind = tiny.wall_x(5, -1, 0.5f);
  check(tiny.finished(), {.sees = {{"room", around, 12}, {"behind", behind}}, .does_not_see = {{"back", back}}});
}

TEST_F(seeing_sides, a_double_sided_back_is_seen_and_hides) {
  tiny_scene tiny;
  const auto around = room(tiny), sheet = tiny.wall_x(4, +1, 4, both_sides), behind = tiny.wall_x(4.5f, -1, 2);
  check(tiny.finished(), {.sees = {{"room", around, 12}, {"sheet", sheet}}, .does_not_see = {{"behind", behind}}});
}

TEST_F(seeing_sides, all_double_sided_means_all) {
  tiny_scene tiny;
  const auto around = room(tiny), back = tiny.wall_x(4, +1, 1), behind = tiny.wall_x(4.1f, -1, 0.5f);
  trial t;
  t.how.all_double_sided = true;
  check(tiny.finished(), {.sees = {{"room", around, 12}, {"back", back}}, .does_not_see = {{"behind", behind}}}, t);
}

TEST_F(seeing_sides, a_pane_is_seen_through) {
  tiny_scene tiny;
  const auto around = room(tiny), pane = tiny.wall_x(3, -1, 2, glass), behind = tiny.wall_x(5, -1, 1);
  const auto turned = tiny.wall_x(4, +1, 2, glass);
  check(tiny.finished(), {.sees = {{"room", around, 12}, {"pane", pane}, {"behind", behind}},
                          .does_not_see = {{"pane from behind", turned}}});
}

TEST_F(seeing_sides, three_panes_in_a_row) {
  tiny_scene tiny;
  const auto around = room(tiny), first = tiny.wall_x(3, -1, 4, glass), third = tiny.wall_x(4, -1, 4, glass);
  const auto second = tiny.wall_x(3.5f, -1, 4, glass), wall = tiny.wall_x(5, -1, 4);
  const auto hidden = tiny.wall_x(5.5f, -1, 2, glass), behind = tiny.wall_x(6, -1, 2);
  check(tiny.finished(), {.sees = {{"room", around, 12},
                                   {"first pane", first},
                                   {"second pane", second},
                                   {"third pane", third},
                                   {"wall", wall}},
                          .does_not_see = {{"pane behind the wall", hidden}, {"behind", behind}}});
}

// Four bars and four holes, half a meter each: alpha changes half way between the texels' centers.
const scene::alpha_map fence_map{8, 1, {255, 0, 255, 0, 255, 0, 255, 0}};

TEST_F(seeing_sides, what_is_behind_a_fence_is_seen_through_its_holes) {
  tiny_scene tiny;
  const auto around = room(tiny);
  const auto fence = tiny.masked_quad({3, -2, -2}, {3, -2, 2}, {3, 2, 2}, {3, 2, -2}, fence_map);
  // The bar from z = 0 to 0.5, the hole from 0.5 to 1; 1 cm behind the fence no eye looks past a bar far enough.
  const auto behind_bar = tiny.quad({3.01f, -1, 0.1f}, {3.01f, -1, 0.4f}, {3.01f, 1, 0.4f}, {3.01f, 1, 0.1f});
  const auto behind_hole = tiny.quad({3.01f, -1, 0.6f}, {3.01f, -1, 0.9f}, {3.01f, 1, 0.9f}, {3.01f, 1, 0.6f});
  check(tiny.finished(), {.sees = {{"room", around, 12}, {"fence", fence}, {"behind a hole", behind_hole}},
                          .does_not_see = {{"behind a bar", behind_bar}}});
}

TEST_F(seeing_sides, a_fence_from_behind_is_not_there_unless_double_sided) {
  for (const bool double_sided : {false, true}) {
    tiny_scene tiny;
    const auto around = room(tiny);
    const auto fence = tiny.masked_quad({3, -2, 2}, {3, -2, -2}, {3, 2, -2}, {3, 2, 2}, fence_map, double_sided);
    // Its map runs the other way: the bar is now from -0.5 to 0.
    const auto behind_bar = tiny.quad({3.01f, -1, -0.4f}, {3.01f, -1, -0.1f}, {3.01f, 1, -0.1f}, {3.01f, 1, -0.4f});
    if (double_sided)
      check(tiny.finished(),
            {.sees = {{"room", around, 12}, {"fence", fence}}, .does_not_see = {{"bar's", behind_bar}}});
    else
      check(tiny.finished(),
            {.sees = {{"room", around, 12}, {"bar's", behind_bar}}, .does_not_see = {{"fence", fence}}});
  }
}

// A mask that is cut away, and one that is there all over.
TEST_F(seeing_sides, the_cutoff_decides_for_whole_polygons_too) {
  tiny_scene tiny;
  const auto around = room(tiny);
  const auto gone = tiny.masked_quad({3, -2, -2}, {3, -2, 2}, {3, 2, 2}, {3, 2, -2}, {1, 1, {127}});
  const auto leaf = tiny.masked_quad({4, -2, -2}, {4, -2, 2}, {4, 2, 2}, {4, 2, -2}, {1, 1, {128}});
  const auto behind = tiny.wall_x(4.1f, -1, 1);
  check(tiny.finished(), {.sees = {{"room", around, 12}, {"leaf", leaf}},
                          .does_not_see = {{"cut away", gone}, {"behind the leaf", behind}}});
}

TEST_F(seeing_sides, a_mirrored_building_shows_its_front) {
  // closed_box: the polygons of x = high are 10 and 11. Mirrored, that side looks at the cell.
  for (const bool mirrored : {false, true}) {
    tiny_scene tiny;
    const auto around = room(tiny);
    const float sign = mirrored ? -1.0f : 1.0f;
    const auto building =
        mirrored ? tiny.closed_box({-6, -2, -2}, {-4, 2, 2}) : tiny.closed_box({4, -2, -2}, {6, 2, 2});
    const auto inside = tiny.wall_x(5, -1, 1);
    scene::scene s = tiny.finished();
    s.draws[1].to_world[0][0] = static_cast<double>(sign);
    scene::finish(s);
    const auto front = building + (mirrored ? 10 : 8), far_side = building + (mirrored ? 8 : 10);
    check(s, {.sees = {{"room", around, 12}, {"front", front}},
              .does_not_see = {{"its other sides", building, 8}, {"far side", far_side}, {"inside it", inside}}});
  }
}

}  // namespace
}  // namespace sightcell::test
