// As golden_test.cpp, of the file with a texture residency section.
#include "golden_residency.h"

#include <gtest/gtest.h>

#include "sightcell/format/reader.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

TEST(golden_residency, the_writer_writes_these_bytes) {
  EXPECT_TRUE(residency_golden_bytes() == golden_file("v1_residency"));
}

TEST(golden_residency, levels_are_read_as_they_were_written) {
  const auto bytes = golden_file("v1_residency");
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(check_all(file), status::ok);
  EXPECT_EQ(use_residency(file), status::ok);
  EXPECT_EQ(levels_of(file), sample_residency(residency_golden_contents()).levels);
}

}  // namespace
