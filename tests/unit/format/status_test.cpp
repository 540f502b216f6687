#include "sightcell/format/status.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace {

using sightcell::format::status;
using sightcell::format::status_text;

TEST(status, every_status_has_its_own_text) {
  std::set<std::string> texts;
  for (const unsigned number : {0u, 1u, 2u, 3u, 4u, 5u, 10u, 20u, 21u, 22u, 23u, 24u, 25u, 26u}) {
    const char* text = status_text(static_cast<status>(number));
    ASSERT_NE(text, nullptr);
    EXPECT_TRUE(texts.insert(text).second) << text;
    EXPECT_STRNE(text, status_text(static_cast<status>(999)));
  }
}

TEST(status, unknown_numbers_have_a_text_too) {
  EXPECT_STREQ(status_text(static_cast<status>(999)), "unknown status");
}

}  // namespace
