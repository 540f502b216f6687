#include "sightcell/scene/embed.h"

#include <gtest/gtest.h>

#include <fstream>

#include "sightcell/base/error.h"
#include "unit/bake/fresh_folder.h"

namespace sightcell::scene {
namespace {

TEST(embed, a_glb_longer_than_lengths_in_one_is_refused) {
  const test::fresh_folder folder;
  const std::string json = R"({"asset":{"version":"2.0"}} )";
  std::ofstream out(folder / "s.glb", std::ios::binary);
  out << "glTF" << std::string("\2\0\0\0\x30\0\0\0\x1c\0\0\0", 12) << "JSON" << json;
  out.close();
  const std::byte one{};
  // None of these bytes is read.
  const std::span<const std::byte> enormous(&one, std::size_t{5} << 30);
  try {
    (void)with_embedded(folder / "s.glb", enormous, "a.pvs", folder / "s.glb");
    FAIL();
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "embed.too-large");
  }
}

}  // namespace
}  // namespace sightcell::scene
