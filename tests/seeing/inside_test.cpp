// Rules 4 and 5: geometry inside the cell, solids.
#include "seeing_test.h"
#include "sightcell/base/error.h"

namespace sightcell::test {
namespace {

class seeing_inside : public seeing_test {};

// closed_box: z = low, z = high, y = low, y = high, x = low, x = high, two polygons each.

TEST_F(seeing_inside, the_sides_of_a_pillar_in_the_cell) {
  tiny_scene tiny;
  const auto room = tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const auto pillar = tiny.closed_box({-0.2f, -3, -0.2f}, {0.2f, 3, 0.2f});
  // In the pillar: no ray sees it, but it touches the cell and faces it (rule 4).
  const auto core = tiny.closed_box({-0.1f, -2, -0.1f}, {0.1f, 2, 0.1f});
  check(tiny.finished(), {.sees = {{"room", room, 12},
                                   {"pillar at z", pillar, 4},
                                   {"pillar at x", pillar + 8, 4},
                                   {"core at z", core, 4},
                                   {"core at x", core + 8, 4}},
                          .does_not_see = {{"pillar's ends", pillar + 4, 4}, {"core's ends", core + 4, 4}},
                          .excused = {{"core at z", core, 1}}});
}

TEST_F(seeing_inside, a_polygon_inside_that_faces_nobody) {
  // It touches the grown box's side at x = 1.25 and looks away from all of it.
  tiny_scene tiny;
  const auto room = tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const auto outward = tiny.wall_x(1.25f, +1, 0.5f), facing = tiny.wall_x(-1.25f, +1, 0.5f);
  check(tiny.finished(), {.sees = {{"room", room, 12}, {"facing", facing}}, .does_not_see = {{"outward", outward}}});
}

TEST_F(seeing_inside, a_cell_half_in_a_wall_does_not_open_it) {
  // Two rooms with two meters of wall between them; the cell reaches into the wall, 0.75 m short of the other room.
  tiny_scene tiny;
  const auto room = tiny.closed_box({-5, -5, -5}, {0, 5, 5}, true);
  const auto next = tiny.closed_box({2, -5, -5}, {9, 5, 5}, true);
  check(tiny.finished(), {.sees = {{"room", room, 12}}, .does_not_see = {{"next room", next, 12}}});
}

TEST_F(seeing_inside, what_only_places_in_a_solid_see_is_out) {
  // A solid block stands in the room and in the cell; a lamp hangs in it. Its sides hide it from everybody outside.
  tiny_scene tiny;
  const auto room = tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const auto block = tiny.closed_box({0, -4, -4}, {6, 4, 4});
  const auto lamp = tiny.wall_x(5, -1, 0.5f);
  check(tiny.finished(),
        {.sees = {{"room at z and y", room, 8}, {"room at low x", room + 8}, {"block at low x", block + 8}},
         .does_not_see = {{"room at high x", room + 10},
                          {"block at z and y", block, 8},
                          {"block at high x", block + 10},
                          {"lamp", lamp}}});
}

TEST_F(seeing_inside, a_cell_in_a_solid_is_not_stored) {
  tiny_scene tiny;
  tiny.closed_box({-5, -5, -5}, {5, 5, 5});
  try {
    (void)bake_set(tiny.finished(), {}, trial::usual());
    FAIL() << "stored";
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "bake.no-free-cell");
  }
}

}  // namespace
}  // namespace sightcell::test
