// The bytes of small bakes, pinned: a change of them needs a higher bake_version (job/bake_key.cpp).
// They hold for our rasterizer and Embree with AVX2 and for exp() of glibc; a machine without AVX2 has a valid file of
// its own, which says so.
#include <gtest/gtest.h>
#include <xxhash.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "sightcell/bake/bake.h"
#include "sightcell/scene/scene.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;

scene::scene pillars() {
  tiny_scene tiny;
  tiny.room_with_pillars();
  return tiny.finished();
}

scene::scene glass_and_decals() {
  tiny_scene tiny;
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  for (int i = 0; i < 6; ++i)
    tiny.wall_x(3.0f + 0.5f * static_cast<float>(i), -1, 2, {scene::alpha_mode::blend, false});
  tiny.wall_x(7, -1, 3), tiny.wall_x(7, -1, 3), tiny.wall_x(7.0001f, -1, 1);
  return tiny.finished();
}

scene::scene slit() {
  tiny_scene tiny;
  tiny.deep_slit();
  return tiny.finished();
}

// The hash of the file; 0 where this machine bakes other bytes than the pinned ones.
std::uint64_t hash_of_bake(const scene::scene& s, std::array<float, 6> grid, float cell_size) {
  settings how;
  how.cells_grid = grid;
  how.cell_size = cell_size;
  how.source = "cpu";
  how.resolution = 64;
  how.max_pixel_error = 0.01;
  how.threads = 2;
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "sightcell_pinned.pvs";
  const summary sum = bake(s, how, path, true, {});
  EXPECT_GT(sum.cells, 1u);
  const std::vector<std::byte> bytes = test::file_bytes(path);
  std::filesystem::remove(path);
  std::printf("%s: %016llx\n", sum.device.c_str(),
              static_cast<unsigned long long>(XXH3_64bits(bytes.data(), bytes.size())));
  return sum.device.find("AVX2") == std::string::npos ? 0 : XXH3_64bits(bytes.data(), bytes.size());
}

void expect_pinned(std::uint64_t hash, std::uint64_t pinned) {
  if (hash == 0) GTEST_SKIP() << "without AVX2 the bytes are others";
  EXPECT_EQ(hash, pinned) << "the bytes of a bake have changed";
}

TEST(pinned, pillars_in_a_room) {
  expect_pinned(hash_of_bake(pillars(), {-6, 0, -6, 6, 1, 6}, 2.0f), 0xf2a42fa3d8fdb9d8);
}

TEST(pinned, glass_and_decals) {
  expect_pinned(hash_of_bake(glass_and_decals(), {-4, 0, -4, 2, 1, 4}, 2.0f), 0x60a6368b56d975e8);
}

TEST(pinned, a_slit) {
  expect_pinned(hash_of_bake(slit(), {-2, -1, -2, 1, 1, 2}, 0.5f), 0x6052534231ed08cf);
}

}  // namespace
}  // namespace sightcell::bake
