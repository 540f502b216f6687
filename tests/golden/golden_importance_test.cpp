// As golden_test.cpp, of the files with an importance section.
#include "golden_importance.h"

#include <gtest/gtest.h>

#include "sightcell/format/reader.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

TEST(golden_importance, the_writer_writes_these_bytes) {
  for (const auto& [name, contents] : golden_files_with_importance()) {
    EXPECT_TRUE(importance_golden_bytes(contents) == golden_file(name)) << name;
  }
}

TEST(golden_importance, classes_are_read_as_they_were_written) {
  for (const auto& [name, contents] : golden_files_with_importance()) {
    SCOPED_TRACE(name);
    const auto bytes = golden_file(name);
    reader file;
    ASSERT_EQ(reader::open(bytes, file), status::ok);
    EXPECT_EQ(check_all(file), status::ok);
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
      std::vector<std::uint8_t> expected;
      for (const std::uint32_t polygon : contents.sets[cell]) expected.push_back(sample_class(cell, polygon));
      EXPECT_EQ(classes_of(file, cell), expected) << cell;
    }
  }
}

}  // namespace
