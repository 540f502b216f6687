#include "run_action.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include "exit_codes.h"
#include "sightcell/base/error.h"

namespace sightcell::cli {
namespace {

// What the action prints on standard error.
std::string said(const action& chosen, int expected_code) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run(chosen), expected_code);
  return ::testing::internal::GetCapturedStderr();
}

action throwing(error_kind kind) {
  return [kind]() -> int { throw error(kind, "room.id", "it", "is broken", "mend it"); };
}

TEST(run_action, the_action_decides_where_nothing_is_wrong) {
  EXPECT_EQ(said([] { return exit_bound_not_met; }, exit_bound_not_met), "");
}

TEST(run_action, an_error_is_one_line_and_its_kind_the_code) {
  const std::string line = "sightcell: it: is broken; mend it [room.id]\n";
  EXPECT_EQ(said(throwing(error_kind::failed), exit_failed), line);
  EXPECT_EQ(said(throwing(error_kind::wrong_use), exit_wrong_use), line);
  EXPECT_EQ(said(throwing(error_kind::bad_input), exit_bad_input), line);
}

TEST(run_action, memory_that_is_not_there) {
  EXPECT_EQ(said([]() -> int { throw std::bad_alloc(); }, exit_failed),
            "sightcell: memory: not enough for this scene; use a machine with more [cli.memory]\n");
}

TEST(run_action, what_nobody_expected_is_one_line_too) {
  EXPECT_EQ(said([]() -> int { throw std::runtime_error("two\nlines"); }, exit_failed),
            "sightcell: unexpected: two lines; please report it with the command [cli.unexpected]\n");
}

}  // namespace
}  // namespace sightcell::cli
