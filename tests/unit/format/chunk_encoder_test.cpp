#include "chunk_encoder.h"

#include <gtest/gtest.h>

#include "row_decoder.h"
#include "row_encoder.h"
#include "sample_contents.h"
#include "sightcell/format/layout.h"

namespace {

using namespace sightcell::format;

std::vector<std::vector<run>> sets_of(const sightcell::test::sample_contents& contents) {
  std::vector<std::vector<run>> sets;
  for (const auto& set : contents.sets) sets.push_back(runs_of(set));
  return sets;
}

row_header header_of(const encoded_chunk& chunk, std::size_t cell) {
  row_header header;
  EXPECT_TRUE(read_row_header(std::span(chunk.bytes).subspan(chunk.rows[cell].offset, chunk.rows[cell].size), header));
  return header;
}

TEST(chunk_encoder, references_stay_shallow) {
  const auto contents = sightcell::test::random_contents(4, {.polygons = 4000, .cells = 64, .changed = 0.05});
  const encoded_chunk chunk = encode_chunk(sets_of(contents), 4000);
  std::size_t deltas = 0;
  for (std::size_t cell = 0; cell < 64; ++cell) {
    std::uint32_t depth = 0;
    for (std::size_t at = cell; header_of(chunk, at).delta; at = header_of(chunk, at).reference) {
      ASSERT_LE(++depth, layout::max_reference_depth) << cell;
    }
    deltas += depth > 0 ? 1 : 0;
  }
  EXPECT_GT(deltas, 20u);
}

TEST(chunk_encoder, no_row_is_larger_than_its_own_runs) {
  for (const double changed : {0.02, 0.2, 0.9}) {
    const auto contents = sightcell::test::random_contents(9, {.polygons = 3000, .cells = 64, .changed = changed});
    const auto sets = sets_of(contents);
    const encoded_chunk chunk = encode_chunk(sets, 3000);
    for (std::size_t cell = 0; cell < 64; ++cell) ASSERT_LE(chunk.rows[cell].size, own_row_size(sets[cell]));
  }
}

TEST(chunk_encoder, equal_sets_share_a_row) {
  const std::vector<std::vector<run>> sets{{{0, 4}}, {{9, 1}}, {{0, 4}}, {}, {}};
  const encoded_chunk chunk = encode_chunk(sets, 10);
  EXPECT_EQ(chunk.rows[0].offset, chunk.rows[2].offset);
  EXPECT_EQ(chunk.rows[3].offset, chunk.rows[4].offset);
  EXPECT_NE(chunk.rows[0].offset, chunk.rows[1].offset);
}

}  // namespace
