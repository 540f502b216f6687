#include "sightcell/format/chunk_borders.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "packed_columns_writer.h"
#include "random_source.h"
#include "sample_contents.h"
#include "sightcell/format/layout.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

// Whether each cell begins a chunk.
std::vector<std::byte> section_of_begins(const std::vector<bool>& begins) {
  std::vector<std::vector<std::uint32_t>> columns(3);
  std::uint32_t chunks = 0;
  for (std::size_t cell = 0; cell < begins.size(); ++cell) {
    if (cell % 64 == 0) {
      columns[0].push_back(chunks);
      columns[1].push_back(0);
      columns[2].push_back(0);
    }
    if (!begins[cell]) continue;
    columns[cell % 64 < 32 ? 1 : 2].back() |= 1u << cell % 32;
    ++chunks;
  }
  std::vector<std::byte> bytes;
  put_columns(columns, bytes);
  return bytes;
}

TEST(chunk_borders, each_cell_is_in_the_chunk_that_begins_last) {
  random_source random(3);
  for (const std::uint32_t cells : {1u, 63u, 64u, 65u, 300u}) {
    for (const std::uint32_t one_in : {1u, 5u, 70u}) {
      std::vector<bool> begins(cells);
      for (std::size_t cell = 0; cell < cells; ++cell) begins[cell] = cell % 64 == 0 || random() % one_in == 0;
      const std::vector<std::byte> bytes = section_of_begins(begins);
      chunk_borders borders;
      ASSERT_TRUE(borders.open(bytes, cells));
      EXPECT_EQ(borders.cells(), cells);
      EXPECT_EQ(borders.chunks(), static_cast<std::uint32_t>(std::count(begins.begin(), begins.end(), true)));
      cell_chunk expected;
      for (std::uint32_t cell = 0; cell < cells; ++cell) {
        if (begins[cell]) {
          std::uint32_t end = cell + 1;
          while (end < cells && !begins[end]) ++end;
          expected = {cell == 0 ? 0 : expected.number + 1, cell, end - cell};
        }
        const cell_chunk found = borders.chunk_of(cell);
        ASSERT_EQ(found.number, expected.number) << cell;
        ASSERT_EQ(found.first_cell, expected.first_cell) << cell;
        ASSERT_EQ(found.cells, expected.cells) << cell;
      }
    }
  }
}

TEST(chunk_borders, without_a_section_chunks_have_64_cells) {
  const chunk_borders borders(130);
  EXPECT_EQ(borders.chunks(), 3u);
  EXPECT_EQ(borders.chunk_of(63).number, 0u);
  EXPECT_EQ(borders.chunk_of(64).first_cell, 64u);
  EXPECT_EQ(borders.chunk_of(129).cells, 2u);
  EXPECT_EQ(chunk_borders(0).chunks(), 0u);
}

struct chunk_sizes {
  std::vector<std::uint32_t> cells, bytes;
};

chunk_sizes sizes_of(const std::vector<std::byte>& bytes) {
  chunk_sizes sizes;
  reader file;
  EXPECT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(check_all(file), status::ok);
  for (std::uint32_t cell = 0; cell < file.cell_count();) {
    const cell_chunk chunk = file.chunks().chunk_of(cell);
    std::uint64_t unused = 0;
    sizes.cells.push_back(chunk.cells);
    EXPECT_EQ(file.chunk_place(chunk.number, unused, sizes.bytes.emplace_back()), status::ok);
    cell = chunk.end();
  }
  return sizes;
}

TEST(chunk_split, chunks_are_as_large_as_asked_and_well_filled) {
  sample_contents contents = random_contents(5, {.polygons = 20000, .cells = 200, .changed = 0.05});
  for (const bool slack : {false, true}) {
    for (const std::uint32_t most : {3000u, 12000u}) {
      contents.chunk_bytes = most;
      file_contents all = contents.view();
      all.slack = slack ? 0.05 : 0.0;
      std::vector<std::byte> file;
      ASSERT_EQ(encode(all, file), status::ok);
      const chunk_sizes sizes = sizes_of(file);
      std::uint64_t sum = 0;
      for (std::size_t chunk = 0; chunk < sizes.cells.size(); ++chunk) {
        if (sizes.cells[chunk] > 1) {
          EXPECT_LE(sizes.bytes[chunk], most);
        }
        sum += sizes.bytes[chunk];
      }
      EXPECT_GT(sum, sizes.cells.size() * most * 2 / 5) << most;
    }
  }
}

TEST(chunk_split, cells_that_are_too_large_are_alone) {
  sample_contents contents = random_contents(6, {.polygons = 3000, .cells = 70});
  for (const std::uint32_t wide : {0u, 20u, 21u, 69u}) {
    contents.sets[wide].clear();
    for (std::uint32_t polygon = wide % 2; polygon < 3000; polygon += 2) contents.sets[wide].push_back(polygon);
  }
  contents.chunk_bytes = 1;
  EXPECT_EQ(sizes_of(contents.encode()).cells, std::vector<std::uint32_t>(70, 1));
  contents.chunk_bytes = 1000000;
  EXPECT_EQ(sizes_of(contents.encode()).cells, (std::vector<std::uint32_t>{64, 6}));
}

TEST(chunk_split, files_of_small_chunks_have_no_borders) {
  sample_contents contents = small_contents();
  const std::vector<std::byte> usual = contents.encode();
  contents.chunk_bytes = 0xFFFFFFFFu;
  EXPECT_TRUE(contents.encode() == usual);
  reader file;
  ASSERT_EQ(reader::open(usual, file), status::ok);
  section_record section;
  for (std::uint32_t i = 0; i < file.section_count(); ++i) {
    ASSERT_EQ(file.section(i, section), status::ok);
    EXPECT_NE(section.id, layout::section_borders);
  }
}

}  // namespace
