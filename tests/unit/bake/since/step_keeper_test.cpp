#include "since/step_keeper.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "errors/error_id.h"
#include "sightcell/bake/bake.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

scene::scene room(bool with_screen) {
  test::tiny_scene tiny;
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  tiny.closed_box({-6, -6, -6}, {-5, -5, -5});
  if (with_screen) tiny.wall_x(5, -1, 1);
  return tiny.finished();
}

settings kept_cell() {
  settings how;
  how.cells_grid = {-2.0f, 0.0f, -2.0f, 0.0f, 1.0f, 0.0f};
  how.cell_size = 2.0f;
  how.resolution = 64;
  how.max_pixel_error = 1e-2;
  how.source = "cpu";
  how.keep_records = true;
  return how;
}

// Records that are whole by their checksum, and have what no bake writes: the bake that reads them ends with an error,
// before it casts rays for days or reads beyond a list.
TEST(step_keeper, refuses_records_that_no_bake_wrote) {
  const test::fresh_folder folder;
  const std::filesystem::path pvs = folder / "kept.pvs";
  settings how = kept_cell();
  ASSERT_EQ(bake(room(false), how, pvs, true, {}).result, outcome::done);
  const kept_records whole = read_records(pvs);
  how.since = pvs;
  how.keep_found = true;
  const auto id_with = [&](const std::function<void(cell_record&)>& change) {
    kept_records records = whole;
    for (kept_step& step : records.steps) {
      cell_record record = decode(step.record).value();
      change(record);
      step.record = encode(record);
    }
    write_records(records, pvs);
    return test::error_id([&] { (void)bake(room(true), how, folder / "again.pvs", true, {}); });
  };
  EXPECT_EQ(id_with([](cell_record& record) { EXPECT_GT(record.of_bound.number, 0u); }), "");
  EXPECT_EQ(id_with([](cell_record& record) { record.of_bound.parts = {std::uint64_t{1} << 40}; }), "records.damaged");
  EXPECT_EQ(id_with([](cell_record& record) { record.of_bound.parts.assign(3, 100'000'000); }), "records.damaged");
  EXPECT_EQ(id_with([](cell_record& record) { record.of_bound.number = record.batches + 1; }), "records.damaged");
  EXPECT_EQ(id_with([](cell_record& record) { record.of_bound.name = record.batches + 1; }), "records.damaged");
  EXPECT_EQ(id_with([](cell_record& record) { record.set.back() = 1'000'000; }), "records.damaged");
  EXPECT_EQ(id_with([](cell_record& record) { record.witness_of.back() = 1'000'000; }), "records.damaged");
  EXPECT_EQ(id_with([](cell_record& record) { record.upper_bound = 2.0; }), "records.damaged");
  EXPECT_EQ(id_with([](cell_record& record) { record.witnesses[0].x = std::numeric_limits<float>::quiet_NaN(); }),
            "records.damaged");
}

}  // namespace
}  // namespace sightcell::bake
