#include "search/batch_plan.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "bound/sequential_test.h"

namespace sightcell::bake {
namespace {

constexpr double target = 1e-4;

std::vector<interim_test> tests_of(std::uint64_t batch) {
  return plan_interim_tests(target, risk_of_batch(batch), 0.01);
}

TEST(batch_plan, shares_of_the_risk_sum_to_at_most_5_percent) {
  double sum = 0.0;
  for (std::uint64_t batch = 1; batch <= 40; ++batch) sum += risk_of_batch(batch);
  EXPECT_LE(sum, 0.05);
  EXPECT_GT(sum, 0.0499);
}

TEST(batch_plan, a_batch_pays_where_it_is_expected_to_succeed) {
  constexpr std::uint64_t round = 10'000;  // less than a batch
  constexpr double of_trial = 0.2;
  const std::vector<interim_test> tests = tests_of(1);
  EXPECT_TRUE(batch_pays(tests, std::array{target / 100.0}, round, of_trial));
  EXPECT_FALSE(batch_pays(tests, std::array{target * 5.0}, round, of_trial));
  // A batch that succeeds late, against hemicubes that cost less than the rays that they save, and more.
  EXPECT_FALSE(batch_pays(tests, std::array{target * 0.5}, round, of_trial));
  EXPECT_TRUE(batch_pays(tests, std::array{target * 0.5}, 1'000'000'000, of_trial));
}

TEST(batch_plan, where_nothing_is_known_a_batch_pays_if_its_first_test_is_cheap) {
  const std::vector<interim_test> tests = tests_of(1);
  const std::array unknown{1.0, 1.0};
  const std::uint64_t first = tests.front().trials;
  EXPECT_TRUE(batch_pays(tests, unknown, first, 1.0));
  EXPECT_FALSE(batch_pays(tests, unknown, first - 1, 1.0));
}

// The count of batches, and then the cheaper one, decide. Cells of leaves cast batch after batch otherwise.
TEST(batch_plan, after_three_batches_the_cheaper_of_hemicubes_and_a_whole_batch_follows) {
  for (const std::uint64_t batches : {0, 1, 2}) {
    EXPECT_FALSE(batch_is_whole(batches));
    EXPECT_FALSE(hemicubes_follow(batches, 1.0, 2.0));
  }
  for (const std::uint64_t batches : {3, 4, 30}) {
    EXPECT_TRUE(batch_is_whole(batches));
    EXPECT_TRUE(hemicubes_follow(batches, 1.0, 2.0));
    EXPECT_FALSE(hemicubes_follow(batches, 2.0, 1.0));
  }
}

}  // namespace
}  // namespace sightcell::bake
