// Rule 6: what moves, and what the host knows better.
#include "seeing_test.h"

namespace sightcell::test {
namespace {

class seeing_tags : public seeing_test {};

// A room, a screen, and something behind the screen; the screen is tagged.
struct tagged_screen {
  tiny_scene tiny;
  std::uint32_t room, screen, behind;
  scene::scene s;

  explicit tagged_screen(const scene::draw_tags& tags) {
    room = tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
    screen = tiny.wall_x(4, -1, 4);
    behind = tiny.wall_x(4.5f, -1, 2);
    s = tiny.finished();
    s.groups = {"doors"};
    s.draws[1].tags = tags;
    scene::finish(s);
  }
  expectation with(bool screen_seen, bool behind_seen) const {
    expectation e{.sees = {{"room", room, 12}}, .does_not_see = {}};
    (screen_seen ? e.sees : e.does_not_see).push_back({"screen", screen});
    (behind_seen ? e.sees : e.does_not_see).push_back({"behind", behind});
    return e;
  }
};

TEST_F(seeing_tags, static_is_seen_and_hides) {
  const tagged_screen t({});
  check(t.s, t.with(true, false));
}

TEST_F(seeing_tags, no_occluder_is_seen_and_hides_nothing) {
  const tagged_screen t({.occluder = false});
  check(t.s, t.with(true, true));
}

TEST_F(seeing_tags, a_group_is_seen_and_hides_nothing) {
  const tagged_screen t({.group = 0});
  check(t.s, t.with(true, true));
}

TEST_F(seeing_tags, dynamic_is_left_out_and_hides_nothing) {
  const tagged_screen t({.dynamic = true});
  check(t.s, t.with(false, true));
}

TEST_F(seeing_tags, never_is_left_out_and_hides_nothing) {
  const tagged_screen t({.never = true});
  check(t.s, t.with(false, true));
}

TEST_F(seeing_tags, always_hides) {
  const tagged_screen t({.always = true});
  check(t.s, t.with(true, false));
}

TEST_F(seeing_tags, always_and_no_occluder_hides_nothing) {
  const tagged_screen t({.occluder = false, .always = true});
  check(t.s, t.with(true, true));
}

TEST_F(seeing_tags, animated_is_in_the_set_and_hides_nothing) {
  const tagged_screen t({.animated = true});
  check(t.s, t.with(true, true));
}

TEST_F(seeing_tags, animated_may_rest_or_be_left_out) {
  const tagged_screen s({.animated = true});
  trial t;
  t.how.animated = scene::animated_as::rest;
  check(s.s, s.with(true, false), t);
  t.how.animated = scene::animated_as::dynamic;
  check(s.s, s.with(false, true), t);
}

// Something that nobody sees: outside the room.
TEST_F(seeing_tags, always_and_animated_are_in_every_set) {
  tiny_scene tiny;
  const auto room = tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const auto sky = tiny.wall_x(20, -1, 4), bird = tiny.wall_x(-20, +1, 4), door = tiny.wall_x(21, -1, 4);
  const auto plain = tiny.wall_x(22, -1, 4);
  scene::scene s = tiny.finished();
  s.groups = {"doors"};
  s.draws[1].tags.always = true;
  s.draws[2].tags.animated = true;
  s.draws[3].tags.group = 0;
  scene::finish(s);
  check(s, {.sees = {{"room", room, 12}, {"always", sky}, {"animated", bird}},
            .does_not_see = {{"group", door}, {"static", plain}},
            .excused = {{"always", sky, 1}, {"animated", bird, 1}}});
}

TEST_F(seeing_tags, levels_of_detail_are_seen_with_the_finest) {
  tiny_scene tiny;
  const auto room = tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const auto finest = tiny.wall_x(4, -1, 4), behind = tiny.wall_x(4.5f, -1, 2);
  // The coarser ones would hide the finest, and are nowhere near it.
  const auto coarse = tiny.wall_x(3, -1, 6), coarsest = tiny.wall_x(-20, -1, 1);
  // Of another object, the finest is hidden; its coarser one would be in view.
  const auto hidden_finest = tiny.wall_x(4.2f, -1, 1), hidden_coarse = tiny.wall_x(-4, +1, 1);
  // Of a third, the finest lies in the cell.
  const auto inner = tiny.wall_x(0.5f, -1, 0.3f), inner_coarse = tiny.wall_x(30, -1, 1);
  scene::scene s = tiny.finished();
  const auto level = [&](std::size_t draw, std::uint32_t object, std::uint32_t number) {
    s.draws[draw].lod_object = object;
    s.draws[draw].lod_level = number;
  };
  level(1, 0, 0), level(3, 0, 1), level(4, 0, 2);
  level(5, 1, 0), level(6, 1, 1);
  level(7, 2, 0), level(8, 2, 1);
  scene::finish(s);
  check(s, {.sees = {{"room", room, 12},
                     {"finest", finest},
                     {"coarse", coarse},
                     {"coarsest", coarsest},
                     {"finest in the cell", inner},
                     {"its coarse", inner_coarse}},
            .does_not_see = {{"behind", behind}, {"hidden finest", hidden_finest}, {"its coarse", hidden_coarse}},
            .excused = {{"coarse", coarse, 1}, {"coarsest", coarsest, 1}, {"its coarse", inner_coarse, 1}}});
}

}  // namespace
}  // namespace sightcell::test
