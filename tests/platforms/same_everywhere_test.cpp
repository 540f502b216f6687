// On every platform the same contents are encoded to the same bytes, and the same bytes decode to the same sets. The
// expected files and numbers are committed.
#include <gtest/gtest.h>

#include <array>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "decode_dump.h"
#include "file_walk.h"
#include "generated_city.h"
#include "sightcell/viewpoints.h"
#include "unit/runtime/loaded_file.h"

namespace {

using namespace sightcell::test;

std::string golden_path(const std::string& name) {
  return std::string(SIGHTCELL_TEST_GOLDEN_FOLDER "/") + name;
}

// The lines that begin with one of the given words, which the dump of the C runtime and the golden text have in common.
std::vector<std::string> common_lines(std::istream& text) {
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    for (const std::string word : {"version ", "fingerprint ", "polygons ", "margin ", "max_pixel_error ",
                                   "confidence ", "draw ", "cell ", "named group ", "player_radius ", "viewpoints "}) {
      if (line.starts_with(word)) lines.push_back(line);
    }
  }
  return lines;
}

// A draw of the golden text in the form of the C runtime: without the flags and the number of its order at the end of
// the line, and with the begin of its draw group if it has one.
class told_draws {
 public:
  explicit told_draws(bool merged) : merged_(merged) {}

  std::string line(const std::string& golden) {
    std::istringstream in(golden);
    std::vector<std::string> words(std::istream_iterator<std::string>(in), {});
    words.resize(words.size() - 2);
    std::string& first_stored = words.at(10);
    if (merged_ && words.at(7) == group_) {
      first_stored = begin_;
    } else {
      group_ = words.at(7);
      begin_ = first_stored;
    }
    std::string out = words[0];
    for (std::size_t i = 1; i < words.size(); ++i) out += ' ' + words[i];
    return out;
  }

 private:
  bool merged_;
  std::string group_, begin_;
};

void expect_golden_text(const std::string& name, std::size_t lines, bool of_version_0 = false) {
  sightcell_db* db = nullptr;
  ASSERT_EQ(sightcell_db_open_file(golden_path(name + ".pvs").c_str(), nullptr, &db), SIGHTCELL_OK);
  const std::string text = dump(db);
  sightcell_db_close(db);
  EXPECT_EQ(text.find("WRONG"), std::string::npos) << text;
  std::ifstream expected(golden_path(name + ".txt"));
  std::istringstream decoded(text);
  auto expected_lines = common_lines(expected);
  told_draws draws(text.find("\nlayout 1 ") != std::string::npos);
  for (std::string& line : expected_lines) {
    if (!of_version_0 && line.starts_with("draw ")) line = draws.line(line);
  }
  EXPECT_EQ(expected_lines.size(), lines);
  EXPECT_EQ(common_lines(decoded), expected_lines);
}

TEST(same_everywhere, golden_files) {
  expect_golden_text("v1_tiny", 9);
  expect_golden_text("v1_small", 77);
  expect_golden_text("v1_lattice", 96);
  expect_golden_text("v1_merged", 79);
  expect_golden_text("v1_volumes", 77);
  expect_golden_text("v1_groups", 87);
  expect_golden_text("v1_viewpoints", 185);
  expect_golden_text("v1_grid", 273);
}
TEST(same_everywhere, golden_files_of_version_0) {
  expect_golden_text("v0_tiny", 9, true);
  expect_golden_text("v0_small", 76, true);
}

std::string hex(std::uint64_t number) {
  char text[20];
  std::snprintf(text, sizeof(text), "%016" PRIx64, number);
  return text;
}

