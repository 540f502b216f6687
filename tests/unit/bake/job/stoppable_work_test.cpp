#include "job/stoppable_work.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "cells/walkable.h"
#include "trace/ray_scene.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using namespace std::chrono_literals;

TEST(stoppable_work, reports_come_on_the_calling_thread_while_it_works) {
  tbb::task_arena arena(1);
  stop_request stop;
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<int> reports{0};
  run_stoppable(
      arena,
      [&] {
        EXPECT_NE(std::this_thread::get_id(), caller);
        while (reports < 2) std::this_thread::sleep_for(1ms);
      },
      [&] {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        ++reports;
        return true;
      },
      stop);
  EXPECT_GE(reports, 2);
  EXPECT_FALSE(stop.asked());
}

TEST(stoppable_work, ends_when_a_report_says_so) {
  tbb::task_arena arena;
  const auto until_asked = [](const stop_request& stop) {
    while (!stop.asked()) std::this_thread::sleep_for(1ms);
  };
  stop_request stop, second, third;
  EXPECT_THROW(run_stoppable(arena, [&] { until_asked(stop); }, [] { return false; }, stop), step_stopped);
  EXPECT_THROW(run_stoppable(
                   arena, [&] { until_asked(second), throw std::logic_error("half a tree"); }, [] { return false; },
                   second),
               step_stopped);
  EXPECT_THROW(run_stoppable(
                   arena, [&] { until_asked(third); }, []() -> bool { throw std::length_error("of the host"); }, third),
               std::length_error);
}

TEST(stoppable_work, passes_failures_on) {
  tbb::task_arena arena;
  stop_request stop;
  EXPECT_THROW(run_stoppable(arena, [] { throw std::logic_error("broken"); }, [] { return true; }, stop),
               std::logic_error);
}

TEST(stoppable_work, scenes_look_at_the_request) {
  test::tiny_scene tiny;
  tiny.closed_box({-5, -5, -5}, {5, 5, 5}, true);
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  stop_request stop;
  EXPECT_NO_THROW(ray_scene(geometry, false, &stop));
  EXPECT_NO_THROW((void)find_walkable_cells(geometry, lattice(2.0), settings(), &stop));
  stop.ask();
  EXPECT_THROW(ray_scene(geometry, false, &stop), step_stopped);
  EXPECT_THROW((void)find_walkable_cells(geometry, lattice(2.0), settings(), &stop), step_stopped);
}

}  // namespace
}  // namespace sightcell::bake
