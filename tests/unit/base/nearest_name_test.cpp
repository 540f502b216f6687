#include "sightcell/base/nearest_name.h"

#include <gtest/gtest.h>

#include <array>
#include <string_view>

namespace sightcell::bake {
namespace {

using namespace std::string_view_literals;

constexpr std::array options{"cells-file"sv, "cells-grid"sv,      "cell-size"sv, "cell-limit"sv,
                             "threads"sv,    "max-pixel-error"sv, "seed"sv,      "shard"sv};

TEST(edit_distance, counts_insertions_removals_replacements_and_swaps) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
  EXPECT_EQ(edit_distance("abc", "abc"), 0u);
  EXPECT_EQ(edit_distance("abc", "abxc"), 1u);
  EXPECT_EQ(edit_distance("abc", "ac"), 1u);
  EXPECT_EQ(edit_distance("abc", "axc"), 1u);
  EXPECT_EQ(edit_distance("abc", "acb"), 1u);
  EXPECT_EQ(edit_distance("ca", "abc"), 3u) << "a swapped pair is not edited again";
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(edit_distance, is_the_same_both_ways) {
  for (const std::string_view a : options)
    for (const std::string_view b : options) EXPECT_EQ(edit_distance(a, b), edit_distance(b, a)) << a << " " << b;
}

TEST(nearest_name, is_the_one_with_the_least_distance) {
  EXPECT_EQ(nearest_name("cells-limit", options), "cell-limit");
  EXPECT_EQ(nearest_name("treads", options), "threads");
  EXPECT_EQ(nearest_name("sead", options), "seed");
  EXPECT_EQ(nearest_name("cell-szie", options), "cell-size");
  EXPECT_EQ(nearest_name("threads", options), "threads");
}

TEST(nearest_name, may_be_abbreviated) {
  EXPECT_EQ(nearest_name("max-pixel", options), "max-pixel-error");
  EXPECT_EQ(nearest_name("cells-g", options), "cells-grid");
  EXPECT_EQ(nearest_name("ma", options), std::nullopt) << "two characters are too few";
}

TEST(nearest_name, is_none_for_what_is_not_similar) {
  EXPECT_EQ(nearest_name("report", options), std::nullopt);
  EXPECT_EQ(nearest_name("", options), std::nullopt);
  EXPECT_EQ(nearest_name("x", options), std::nullopt);
  EXPECT_EQ(nearest_name("cell-limit", {}), std::nullopt);
}

TEST(nearest_name, is_the_first_of_equally_near_ones) {
  constexpr std::array names{"abcd1"sv, "abcd2"sv};
  EXPECT_EQ(nearest_name("abcd3", names), "abcd1");
}

TEST(did_you_mean, is_the_end_of_a_message) {
  EXPECT_EQ(did_you_mean("treads", options), "; did you mean threads?");
  EXPECT_EQ(did_you_mean("report", options), "");
}

}  // namespace
}  // namespace sightcell::bake
