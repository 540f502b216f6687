// Cells that an earlier run decided on: a resumed bake merges nothing again, and has the same bytes.
#include "job/decide_cells.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "checkpoint/work_file.h"
#include "errors/error_id.h"
#include "job/bake_context.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/shards.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

namespace fs = std::filesystem;

// A field of 64 x 64 m, two blocks of cells of 4 m wide, with posts on one half of it.
class decide_cells_test : public testing::Test {
 protected:
  void SetUp() override {
    test::tiny_scene tiny;
    tiny.quad({-32, 0, -32}, {-32, 0, 32}, {32, 0, 32}, {32, 0, -32});
    for (int i = 0; i < 60; ++i) {
      const float x = 2.0f + 3.0f * static_cast<float>(i % 10), z = -28.0f + 9.0f * static_cast<float>(i / 10);
      tiny.closed_box({x, 0, z}, {x + 0.4f, 6, z + 2.0f});
    }
    scene_ = tiny.finished();
    how_.cell_size = 4.0f;
    how_.merge_cells = 0.2;
    how_.source = "cpu";
    how_.resolution = 16;
    how_.samples = 6;
    how_.max_pixel_error = 0.2;
  }

  // What a run rendered to merge cells, and whether it reported that phase.
  struct merging {
    std::uint64_t cubes = 0;
    int phases = 0;
  };
  merging with_context(const find_decided& find, const std::function<void(const bake_context&)>& use = {}) {
    merging done;
    callbacks events;
    events.on_phase = [&](bake_phase phase) { done.phases += phase == bake_phase::merging_cells ? 1 : 0; };
    tbb::task_arena arena;
    std::optional<bake_context> context;
    EXPECT_TRUE(build(context, scene_, how_, nullptr, find, arena, events));
    if (use) use(*context);
    done.cubes = context->merging_cubes;
    return done;
  }
  // Returns whether a bake whose checkpoint has these bytes takes its cells from there.
  bool takes(const std::string& bytes) {
    return with_context([&](const std::string& inputs) { return decided_from(bytes, inputs); }).cubes == 0;
  }
  std::string cell_bytes() {
    std::string bytes;
    (void)with_context({}, [&](const bake_context& context) { bytes = context.cell_bytes; });
    return bytes;
  }

  // A bake that counts how often cells are merged and stops where `stop` returns true.
  summary run(const fs::path& output, const std::function<bool(const progress&)>& stop = {}, bool fresh = false) {
    callbacks events;
    events.on_phase = [&](bake_phase phase) {
      merged_ += phase == bake_phase::merging_cells ? 1 : 0;
      phase_ = phase;
    };
    events.on_progress = [&](const progress& now) { return !stop || !stop(now); };
    return bake(scene_, how_, output, fresh, events);
  }
  std::vector<std::byte> whole(const char* name = "whole.pvs") {
    merged_ = 0;
    EXPECT_NE(run(folder_ / name).result, outcome::cancelled);
    EXPECT_EQ(merged_, 1) << "there is something to merge";
    return test::file_bytes(folder_ / name);
  }
  void expect_resumed_without_merging(const char* name, const std::vector<std::byte>& bytes) {
    merged_ = 0;
    EXPECT_NE(run(folder_ / name).result, outcome::cancelled);
    EXPECT_EQ(merged_, 0);
    EXPECT_EQ(test::file_bytes(folder_ / name), bytes);
    EXPECT_FALSE(fs::exists(folder_ / (std::string(name) + ".bake")));
  }

  const tbb::global_control allowed_{tbb::global_control::max_allowed_parallelism, 8};
  test::fresh_folder folder_;
  scene::scene scene_;
  settings how_;
  int merged_ = 0;
  bake_phase phase_ = bake_phase::loading;
};

bool after_two_cells(const progress& now) {
  return now.cells_done >= 2;
}