std::string hash_of(std::span<const std::byte> bytes) {
  fnv_hash hash;
  hash.add(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  return hex(hash.value());
}

// Checks name, size and hash of the dump, and hash of the walk, of each golden file. web/golden_test.mjs expects the
// same numbers from the web module, which has neither files nor C++.
TEST(same_everywhere, golden_answers) {
  std::ifstream in(SIGHTCELL_TEST_ANSWERS);
  std::size_t files = 0;
  for (std::string line; std::getline(in, line); ++files) {
    const std::string name = line.substr(0, line.find(' '));
    sightcell_db* db = nullptr;
    ASSERT_EQ(sightcell_db_open_file(golden_path(name + ".pvs").c_str(), nullptr, &db), SIGHTCELL_OK) << name;
    const std::string text = dump(db);
    const std::string answer = name + ' ' + std::to_string(text.size()) + ' ' +
                               hash_of(std::as_bytes(std::span(text))) + ' ' + hex(hash_of_walk(db));
    sightcell_db_close(db);
    EXPECT_EQ(answer, line);
  }
  EXPECT_EQ(files, 12u);
}

// Eyes are computed from steps: to the last bit, they are those of the Python decoder.
TEST(same_everywhere, eyes) {
  sightcell_db* db = nullptr;
  ASSERT_EQ(sightcell_db_open_file(golden_path("v1_eyes.pvs").c_str(), nullptr, &db), SIGHTCELL_OK);
  std::ifstream text(golden_path("v1_eyes.txt"));
  std::map<unsigned, std::uint32_t> eyes_of_cell;
  std::size_t eyes = 0;
  for (std::string line; std::getline(text, line);) {
    unsigned cell = 0;
    std::array<float, 3> expected{};
    if (std::sscanf(line.c_str(), "eye of %u: %f %f %f", &cell, &expected[0], &expected[1], &expected[2]) != 4)
      continue;
    std::array<float, 3> eye{};
    ASSERT_EQ(sightcell_db_cell_eye(db, cell, eyes_of_cell[cell]++, eye.data()), SIGHTCELL_OK) << line;
    EXPECT_EQ(eye, expected) << line;
    ++eyes;
  }
  EXPECT_GT(eyes, 200u);
  sightcell_db_close(db);
}

// Checks frames and changes of a walk along the borders of cells and grown boxes.
std::string hash_of_border_walk(const sightcell_db* db) {
  fnv_hash hash;
  const test_view view(db);
  std::vector<sightcell_range> added(sightcell_db_polygon_count(db));
  std::vector<sightcell_range> removed(added.size());
  std::set<std::uint32_t> cells;
  std::uint32_t state = 1;
  for (int step = 0; step < 20000; ++step) {
    float eye[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      state = state * 1664525u + 1013904223u;
      const float border = 0.7f * static_cast<float>((state >> 16) % (axis == 1 ? 3 : 21)) - 5.3f;
      eye[axis] = border + 0.05f * static_cast<float>((state >> 8) % 7) - 0.15f;
    }
    sightcell_frame frame{};
    std::size_t added_count = 0;
    std::size_t removed_count = 0;
    EXPECT_EQ(sightcell_view_move(view.get(), eye, &frame), SIGHTCELL_OK);
    const sightcell_status s = sightcell_view_changes(view.get(), frame.revision - 1, added.data(), added.size(),
                                                      &added_count, removed.data(), removed.size(), &removed_count);
    cells.insert(frame.cell);
    for (const std::uint32_t value :
         {frame.cell, frame.flags, frame.polygon_count, frame.revision, static_cast<std::uint32_t>(s)}) {
      hash.add(value);
    }
    for (std::size_t i = 0; i < added_count; ++i) {
      for (const std::uint32_t value : {added[i].draw, added[i].first, added[i].count}) hash.add(value);
    }
    for (std::size_t i = 0; i < removed_count; ++i) {
      for (const std::uint32_t value : {removed[i].draw, removed[i].first, removed[i].count}) hash.add(value);
    }
  }
  EXPECT_EQ(cells.size(), 801u) << "all cells and outside";
  return hex(hash.value());
}

// The numbers are those of g++ on x86-64. They change only together with the format or its encoder, and the golden
// files.
TEST(same_everywhere, generated_city) {
  const sample_contents contents = generated_city();
  const auto bytes = contents.encode();
  EXPECT_EQ(contents.facts.polygon_count, 38400u);
  EXPECT_EQ(bytes.size(), 310819u);
  EXPECT_EQ(hash_of(bytes), "a86eaa6a4cd7e305");
  const loaded_file file(bytes);
  EXPECT_EQ(sightcell_db_check(file.db()), SIGHTCELL_OK);
  const std::string text = dump(file.db());
  EXPECT_EQ(text.find("WRONG"), std::string::npos);
  EXPECT_EQ(text.size(), 7650176u);
  EXPECT_EQ(hash_of(std::as_bytes(std::span(text))), "b832f91d5e636910");
  EXPECT_EQ(hash_of_border_walk(file.db()), "869e02ac79687125");
}

}  // namespace
