// Polygons that are added to a file by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "errors/error_id.h"
#include "sightcell/bake/patch.h"
#include "sightcell/base/json_text.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"
#include "sightcell/sightcell.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/stored_file.h"

namespace sightcell::bake {
namespace {

using ids = std::vector<std::uint32_t>;

// Three cells side by side on x, a scene of 20 polygons that are stored the other way round.
std::vector<std::byte> three_cells(const std::string& settings) {
  format::file_parts parts;
  parts.facts.polygon_count = 20;
  parts.facts.max_pixel_error = 0.004f;
  parts.draws = {{.polygon_count = 20}};
  parts.order_of_draw = {0};
  parts.orders.resize(1);
  for (std::uint32_t i = 20; i > 0; --i) parts.orders[0].push_back(i - 1);
  parts.cells = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}};
  parts.certificate = {{0, 1000, 1, 0.004, 0.95, 7}, {1, 2000, 0, 0.001, 0.95, 7}, {2, 3000, 2, 0.002, 0.95, 7}};
  parts.settings = settings;
  const std::vector<ids> sets{{1, 2, 5}, {1, 2, 5}, {}};
  std::vector<std::byte> bytes;
  EXPECT_EQ(format::encode(parts.contents(format::sets_of(sets)), bytes), format::status::ok);
  return bytes;
}

class patch_test : public testing::Test {
 protected:
  patch_test() : path_(std::filesystem::path(testing::TempDir()) / "patch_test.pvs") {}
  ~patch_test() override { std::filesystem::remove(path_); }

  patch_result patched(const std::vector<std::byte>& file, const std::vector<added_polygons>& additions) {
    const patch_result result = patch(file, "in.pvs", additions, path_);
    bytes_ = test::file_bytes(path_);
    EXPECT_EQ(result.bytes, bytes_.size());
    EXPECT_EQ(format::reader::open(bytes_, reader_), format::status::ok);
    return result;
  }
  // As the runtime hands it out: it checks the whole file first.
  ids set_of(std::uint32_t cell) const {
    sightcell_db* db = nullptr;
    sightcell_view* view = nullptr;
    EXPECT_EQ(sightcell_db_open(bytes_.data(), bytes_.size(), nullptr, &db), SIGHTCELL_OK);
    EXPECT_EQ(sightcell_db_check(db), SIGHTCELL_OK);
    EXPECT_EQ(sightcell_view_create(db, &view), SIGHTCELL_OK);
    const float eye[3] = {static_cast<float>(cell) + 0.5f, 0.5f, 0.5f};
    sightcell_frame frame;
    EXPECT_EQ(sightcell_view_move(view, eye, &frame), SIGHTCELL_OK);
    ids set(20);
    std::size_t count = 0;
    EXPECT_EQ(sightcell_view_polygons(view, set.data(), set.size(), &count), SIGHTCELL_OK);
    set.resize(count);
    std::sort(set.begin(), set.end());
    sightcell_view_destroy(view);
    sightcell_db_close(db);
    return set;
  }

  std::filesystem::path path_;
  std::vector<std::byte> bytes_;
  format::reader reader_;
};

TEST_F(patch_test, a_merged_file_stays_one) {
  format::reader file;
  const std::vector<std::byte> bytes = three_cells("{}");
  ASSERT_EQ(format::reader::open(bytes, file), format::status::ok);
  format::file_parts parts;
  ASSERT_EQ(format::take_apart(file, parts), format::status::ok);
  parts.facts.layout = format::host_layout::merged;
  parts.draws = {{.material = 1, .polygon_count = 8},
                 {.material = 1, .first_source = 12, .polygon_count = 8, .first_stored = 8},
                 {.group = 1, .first_source = 8, .polygon_count = 4, .first_stored = 16}};
  parts.order_of_draw = {0, 0, 1};
  parts.orders = {{9, 15, 0, 1, 8, 2, 3, 10, 11, 4, 5, 12, 6, 13, 7, 14}, {3, 1, 0, 2}};
  const std::vector<ids> sets{{1, 2, 5}, {1, 2, 5}, {}};
  std::vector<std::byte> merged;
  ASSERT_EQ(format::encode(parts.contents(format::sets_of(sets)), merged), format::status::ok);
  (void)patched(merged, {{0, 11, 2}, {2, 19, 1}});
  EXPECT_EQ(set_of(0), (ids{1, 2, 5, 11, 12}));
  EXPECT_EQ(set_of(1), (ids{1, 2, 5}));
  EXPECT_EQ(set_of(2), (ids{19}));
  format::file_parts now;
  ASSERT_EQ(format::take_apart(reader_, now), format::status::ok);
  EXPECT_EQ(now.facts.layout, format::host_layout::merged);
  EXPECT_EQ(now.orders, parts.orders);
}