TEST_F(decide_cells_test, known_cells_are_taken_and_no_cube_is_rendered) {
  // With a limit, volumes are of cells that are in no merged cell.
  for (const auto& [volumes, limit] : {std::pair(0.0, 0u), std::pair(8.0, 0u), std::pair(8.0, 8u)}) {
    how_.volumes = volumes, how_.cell_limit = limit;
    std::string bytes, key, line;
    std::size_t cells = 0;
    const merging first = with_context({}, [&](const bake_context& context) {
      bytes = context.cell_bytes, key = context.key, line = context.cells->list.how;
      cells = context.cells->list.cells.size();
    });
    // One for each of the smallest cells, and those between.
    EXPECT_GT(first.cubes, limit == 0 ? 256u : 64u);
    EXPECT_EQ(first.phases, 1);
    const auto find = [&](const std::string& inputs) { return decided_from(bytes, inputs); };
    const merging second = with_context(find, [&](const bake_context& context) {
      EXPECT_EQ(context.key, key);
      EXPECT_EQ(context.cell_bytes, bytes);
      EXPECT_EQ(context.cells->list.how, line);
      EXPECT_EQ(context.cells->list.cells.size(), cells);
    });
    EXPECT_EQ(second.cubes, 0u);
    EXPECT_EQ(second.phases, 0);
  }
}

TEST_F(decide_cells_test, cells_of_other_inputs_are_not_taken) {
  const std::string bytes = cell_bytes();
  EXPECT_TRUE(takes(bytes));
  const settings before = how_;
  const scene::scene scene_before = scene_;
  const auto taken_with = [&](const std::function<void()>& change) {
    change();
    const bool taken = takes(bytes);
    how_ = before, scene_ = scene_before;
    return taken;
  };
  EXPECT_FALSE(taken_with([&] { how_.seed = 7; }));
  EXPECT_FALSE(taken_with([&] { how_.merge_cells = 0.1; }));
  EXPECT_FALSE(taken_with([&] { how_.cell_limit = 8; }));
  EXPECT_FALSE(taken_with([&] { how_.source = "rays"; }));
  EXPECT_FALSE(taken_with([&] { how_.paths = {{{0.0f, 9.0f, 0.0f}, {5.0f, 9.0f, 0.0f}}}; }));
  // Not part of the fingerprint of a scene.
  EXPECT_FALSE(taken_with([&] { scene_.starts.push_back({{1.0f, 1.0f, 1.0f}, false}); }));
  EXPECT_FALSE(taken_with([&] {
    scene_.geometries.front().positions.front().x -= 1.0f;
    scene::finish(scene_);
  }));
  EXPECT_TRUE(taken_with([&] { how_.threads = 1; }));
}

TEST_F(decide_cells_test, other_paths_are_other_inputs) {
  how_.paths = {{{0.0f, 9.0f, 0.0f}, {5.0f, 9.0f, 0.0f}}};
  const std::string bytes = cell_bytes();
  EXPECT_TRUE(takes(bytes));
  how_.paths[0][1][0] = 15.0f;
  EXPECT_FALSE(takes(bytes));
  how_.paths.clear();
  how_.path_file = folder_ / "path.json";
  const auto write = [&](const char* points) { std::ofstream(*how_.path_file) << "{\"path\":" << points << "}"; };
  write("[[0,9,0],[5,9,0]]");
  const std::string of_file = cell_bytes();
  EXPECT_TRUE(takes(of_file));
  write("[[0,9,0],[5,9,1]]");
  EXPECT_FALSE(takes(of_file));
}

TEST_F(decide_cells_test, other_starts_of_a_second_scene_are_other_inputs) {
  scene::scene of_cells = scene_;
  how_.cells_from = &of_cells;
  const std::string bytes = cell_bytes();
  EXPECT_TRUE(takes(bytes));
  of_cells.starts.push_back({{1.0f, 30.0f, 1.0f}, false});  // over no floor: the same cells, and a warning
  EXPECT_FALSE(takes(bytes));
}

