// Volumes from the settings to the file and back: the same bytes however the work is cut up, and a check that finds
// what is missing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "errors/error_id.h"
#include "sightcell/bake/inspect.h"
#include "sightcell/bake/patch.h"
#include "sightcell/bake/recode.h"
#include "sightcell/bake/shards.h"
#include "sightcell/bake/verify.h"
#include "sightcell/base/error.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/two_rooms.h"

namespace sightcell::bake {
namespace {

namespace fs = std::filesystem;

// A file taken apart, with its sets.
struct opened {
  explicit opened(std::vector<std::byte> from) : bytes(std::move(from)) {
    EXPECT_EQ(format::reader::open(bytes, file), format::status::ok);
    EXPECT_EQ(sets.open(file), format::status::ok);
    EXPECT_EQ(sets.check(), format::status::ok);
    EXPECT_EQ(format::take_apart(file, parts), format::status::ok);
  }
  std::vector<std::uint32_t> items(std::uint32_t cell) {
    std::vector<std::uint32_t> all;
    EXPECT_EQ(sets.item_ids(cell, all), format::status::ok);
    return all;
  }
  // Volumes that a cell sees, by their places.
  std::set<std::vector<int>> volumes(std::uint32_t cell) {
    std::set<std::vector<int>> places;
    for (const std::uint32_t item : items(cell))
      if (item >= file.polygon_count()) {
        const format::lattice_place& p = parts.volumes[item - file.polygon_count()];
        places.insert({p.x, p.y, p.z});
      }
    return places;
  }