TEST_F(patch_test, polygons_join_the_sets_of_their_cells_alone) {
  const patch_result result = patched(three_cells("{}"), {{0, 0, 4}, {2, 19, 1}, {0, 9, 1}});
  EXPECT_EQ(result.added, 4u);
  EXPECT_EQ(result.already_there, 2u);
  EXPECT_EQ(set_of(0), (ids{0, 1, 2, 3, 5, 9}));
  EXPECT_EQ(set_of(1), (ids{1, 2, 5}));
  EXPECT_EQ(set_of(2), (ids{19}));
}

TEST_F(patch_test, volumes_stay_in_their_sets) {
  format::reader file;
  const std::vector<std::byte> bytes = three_cells("{}");
  ASSERT_EQ(format::reader::open(bytes, file), format::status::ok);
  format::file_parts parts;
  ASSERT_EQ(format::take_apart(file, parts), format::status::ok);
  parts.volume_shape = {1.0, 2.0};
  parts.volumes = {{3, 0, 0, 0}, {1, 0, -1, 0}, {0, 0, 0, 0}};
  const std::vector<ids> sets{{1, 2, 5, 20, 22}, {1, 2, 5, 21}, {}};
  std::vector<std::byte> with_volumes;
  ASSERT_EQ(format::encode(parts.contents(format::sets_of(sets)), with_volumes), format::status::ok);
  const patch_result result = patched(with_volumes, {{0, 18, 2}, {2, 19, 1}});
  EXPECT_EQ(result.added, 3u);
  test::stored_file now(bytes_);
  EXPECT_EQ(now.items(0), (ids{1, 2, 5, 18, 19, 20, 22}));
  EXPECT_EQ(now.items(1), sets[1]);
  EXPECT_EQ(now.items(2), (ids{19}));
}

TEST_F(patch_test, bounds_and_certificate_stay) {
  const std::vector<std::byte> before = three_cells("{}");
  format::reader old;
  ASSERT_EQ(format::reader::open(before, old), format::status::ok);
  (void)patched(before, {{1, 7, 2}});
  EXPECT_EQ(reader_.facts().max_pixel_error, old.facts().max_pixel_error);
  for (std::uint32_t cell = 0; cell < 3; ++cell) {
    format::certificate_record a, b;
    ASSERT_EQ(old.certificate(cell, a), format::status::ok);
    ASSERT_EQ(reader_.certificate(cell, b), format::status::ok);
    EXPECT_EQ(std::tie(a.cell, a.rays, a.misses, a.upper_bound, a.seed),
              std::tie(b.cell, b.rays, b.misses, b.upper_bound, b.seed));
  }
}

TEST_F(patch_test, the_settings_say_what_was_new) {
  (void)patched(three_cells(R"({"samples":8})"), {{0, 0, 7}, {2, 3, 1}});
  using nlohmann::json;
  json expected = {{"samples", 8}, {"added", {{0, 0, 1}, {0, 3, 2}, {0, 6, 1}, {2, 3, 1}}}};
  EXPECT_EQ(scene::parse_json(reader_.settings()).dump(), expected.dump());
  (void)patched(std::vector<std::byte>(bytes_), {{1, 0, 3}});
  expected["added"].push_back({1, 0, 1});
  EXPECT_EQ(scene::parse_json(reader_.settings()).dump(), expected.dump());
  (void)patched(three_cells("by hand"), {{1, 0, 1}});
  EXPECT_EQ(scene::parse_json(reader_.settings()).dump(), R"({"added":[[1,0,1]],"settings":"by hand"})");
  (void)patched(three_cells(""), {{1, 0, 1}});
  EXPECT_EQ(scene::parse_json(reader_.settings()).dump(), R"({"added":[[1,0,1]]})");
}

TEST_F(patch_test, nothing_new_changes_no_byte) {
  const std::vector<std::byte> before = three_cells(R"({"samples":8})");
  const patch_result result = patched(before, {{0, 1, 2}, {0, 5, 1}});
  EXPECT_EQ(result.added, 0u);
  EXPECT_EQ(result.already_there, 3u);
  EXPECT_EQ(bytes_, before);
}

TEST_F(patch_test, what_is_out_of_range_or_broken_is_refused) {
  std::vector<std::byte> file = three_cells("{}");
  const auto id_of = [&](const added_polygons& wanted) {
    return test::error_id([&] { (void)patch(file, "in.pvs", std::vector{wanted}, path_); });
  };
  EXPECT_EQ(id_of({3, 0, 1}), "patch.no-such-cell");
  EXPECT_EQ(id_of({0, 20, 1}), "patch.no-such-polygon");
  EXPECT_EQ(id_of({0, 19, 2}), "patch.no-such-polygon");
  EXPECT_EQ(id_of({0, 0xFFFFFFFFu, 0xFFFFFFFFu}), "patch.no-such-polygon");
  for (const std::byte flip : {std::byte{0x20}, std::byte{0x01}, std::byte{0x02}}) {
    for (std::size_t at = 0; at < file.size(); ++at) {
      file[at] ^= flip;
      EXPECT_EQ(id_of({0, 0, 1}), "pvs.broken") << at;
      file[at] ^= flip;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(path_)) << "nothing is written";
  EXPECT_EQ(id_of({0, 0, 1}), "");
}

}  // namespace
}  // namespace sightcell::bake