TEST_F(decide_cells_test, a_resumed_bake_merges_nothing_again) {
  for (const std::uint32_t threads : {1u, 4u}) {
    how_.threads = threads;
    const std::vector<std::byte> bytes = whole();
    EXPECT_EQ(run(folder_ / "stopped.pvs", after_two_cells).result, outcome::cancelled);
    expect_resumed_without_merging("stopped.pvs", bytes);
  }
}

TEST_F(decide_cells_test, merging_is_kept_as_soon_as_it_is_complete) {
  const std::vector<std::byte> bytes = whole();
  // Canceled in the trials of the estimate, which follow, with no cell finished.
  for (const bool scratch_is_lost : {false, true}) {
    how_.scratch = folder_ / "scratch";
    fs::create_directories(how_.scratch);
    const auto stop = [&](const progress&) { return phase_ == bake_phase::estimating; };
    EXPECT_EQ(run(folder_ / "stopped.pvs", stop).result, outcome::cancelled);
    EXPECT_EQ(phase_, bake_phase::estimating);
    if (scratch_is_lost) fs::remove_all(how_.scratch), fs::create_directories(how_.scratch);
    expect_resumed_without_merging("stopped.pvs", bytes);
    how_.scratch.clear();
  }
  // Canceled while cells are merged: nothing is stored, and nothing is left behind.
  const auto stop = [&](const progress&) { return phase_ == bake_phase::merging_cells; };
  EXPECT_EQ(run(folder_ / "early.pvs", stop).result, outcome::cancelled);
  EXPECT_FALSE(fs::exists(folder_ / "early.pvs.bake"));
}

TEST_F(decide_cells_test, a_bake_in_its_time_budget_resumes_without_merging) {
  how_.time_budget = 1000.0;
  EXPECT_EQ(run(folder_ / "timed.pvs", after_two_cells).result, outcome::cancelled);
  EXPECT_EQ(merged_, 1);
  how_.time_budget = 2000.0;
  EXPECT_NE(run(folder_ / "timed.pvs").result, outcome::cancelled);
  EXPECT_EQ(merged_, 1);
}

TEST_F(decide_cells_test, fresh_merges_again) {
  const std::vector<std::byte> bytes = whole();
  EXPECT_EQ(run(folder_ / "stopped.pvs", after_two_cells).result, outcome::cancelled);
  merged_ = 0;
  (void)run(folder_ / "stopped.pvs", {}, true);
  EXPECT_EQ(merged_, 1);
  EXPECT_EQ(test::file_bytes(folder_ / "stopped.pvs"), bytes);
}

// Opens a checkpoint with its own key and other cells.
void replace_cells(const fs::path& path, const std::string& cells) {
  fs::path copy = path;
  copy += ".copy";
  fs::copy_file(path, copy);
  const std::string key = checkpoint::open_to_read(copy).key();
  fs::remove(copy);
  const checkpoint edited(path, key, false, {}, cells);
}

TEST_F(decide_cells_test, damaged_cells_in_a_checkpoint_are_decided_again) {
  const std::vector<std::byte> bytes = whole();
  const std::string good = cell_bytes();
  for (const std::string& bad : {std::string(), good.substr(0, good.size() - 1), std::string(1000, '\xFF')}) {
    EXPECT_EQ(run(folder_ / "damaged.pvs", after_two_cells).result, outcome::cancelled);
    replace_cells(folder_ / "damaged.pvs.bake", bad);
    merged_ = 0;
    EXPECT_EQ(run(folder_ / "damaged.pvs", after_two_cells).result, outcome::cancelled);
    EXPECT_EQ(merged_, 1);
    EXPECT_EQ(checkpoint::cells_in(folder_ / "damaged.pvs.bake"), good) << "stored again";
    expect_resumed_without_merging("damaged.pvs", bytes);
  }
}

