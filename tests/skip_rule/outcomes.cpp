// One test of every outcome; check.cmake picks some of them with --gtest_filter.
#include <gtest/gtest.h>

TEST(outcomes, passes) {}
TEST(outcomes, fails) {
  FAIL();
}
TEST(outcomes, skips) {
  GTEST_SKIP() << "nothing to see";
}
TEST(outcomes, skips_too) {
  GTEST_SKIP() << "nothing to see";
}
