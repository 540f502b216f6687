#pragma once
// What every scene here goes through: the reference, a whole bake with rays, one with hemicubes alone, and verify on
// good and damaged files.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "reference.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::test {

inline constexpr tiny_scene::look glass{scene::alpha_mode::blend, false};
inline constexpr tiny_scene::look both_sides{scene::alpha_mode::opaque, true};
inline constexpr tiny_scene::look masked{scene::alpha_mode::mask, false};

// Polygons of a scene that share one fate.
struct named_polygons {
  const char* name;
  std::uint32_t first, count = 2;
};

struct expectation {
  std::vector<named_polygons> sees, does_not_see;  // together every polygon, once
  // Of those seen, what verify excuses when it alone is left out: because of a coincident polygon that is in the set,
  // or because no ray sees it (rules 4 and 6).
  std::vector<named_polygons> excused = {};
  bool excused_together = true;  // false: verify misses them when they are all left out
};

// How a scene is tried.
struct trial {
  bake::cell_box cell{"", {-1, -1, -1}, {1, 1, 1}};
  bake::settings how = usual();
  // Every polygon that is seen at all is seen by at least this share of the rays: nothing lies between.
  double least_share = 1e-3;
  seeing_effort effort{};
  bool hemicubes = true;         // also without rays
  double hemicube_share = 1e-2;  // what hemicubes alone have to find
  std::uint64_t verify_rays = 20'000;

  static bake::settings usual();
};

class seeing_test : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  void check(const scene::scene& s, const expectation& expected, const trial& t = {});
  // Bakes and gives the set; a scene without a free place throws.
  std::vector<std::uint32_t> bake_set(const scene::scene& s, const trial& t, const bake::settings& how);

 private:
  void check_reference(const scene::scene& s, const expectation& expected, const trial& t);
  void check_with_rays(const scene::scene& s, const trial& t);
  void check_hemicubes(const scene::scene& s, const trial& t);
  void check_verify(const scene::scene& s, const expectation& expected, const trial& t);
  std::string name_of(std::uint32_t polygon) const;
  std::filesystem::path file() const { return folder_ / "cell.pvs"; }

  std::filesystem::path folder_;
  std::vector<std::string> sources_{"cpu", "rays"};  // of hemicubes; gpu too where there is EGL
  std::vector<std::string> names_;                   // per polygon
  std::vector<bool> seen_;                           // per polygon, as expected
  seen_polygons truth_;
};

}  // namespace sightcell::test
