// Golden files: bytes that the writer must go on writing while the version stands, and that the reader must read for
// ever. Those of version 0, which nobody writes any more: tests/unit/format/reader_v0_test.cpp.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "damaged_file.h"
#include "golden_contents.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

void expect_sets(const reader& file, const sample_contents& contents) {
  set_reader sets;
  ASSERT_EQ(sets.open(file), status::ok);
  EXPECT_EQ(sets.check(), status::ok);
  ASSERT_EQ(file.cell_count(), contents.sets.size());
  std::vector<std::uint32_t> ids;
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    EXPECT_EQ(sets.item_ids(cell, ids), status::ok);
    EXPECT_EQ(ids, contents.sets[cell]) << cell;
  }
}

TEST(golden, the_writer_writes_these_bytes) {
  for (const auto& [name, contents] : golden_files()) {
    EXPECT_TRUE(contents.encode() == golden_file(name)) << name;
  }
}

// All that is read makes the same file again; that it means what was written is for the text beside the file, which the
// Python decoder compares.
TEST(golden, files_are_read_as_they_were_written) {
  for (const auto& [name, contents] : golden_files()) {
    SCOPED_TRACE(name);
    const auto bytes = golden_file(name);
    reader file;
    ASSERT_EQ(reader::open(bytes, file), status::ok);
    expect_sets(file, contents);
    file_parts parts;
    ASSERT_EQ(take_apart(file, parts), status::ok);
    std::vector<std::byte> again;
    ASSERT_EQ(encode(parts.contents(sets_of(contents.sets)), again), status::ok);
    EXPECT_TRUE(again == bytes);
  }
}

// Opened, then checked as a whole.
status outcome(const std::vector<std::byte>& bytes) {
  reader file;
  const status s = reader::open(bytes, file);
  return s == status::ok ? check_all(file) : s;
}

std::string stem_of(const std::string& name) {
  return std::filesystem::path(name).stem().string();
}

std::map<std::string, std::string> listed_statuses() {
  std::ifstream in(SIGHTCELL_TEST_GOLDEN_FOLDER "/golden_errors/statuses.txt");
  std::map<std::string, std::string> listed;
  for (std::string name, expected; in >> name >> expected;) listed[name] = expected;
  return listed;
}

TEST(golden_errors, every_damaged_file_is_refused_as_listed) {
  const auto listed = listed_statuses();
  EXPECT_GT(listed.size(), 100u);
  for (const auto& [name, expected] : listed) {
    EXPECT_STREQ(status_name(outcome(golden_file("golden_errors/" + stem_of(name)))), expected.c_str()) << name;
  }
}

TEST(golden_errors, files_are_those_listed_and_made) {
  const auto listed = listed_statuses();
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SIGHTCELL_TEST_GOLDEN_FOLDER "/golden_errors")) {
    files += entry.path().extension() == ".pvs" ? 1 : 0;
  }
  EXPECT_EQ(files, listed.size());
  const damaged_list made = damaged_files();
  EXPECT_EQ(made.size(), listed.size());
  for (const damaged_file& file : made) {
    const auto found = listed.find(file.name + ".pvs");
    ASSERT_TRUE(found != listed.end()) << file.name;
    EXPECT_EQ(found->second, status_name(file.expected)) << file.name;
    EXPECT_TRUE(golden_file("golden_errors/" + file.name) == file.bytes) << file.name;
    // What a host allocates by must be right from there on.
    reader opened;
    EXPECT_EQ(reader::open(file.bytes, opened), file.later ? status::ok : file.expected) << file.name;
  }
}

}  // namespace
