#include "rank_difference.h"

#include <gtest/gtest.h>

#include <vector>

#include "random_source.h"
#include "rank_encoder.h"
#include "run_lists.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

struct applied {
  bool good = false;
  std::vector<std::uint32_t> borders;
};

// Into memory of exactly the required size.
applied apply(const std::vector<run>& reference, const std::vector<run>& removed, const std::vector<run>& added,
              std::uint32_t limit) {
  const auto r = borders_of(reference), gone = closed_borders_of(removed), come = closed_borders_of(added);
  applied answer;
  answer.borders.resize(rank_difference_room(r.size(), gone.size() - list_padding, come.size() - list_padding));
  std::size_t count = 0;
  answer.good = apply_rank_difference(r, gone, come, limit, answer.borders, count);
  answer.borders.resize(count);
  return answer;
}

TEST(rank_difference, ranks_count_members_and_the_others_apart) {
  const std::vector<run> reference{{2, 3}, {8, 4}};  // 2 3 4 8 9 10 11; others: 0 1 5 6 7 12 ..
  // Members of rank 2 and 3: 4 and 8. Others of rank 1 and 2: 1 and 5.
  const applied a = apply(reference, {{2, 2}}, {{1, 2}}, 20);
  ASSERT_TRUE(a.good);
  EXPECT_EQ(a.borders, (std::vector<std::uint32_t>{1, 4, 5, 6, 9, 12}));
}

TEST(rank_difference, both_ends_of_the_numbers) {
  EXPECT_EQ(apply({}, {}, {{0, 10}}, 10).borders, (std::vector<std::uint32_t>{0, 10}));
  EXPECT_EQ(apply({{0, 10}}, {{0, 10}}, {}, 10).borders, (std::vector<std::uint32_t>{}));
  EXPECT_EQ(apply({{0, 4}}, {{3, 1}}, {{5, 1}}, 10).borders, (std::vector<std::uint32_t>{0, 3, 9, 10}));
  EXPECT_EQ(apply({{6, 4}}, {}, {{0, 6}}, 10).borders, (std::vector<std::uint32_t>{0, 10}));
  EXPECT_TRUE(apply({}, {}, {}, 0).good);
}

TEST(rank_difference, ranks_beyond_the_last_are_refused) {
  EXPECT_TRUE(apply({{2, 3}}, {{0, 3}}, {}, 10).good);
  EXPECT_FALSE(apply({{2, 3}}, {{0, 4}}, {}, 10).good);
  EXPECT_FALSE(apply({{2, 3}}, {{3, 1}}, {}, 10).good);
  EXPECT_TRUE(apply({{2, 3}}, {}, {{0, 7}}, 10).good);
  EXPECT_FALSE(apply({{2, 3}}, {}, {{0, 8}}, 10).good);
  EXPECT_FALSE(apply({{2, 3}}, {}, {{7, 1}}, 10).good);
}

TEST(rank_difference, lists_without_an_end_or_room) {
  const std::vector<std::uint32_t> none, closed(list_padding, no_border), open{1, 2, no_border, no_border};
  std::vector<std::uint32_t> out(20);
  std::size_t count = 0;
  EXPECT_FALSE(apply_rank_difference(none, none, closed, 5, out, count));
  EXPECT_FALSE(apply_rank_difference(none, closed, open, 5, out, count));
  EXPECT_FALSE(apply_rank_difference(none, closed, closed, 5, std::span(out).first(3), count));
  EXPECT_TRUE(apply_rank_difference(none, closed, closed, 5, std::span(out).first(4), count));
}

TEST(rank_difference, what_was_made_comes_back) {
  random_source random(11);
  for (int round = 0; round < 20000; ++round) {
    const std::uint32_t limit = random() % 60;
    std::vector<bool> a(limit), b(limit);
    const std::uint32_t same = 1 + random() % 8;
    for (std::uint32_t i = 0; i < limit; ++i) {
      a[i] = i > 0 && random() % 3 != 0 ? a[i - 1] : random() % 2 == 0;
      b[i] = random() % same != 0 ? a[i] : random() % 2 == 0;
    }
    const auto reference = runs_of(a), set = runs_of(b);
    std::vector<run> removed, added;
    make_rank_difference(reference, set, removed, added);
    const applied back = apply(reference, removed, added, limit);
    ASSERT_TRUE(back.good);
    ASSERT_EQ(back.borders, borders_of(set));
    for (const auto& list : {removed, added}) {
      for (std::size_t i = 1; i < list.size(); ++i) ASSERT_GT(list[i].first, list[i - 1].first + list[i - 1].count);
    }
  }
}

// Invalid lists: no access outside of the buffers (the sanitizer checks that), and a result that is accepted has an
// even number of borders.
TEST(rank_difference, lists_of_any_numbers) {
  random_source random(12);
  for (int round = 0; round < 50000; ++round) {
    const std::uint32_t limit = random() % 50;
    std::vector<bool> members(limit);
    for (std::uint32_t i = 0; i < limit; ++i) members[i] = random() % 2 == 0;
    const auto reference = borders_of(runs_of(members));
    std::vector<std::uint32_t> lists[2];
    for (auto& list : lists) {
      list.resize(2 * (random() % 6));
      for (std::uint32_t& v : list)
        v = random() % 8 != 0 ? random() % 40 : random() | (random() % 2 == 0 ? 0xFFFFFFF0 : 0);
      list.insert(list.end(), list_padding, no_border);
    }
    std::vector<std::uint32_t> out(
        rank_difference_room(reference.size(), lists[0].size() - list_padding, lists[1].size() - list_padding));
    std::size_t count = 0;
    const bool good = apply_rank_difference(reference, lists[0], lists[1], limit, out, count);
    ASSERT_TRUE(count % 2 == 0 && (good || count == 0));
  }
}

}  // namespace
