// As golden_test.cpp, of the file with a casters section.
#include "golden_casters.h"

#include <gtest/gtest.h>

#include "sightcell/format/reader.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

TEST(golden_casters, the_writer_writes_these_bytes) {
  EXPECT_TRUE(caster_golden_bytes() == golden_file("v1_casters"));
}

TEST(golden_casters, casters_are_read_as_they_were_written) {
  const auto bytes = golden_file("v1_casters");
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(check_all(file), status::ok);
  EXPECT_EQ(use_casters(file), status::ok);
  EXPECT_EQ(casters_of(file), sample_casters(caster_golden_contents()).sets);
}

}  // namespace