  std::vector<std::byte> bytes;
  format::reader file;
  format::set_reader sets;
  format::file_parts parts;
};

class volume_bake : public testing::Test {
 protected:
  void SetUp() override {
    how_.cells_grid = {-6, 0.5f, -6, 6, 2.5f, 6};
    how_.source = "cpu";
    how_.resolution = 32;
    how_.samples = 6;
    how_.max_pixel_error = 0.01;
    how_.threads = 2;
    how_.volumes = 1.0;
  }
  fs::path out(const char* name) const { return folder_ / name; }
  std::vector<std::byte> baked(const char* name = "rooms.pvs") {
    sum_ = bake(scene_, how_, out(name), true, {});
    EXPECT_EQ(sum_.result, outcome::done);
    return test::file_bytes(out(name));
  }
  // The file of the settings above, baked by the first test that asks for it.
  const std::vector<std::byte>& usual() {
    static const std::vector<std::byte> file = baked();
    return file;
  }
  verification check(std::span<const std::byte> bytes) const {
    return verify(scene_, bytes, "rooms.pvs", {.rays = 60'000}, {});
  }

  test::fresh_folder folder_;
  scene::scene scene_ = test::two_rooms();
  settings how_;
  summary sum_;
};

TEST_F(volume_bake, a_file_has_the_volumes_that_its_cells_see) {
  opened f(baked());
  EXPECT_EQ(f.parts.volume_shape.width, 1.0);
  EXPECT_EQ(f.parts.volume_shape.height, 1.0);
  EXPECT_EQ(sum_.volumes, f.file.volumes().count());
  EXPECT_GT(sum_.volumes, 500u);
  double seen = 0.0;
  for (std::uint32_t cell = 0; cell < f.file.cell_count(); ++cell) seen += static_cast<double>(f.volumes(cell).size());
  EXPECT_DOUBLE_EQ(sum_.volumes_per_cell, seen / f.file.cell_count());
  EXPECT_NE(f.parts.settings.find("\"volumes\":1"), std::string::npos);
  EXPECT_LT(sum_.visible_percent, 100.1) << "volumes are no polygons";
  for (std::uint32_t cell = 0; cell < f.file.cell_count(); ++cell) {
    const auto seen_here = f.volumes(cell);
    const format::box& box = f.parts.cells[cell];
    const auto middle = [&](std::size_t axis) {
      return static_cast<int>(std::floor((double{box.min[axis]} + double{box.max[axis]}) / 2));
    };
    EXPECT_TRUE(seen_here.contains({middle(0), middle(1), middle(2)})) << "who is in the cell is seen";
    // In the corner of a room, the far corner of the same side of the other one is hidden.
    if (box.max[0] > -4.0f || box.max[2] > -4.0f) continue;
    EXPECT_FALSE(seen_here.contains({1, 1, -5}));
    EXPECT_TRUE(seen_here.contains({1, 1, 1})) << "through the door";
  }
  const verification v = check(f.bytes);
  EXPECT_LE(v.pixel_error, how_.max_pixel_error);
  EXPECT_LE(v.misses_of_volumes, v.misses);
  EXPECT_LT(size_without_volumes(f.bytes, "rooms.pvs"), f.bytes.size());
}

TEST_F(volume_bake, without_volumes_nothing_changes) {
  how_.volumes = 0.0;
  opened f(baked());
  EXPECT_EQ(f.file.volumes().count(), 0u);
  EXPECT_EQ(f.parts.settings.find("volumes"), std::string::npos);
  EXPECT_EQ(check(f.bytes).misses_of_volumes, 0u);
  EXPECT_EQ(size_without_volumes(f.bytes, "rooms.pvs"), f.bytes.size());
}

TEST_F(volume_bake, verify_finds_a_volume_that_was_dropped) {
  opened f(usual());
  const std::uint64_t before = check(f.bytes).misses_of_volumes;
  // In front of the door, from every cell.
  std::uint32_t gone = 0;
  for (std::uint32_t v = 0; v < f.parts.volumes.size(); ++v)
    if (f.parts.volumes[v].x == -1 && f.parts.volumes[v].y == 1 && f.parts.volumes[v].z == 0) gone = v;
  std::vector<std::byte> bytes;
  ASSERT_EQ(format::encode(f.parts.contents({f.parts.cells.size(),
                                             [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
                                               set = f.items(cell);
                                               std::erase(set, f.file.polygon_count() + gone);
                                               return format::status::ok;
                                             }}),
                           bytes),
            format::status::ok);
  const verification v = check(bytes);
  EXPECT_GT(v.misses_of_volumes, before + 60);
  EXPECT_LE(v.misses_of_volumes, v.misses);
  EXPECT_TRUE(v.missing.size() < 5) << "polygons are there";
}

TEST_F(volume_bake, repeats_with_any_number_of_threads) {
  const std::vector<std::byte>& two = usual();
  how_.threads = 1;
  EXPECT_EQ(baked("one.pvs"), two);
}

TEST_F(volume_bake, shards_give_the_bytes_of_one_bake) {
  how_.cell_size = 1.0f;
  how_.cells_grid = {-6, 1, -2, 4, 1.5f, 2};
  how_.max_pixel_error = 0.05;
  const std::vector<std::byte> one = baked();
  for (const std::uint32_t phase : {1u, 2u})
    for (const std::uint32_t i : {1u, 0u}) (void)bake_shard(scene_, how_, out("parts.pvs"), {i, 2, phase}, false, {});
  (void)merge(find_shard_files(out("parts.pvs")), out("parts.pvs"), {});
  EXPECT_EQ(test::file_bytes(out("parts.pvs")), one);
}

TEST_F(volume_bake, goes_on_after_a_kill) {
  const std::vector<std::byte>& whole = usual();
  callbacks tell;
  int told = 0;
  tell.on_progress = [&](const progress& now) { return now.cells_done < 3 || ++told < 2; };
  const summary first = bake(scene_, how_, out("again.pvs"), true, tell);
  EXPECT_EQ(first.result, outcome::cancelled);
  const summary second = bake(scene_, how_, out("again.pvs"), false, {});
  EXPECT_EQ(second.result, outcome::done);
  EXPECT_GT(second.cells_resumed, 0u);
  EXPECT_EQ(test::file_bytes(out("again.pvs")), whole);
}

TEST_F(volume_bake, a_limit_of_cells_leaves_all_volumes) {
  opened whole(usual());
  how_.cell_limit = 2;
  opened limited(baked("two.pvs"));
  EXPECT_EQ(limited.file.cell_count(), 2u);
  EXPECT_EQ(limited.file.volumes().count(), whole.file.volumes().count());
}

TEST_F(volume_bake, a_time_budget_finds_them_too) {
  how_.time_budget = 600.0;
  opened f(baked());
  EXPECT_EQ(sum_.cells_over_bound, 0u);
  EXPECT_GT(sum_.volumes_per_cell, 20.0);
  EXPECT_LE(check(f.bytes).pixel_error, how_.max_pixel_error);
}

TEST_F(volume_bake, recode_and_patch_keep_them) {
  how_.file.profile = slack_profile::exact;
  opened f(baked());
  recode_settings other;
  other.profile = slack_profile::small;
  other.layout = host_layout::merged;
  other.layout_from = &scene_;
  (void)recode(f.bytes, "rooms.pvs", other, out("small.pvs"));
  const added_polygons addition{0, 1, 1};
  (void)patch(f.bytes, "rooms.pvs", {&addition, 1}, out("patched.pvs"));
  for (const char* name : {"small.pvs", "patched.pvs"}) {
    opened made(test::file_bytes(out(name)));
    ASSERT_EQ(made.file.cell_count(), f.file.cell_count());
    for (std::uint32_t cell = 0; cell < f.file.cell_count(); ++cell)
      EXPECT_EQ(made.volumes(cell), f.volumes(cell)) << name << " " << cell;
  }
}

TEST_F(volume_bake, other_volumes_are_another_bake) {
  callbacks tell;
  tell.on_progress = [](const progress&) { return false; };
  (void)bake(scene_, how_, out("rooms.pvs"), true, tell);
  how_.volumes = 2.0;
  EXPECT_EQ(test::error_id([&] { (void)bake(scene_, how_, out("rooms.pvs"), false, {}); }), "checkpoint.other-bake");
}

TEST_F(volume_bake, what_cannot_be_is_refused) {
  const auto id = [&](double volumes, double error = 0.01) {
    how_.volumes = volumes, how_.max_pixel_error = error;
    return test::error_id([&] { (void)bake(scene_, how_, out("no.pvs"), true, {}); });
  };
  EXPECT_EQ(id(0.1), "settings.out-of-range");
  EXPECT_EQ(id(2000.0), "settings.out-of-range");
  EXPECT_EQ(id(NAN), "settings.out-of-range");
  EXPECT_EQ(id(-1.0), "settings.out-of-range");
  EXPECT_EQ(id(2.0, 0.0), "settings.volumes");
  how_.cells_grid = {-600, 0, -600, 600, 400, 600};
  how_.cell_size = 800.0f;
  EXPECT_EQ(id(0.25), "volumes.too-many");
}

}  // namespace
}  // namespace sightcell::bake
