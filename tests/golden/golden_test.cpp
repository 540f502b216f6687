// Golden files: bytes that the writer must go on writing while the version stands, and that the reader must read for
// ever.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "sightcell/format/reader.h"
#include "unit/format/sample_contents.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

std::vector<std::byte> golden(const char* name) {
  std::ifstream in(std::string(SIGHTCELL_TEST_GOLDEN_FOLDER "/") + name, std::ios::binary);
  EXPECT_TRUE(in.good()) << name;
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

void expect_golden(const char* name, const sample_contents& contents) {
  const auto bytes = golden(name);
  EXPECT_TRUE(bytes == contents.encode()) << name << ": the writer writes other bytes";
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  std::vector<run> out(file.run_bound());
  std::vector<run> scratch(file.run_bound());
  EXPECT_EQ(file.check(out, scratch), status::ok);
  ASSERT_EQ(file.cell_count(), contents.sets.size());
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    status s = status::ok;
    EXPECT_EQ(decode_set(file, cell, s), contents.sets[cell]) << cell;
  }
  EXPECT_EQ(file.settings(), contents.settings);
}

TEST(golden, version_0_tiny) {
  expect_golden("v0_tiny.pvs", tiny_contents());
}
TEST(golden, version_0_small) {
  expect_golden("v0_small.pvs", small_contents());
}

}  // namespace
