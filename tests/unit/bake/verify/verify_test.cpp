// Files with sets that are known to be wrong: verify has to say by how much. And what write_pvs says of its cells.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "errors/error_id.h"
#include "file/pvs_output.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/verify.h"
#include "sightcell/base/error.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;

class temporary_file {
 public:
  explicit temporary_file(const char* name) : path_(std::filesystem::path(testing::TempDir()) / name) {}
  ~temporary_file() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::vector<std::uint32_t> all_but(const scene::scene& s, std::initializer_list<std::uint32_t> without) {
  std::vector<std::uint32_t> ids(s.polygon_count);
  std::iota(ids.begin(), ids.end(), 0u);
  for (const std::uint32_t id : without) std::erase(ids, id);
  return ids;
}

record_source from(const std::vector<cell_record>& records) {
  return [&records](std::uint32_t cell) { return records[cell]; };
}

// One cell with this set, through the bake's own output.
summary write(const scene::scene& s, const view_cell& cell, std::vector<std::uint32_t> set, float margin,
              const std::filesystem::path& path, bool bound_met = true, settings how = {}) {
  how.margin = margin;
  cell_record record;
  record.set = std::move(set);
  record.bound_met = bound_met;
  record.upper_bound = bound_met ? 5e-4 : 5e-2;
  std::vector<cell_record> records{record};
  summary sum;
  write_pvs(frame_of(s, how, describe(how), {cell}), from(records), path, {}, sum);
  return sum;
}

verification check(const scene::scene& s, const std::filesystem::path& path, const verify_settings& how) {
  return verify(s, test::file_bytes(path), path.string(), how, {});
}

const view_cell middle{{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}, "", 1};

TEST(verify, measures_the_error_of_a_set) {
  tiny_scene tiny;
  tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  const scene::scene s = tiny.finished();
  const temporary_file file("verify_room.pvs");
  (void)write(s, middle, all_but(s, {4, 5}), 0.0f, file.path());  // one wall of six
  verify_settings how;
  how.rays = 60'000;
  const verification v = check(s, file.path(), how);
  EXPECT_EQ(v.rays, 60'000u);
  EXPECT_NEAR(v.pixel_error, 1.0 / 6.0, 0.01);
  EXPECT_GT(v.upper_bound, v.pixel_error);
  ASSERT_EQ(v.missing.size(), 2u);
  EXPECT_EQ(v.missing[0].rays + v.missing[1].rays, v.misses);
  for (const missing_polygon& m : v.missing) EXPECT_TRUE(m.polygon == 4 || m.polygon == 5);
  EXPECT_NEAR(v.visible_set_percent, 100.0 * 10 / 12, 1e-4);

  (void)write(s, middle, all_but(s, {}), 0.0f, file.path());
  EXPECT_EQ(check(s, file.path(), how).misses, 0u);
}

TEST(verify, measures_by_the_metric_it_is_told) {
  // A red square before one wall of a white room, and a speck before another one: both are missing.
  tiny_scene tiny;
  tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  const auto square = tiny.wall_x(1, -1, 1);
  const auto speck = tiny.triangle({-1, 0, 0}, {-1, 0, -0.04f}, {-1, 0.04f, 0});
  scene::scene s = tiny.finished();
  s.materials[1].base_color = {1, 0, 0, 1};
  scene::finish(s);
  const temporary_file file("verify_metric.pvs");
  const view_cell small{{-1e-3f, -1e-3f, -1e-3f}, {1e-3f, 1e-3f, 1e-3f}, "", 1};
  (void)write(s, small, all_but(s, {square, square + 1, speck}), 0.0f, file.path());
  verify_settings how;
  how.rays = 60'000;
  const verification by_pixel = check(s, file.path(), how);
  EXPECT_NEAR(by_pixel.pixel_error, 1.0 / 6.0, 0.01);
  EXPECT_EQ(by_pixel.missing.size(), 3u);

  how.metric.kind = metric_kind::color;
  const verification by_color = check(s, file.path(), how);
  EXPECT_NEAR(by_color.pixel_error, 2.0 / 3.0 / 6.0, 0.01);
  EXPECT_EQ(by_color.missing.size(), 2u) << "the speck is as white as the wall";

  how.metric.kind = metric_kind::view;
  how.metric.view_least = 1e3;
  how.metric.view_pitch = {0.0, 0.0};
  const verification by_view = check(s, file.path(), how);
  EXPECT_GT(by_view.pixel_error, 1.25 / 6.0) << "30 degrees up and down, where the square fills more";
  EXPECT_EQ(by_view.missing.size(), 2u) << "the speck is too small";

  how.metric.view_fov = 0.0;
  EXPECT_EQ(test::error_id([&] { (void)check(s, file.path(), how); }), "settings.out-of-range");
}

TEST(verify, looks_from_the_margin_too) {
  // What lies behind the deep slit is seen from above the cell alone.
  tiny_scene tiny;
  const auto target = tiny.deep_slit();
  const scene::scene s = tiny.finished();
  const view_cell cell{{0, -0.5f, 0}, {0.5f, 0.5f, 0.85f}, "", 3};
  const temporary_file file("verify_margin.pvs");
  verify_settings how;
  how.rays = 100'000;
  (void)write(s, cell, all_but(s, {target, target + 1}), 0.0f, file.path());
  EXPECT_EQ(check(s, file.path(), how).misses, 0u);
  (void)write(s, cell, all_but(s, {target, target + 1}), 0.25f, file.path());
  EXPECT_GT(check(s, file.path(), how).misses, 0u);
}

TEST(verify, takes_what_moves_as_the_bake_did) {
  tiny_scene tiny;
  tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  const auto moving = tiny.wall_x(1, -1, 0.5f);
  scene::scene s = tiny.finished();
  s.draws.back().tags.animated = true;
  scene::finish(s);
  const temporary_file file("verify_animated.pvs");
  verify_settings how;
  how.rays = 20'000;
  const auto misses_with = [&](scene::animated_as animated) {
    settings baked;
    baked.animated = animated;
    (void)write(s, middle, all_but(s, {moving, moving + 1}), 0.0f, file.path(), true, baked);
    return check(s, file.path(), how).misses;
  };
  EXPECT_EQ(misses_with(scene::animated_as::dynamic), 0u) << "left out";
  EXPECT_GT(misses_with(scene::animated_as::always), 0u);
  EXPECT_GT(misses_with(scene::animated_as::rest), 0u);
}

TEST(verify, refuses_what_it_cannot_judge) {
  tiny_scene tiny, other;
  tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  other.closed_box({-2, -2, -2}, {2, 2, 3}, true);
  const scene::scene s = tiny.finished();
  const temporary_file file("verify_other.pvs");
  (void)write(s, middle, all_but(s, {}), 0.0f, file.path());
  try {
    (void)check(other.finished(), file.path(), {});
    FAIL() << "a file of another scene was judged";
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "pvs.other-scene");
  }
  EXPECT_THROW((void)check(s, "no/such/file.pvs", {}), error);
}

TEST(write_pvs, says_when_a_bound_was_not_met) {
  tiny_scene tiny;
  tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  const scene::scene s = tiny.finished();
  const temporary_file file("write_bound.pvs");
  const summary good = write(s, middle, all_but(s, {}), 0.0f, file.path());
  EXPECT_EQ(good.result, outcome::done);
  EXPECT_EQ(good.cells_over_bound, 0u);
  const summary bad = write(s, middle, all_but(s, {}), 0.0f, file.path(), false);
  EXPECT_EQ(bad.result, outcome::bound_not_met);
  EXPECT_EQ(bad.cells_over_bound, 1u);
  EXPECT_DOUBLE_EQ(bad.max_upper_bound, 5e-2);
}

TEST(write_pvs, rounds_the_bound_upwards) {
  tiny_scene tiny;
  tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  const scene::scene s = tiny.finished();
  const temporary_file file("write_rounding.pvs");
  for (const double bound : {1e-3, 0.5, 0.7, 0.9, 1.0 / 3.0}) {  // some lie above the nearest float, some below
    cell_record record;
    record.set = {1};
    record.upper_bound = bound;
    std::vector<cell_record> records{record};
    summary sum;
    write_pvs(frame_of(s, {}, "{}", {middle}), from(records), file.path(), {}, sum);
    const std::vector<std::byte> bytes = test::file_bytes(file.path());
    format::reader written;
    ASSERT_EQ(format::reader::open(bytes, written), format::status::ok);
    EXPECT_GE(static_cast<double>(written.facts().max_pixel_error), bound);
    EXPECT_LE(static_cast<double>(written.facts().max_pixel_error), bound * (1.0 + 1e-6));
  }
}

TEST(write_pvs, leaves_cells_without_a_free_place_out_and_refuses_none_at_all) {
  tiny_scene tiny;
  tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  const scene::scene s = tiny.finished();
  const temporary_file file("write_left_out.pvs");
  cell_record stored, solid;
  stored.set = {1, 2};
  solid.stored = false;
  const view_cell beside{{0.5f, 0, 0}, {1, 1, 1}, "", 2};
  std::vector<cell_record> records{solid, stored};
  std::vector<std::string> messages;
  callbacks tell;
  tell.on_message = [&](bake::severity, const std::string& line) { messages.push_back(line); };
  summary sum;
  write_pvs(frame_of(s, {}, "{}", {middle, beside}), from(records), file.path(), tell, sum);
  EXPECT_EQ(sum.cells, 1u);
  EXPECT_EQ(sum.cells_left_out, 1u);
  EXPECT_EQ(messages.size(), 1u);

  const auto writing = [&](const cell_record& record) {
    records = {record};
    return test::error_id([&] { write_pvs(frame_of(s, {}, "{}", {middle}), from(records), file.path(), tell, sum); });
  };
  EXPECT_EQ(writing(solid), "bake.no-free-cell");
  stored.set = {2, 1};
  EXPECT_EQ(writing(stored), "output.encode");
}

}  // namespace
}  // namespace sightcell::bake
