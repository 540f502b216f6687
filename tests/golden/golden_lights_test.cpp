// As golden_test.cpp, of the file with a lights section.
#include "golden_lights.h"

#include <gtest/gtest.h>

#include "sightcell/format/reader.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

TEST(golden_lights, the_writer_writes_these_bytes) {
  EXPECT_TRUE(light_golden_bytes() == golden_file("v1_lights"));
}

TEST(golden_lights, sets_of_lights_are_read_as_they_were_written) {
  const auto bytes = golden_file("v1_lights");
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(check_all(file), status::ok);
  EXPECT_EQ(use_lights(file), status::ok);
  EXPECT_EQ(sets_of_lights(file), sample_lights(light_golden_contents()).sets);
}

}  // namespace