// Well-formed, and not those of the key: the bake must not mix records of two lists.
TEST_F(decide_cells_test, a_checkpoint_with_the_cells_of_another_bake_is_refused) {
  (void)whole();
  EXPECT_EQ(run(folder_ / "forged.pvs", after_two_cells).result, outcome::cancelled);
  decided_cells cells = *decode_cells(cell_bytes());
  cells.list.cells.pop_back();
  replace_cells(folder_ / "forged.pvs.bake", encode(cells));
  EXPECT_EQ(test::error_id([&] { (void)run(folder_ / "forged.pvs"); }), "checkpoint.other-bake");
  EXPECT_NE(run(folder_ / "forged.pvs", {}, true).result, outcome::cancelled);
  EXPECT_EQ(test::file_bytes(folder_ / "forged.pvs"), test::file_bytes(folder_ / "whole.pvs"));
}

TEST_F(decide_cells_test, a_resumed_shard_merges_nothing_again) {
  callbacks events;
  events.on_phase = [&](bake_phase phase) { merged_ += phase == bake_phase::merging_cells ? 1 : 0; };
  events.on_progress = [](const progress& now) { return !after_two_cells(now); };
  const fs::path output = folder_ / "shards.pvs";
  EXPECT_EQ(bake_shard(scene_, how_, output, {0, 2, 1}, false, events).result, outcome::cancelled);
  events.on_progress = {};
  EXPECT_NE(bake_shard(scene_, how_, output, {0, 2, 1}, false, events).result, outcome::cancelled);
  EXPECT_EQ(merged_, 1);
}

TEST_F(decide_cells_test, shards_take_the_cells_of_the_first_that_is_complete) {
  const std::vector<std::byte> bytes = whole();
  merged_ = 0;
  callbacks events;
  events.on_phase = [&](bake_phase phase) { merged_ += phase == bake_phase::merging_cells ? 1 : 0; };
  const fs::path output = folder_ / "shards.pvs";
  const auto part = [&](std::uint32_t index, std::uint32_t phase, bool fresh = false) {
    EXPECT_NE(bake_shard(scene_, how_, output, {index, 2, phase}, fresh, events).result, outcome::cancelled);
  };
  part(0, 1);
  EXPECT_EQ(merged_, 1);
  part(1, 1);
  for (const std::uint32_t index : {0u, 1u}) part(index, 2);
  part(1, 2);  // is complete, and does nothing
  EXPECT_EQ(merged_, 1);
  (void)merge(find_shard_files(output), output, {});
  EXPECT_EQ(test::file_bytes(output), bytes);
  part(1, 1, true);
  EXPECT_EQ(merged_, 2) << "fresh takes nothing";
}

TEST_F(decide_cells_test, shards_trust_no_broken_and_no_foreign_file) {
  const std::vector<std::byte> bytes = whole();
  callbacks events;
  events.on_phase = [&](bake_phase phase) { merged_ += phase == bake_phase::merging_cells ? 1 : 0; };
  const fs::path output = folder_ / "shards.pvs";
  const auto part = [&](std::uint32_t index, std::uint32_t phase) {
    (void)bake_shard(scene_, how_, output, {index, 2, phase}, false, events);
  };
  // Of another seed, whose cells differ; then bytes that are no database.
  how_.seed = 7;
  part(0, 1);
  how_.seed = settings().seed;
  const fs::path first = shard_file(output, {0, 2, 1});
  merged_ = 0;
  part(1, 1);
  EXPECT_EQ(merged_, 1);
  std::ofstream(first, std::ios::binary) << std::string(5000, 'x');
  fs::remove(shard_file(output, {1, 2, 1}));
  part(1, 1);
  EXPECT_EQ(merged_, 2);
  fs::remove(first);
  part(0, 1);
  for (const std::uint32_t index : {0u, 1u}) part(index, 2);
  EXPECT_EQ(merged_, 2);
  (void)merge(find_shard_files(output), output, {});
  EXPECT_EQ(test::file_bytes(output), bytes);
}

}  // namespace
}  // namespace sightcell::bake
