// The presets at their full size: slow, so apart from city_test.cpp.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "city.h"

namespace sightcell::city {
namespace {

TEST(city_presets, have_their_polygons_and_twenty_named_cells) {
  for (const char* name : {"vienna800k", "hongkong", "vienna8m"}) {
    const style* s = find_preset(name);
    ASSERT_NE(s, nullptr) << name;
    for (const std::uint64_t seed : {1, 2}) {
      const model town = make_town(*s, s->polygons, seed);
      EXPECT_EQ(count_polygons(town), s->polygons) << name;
      std::set<std::string> names;
      for (const named_cell& cell : town.cells) names.insert(cell.name);
      EXPECT_EQ(names.size(), 20u) << name;
      EXPECT_EQ(names.count("under bridge 1"), 1u) << name;
      EXPECT_EQ(names.count("passage 1"), 1u) << name;
      EXPECT_LT(town.nodes.size(), 50000u) << name;
    }
  }
}

}  // namespace
}  // namespace sightcell::city
