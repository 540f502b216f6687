// A bake in parts: the same bytes however it is cut up, and a word for all that is missing or does not fit.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "checkpoint/checkpoint.h"
#include "errors/error_id.h"
#include "shards/shard_files.h"
#include "sightcell/bake/shards.h"
#include "sightcell/base/error.h"
#include "sightcell/format/reader.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

namespace fs = std::filesystem;
using test::error_id;

// A room with pillars, and a lattice of cells over six blocks: cells see much the same, and never all of it.
class shards : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "scratch");
    test::tiny_scene tiny;
    tiny.closed_box({-13, -3, -13}, {13, 3, 13}, true);
    for (int i = 0; i < 40; ++i) {
      const float x = -12.0f + 0.6f * static_cast<float>(i), z = static_cast<float>(i * 7 % 23) - 11.0f;
      tiny.closed_box({x, -3, z}, {x + 0.4f, 2, z + 0.5f});
    }
    scene_ = tiny.finished();
    how_.cells_grid = {-8.0f, 0.0f, -4.0f, 8.0f, 1.0f, 4.0f};
    how_.cell_size = 1.0f;
    how_.source = "cpu";
    how_.resolution = 16;
    how_.samples = 6;
    how_.max_pixel_error = 0.05;
  }

  fs::path out(const char* name) const { return folder_ / name; }
  std::vector<std::byte> whole(const char* name = "whole.pvs") {
    (void)bake(scene_, how_, out(name), true, {});
    return test::file_bytes(out(name));
  }
  summary part(const char* name, std::uint32_t index, std::uint32_t count, std::uint32_t phase, bool fresh = false) {
    return bake_shard(scene_, how_, out(name), {index, count, phase}, fresh, {});
  }
  std::vector<std::byte> merged(const char* name) {
    (void)merge(find_shard_files(out(name)), out(name), {});
    return test::file_bytes(out(name));
  }

  const tbb::global_control allowed_{tbb::global_control::max_allowed_parallelism, 8};
  test::fresh_folder folder_;
  scene::scene scene_;
  settings how_;
};

TEST_F(shards, any_number_of_them_gives_the_bytes_of_one_bake) {
  const std::vector<std::byte> one = whole();
  for (const std::uint32_t count : {1u, 3u, 9u}) {  // there are four blocks: some of nine shards have none
    const std::string name = "m" + std::to_string(count) + ".pvs";
    for (const std::uint32_t phase : {1u, 2u})
      for (std::uint32_t i = count; i-- > 0;) {
        how_.threads = 1 + (i + phase) % 3;
        how_.scratch = i % 2 == 0 ? folder_ / "scratch" : fs::path();
        const summary sum = part(name.c_str(), i, count, phase);
        EXPECT_EQ(sum.result, outcome::done);
        EXPECT_EQ(sum.cells_resumed, 0u);
      }
    EXPECT_EQ(merged(name.c_str()), one) << count << " shards";
  }
  EXPECT_TRUE(fs::is_empty(folder_ / "scratch"));
}

TEST_F(shards, of_a_scene_with_doors_give_the_bytes_of_one_bake) {
  scene_.groups = {"gate", "door", "hatch"};
  for (const std::uint32_t i : {0u, 1u, 2u}) scene_.draws[5 * i + 2].tags.group = i;
  how_.closed = {"door"};
  const std::vector<std::byte> one = whole();
  for (const std::uint32_t phase : {1u, 2u})
    for (const std::uint32_t i : {0u, 1u}) (void)part("m.pvs", i, 2, phase);
  EXPECT_EQ(merged("m.pvs"), one);
  EXPECT_EQ(test::stored_file(one).reader().named_groups().count(), 2u);
}

TEST_F(shards, of_clusters_and_with_names_give_the_bytes_of_one_bake) {
  for (const bool clusters : {true, false}) {
    how_.file.granularity = clusters ? set_granularity::cluster : set_granularity::polygon;
    how_.file.names = !clusters;
    const std::vector<std::byte> one = whole();
    for (const std::uint32_t phase : {1u, 2u})
      for (const std::uint32_t i : {0u, 1u}) (void)part("m.pvs", i, 2, phase);
    EXPECT_EQ(merged("m.pvs"), one) << clusters;
    fs::remove(out("m.pvs"));
    for (const auto& shard : find_shard_files(out("m.pvs"))) fs::remove(shard);
  }
}

TEST_F(shards, of_the_merged_layout_give_the_bytes_of_one_bake) {
  for (scene::draw& d : scene_.draws) d.material = scene_.draws[1].material;
  how_.file.profile = slack_profile::exact;  // what slack adds depends on the layout
  test::stored_file instanced(whole("instanced.pvs"));
  for (std::size_t i = 0; i < scene_.draws.size(); ++i) scene_.draws[i].moves = i % 9 == 4;
  how_.file.layout = host_layout::merged;
  const std::vector<std::byte> one = whole();
  for (const std::uint32_t phase : {1u, 2u})
    for (const std::uint32_t i : {0u, 1u}) (void)part("m.pvs", i, 2, phase);
  EXPECT_EQ(merged("m.pvs"), one);
  test::stored_file file(one);
  EXPECT_EQ(file.reader().facts().layout, format::host_layout::merged);
  for (std::uint32_t cell = 0; cell < file.reader().cell_count(); ++cell)
    EXPECT_EQ(file.set(cell), instanced.set(cell)) << cell;
  std::uint32_t moving = 0;
  for (std::uint32_t i = 0; i < file.reader().draw_count(); ++i) {
    format::draw_record d;
    ASSERT_EQ(file.reader().draw(i, d), format::status::ok);
    const auto is_this = [&](const scene::draw& from) { return from.first_source == d.first_source; };
    const auto from = std::find_if(scene_.draws.begin(), scene_.draws.end(), is_this);
    ASSERT_NE(from, scene_.draws.end());
    EXPECT_EQ(d.flags, from->moves ? format::draw_moves : 0u);
    moving += d.flags;
  }
  EXPECT_EQ(file.reader().range_unit_count(), moving + (moving < scene_.draws.size() ? 1 : 0));
}

TEST_F(shards, are_merged_with_their_safety_rings) {
  // The ring is added where the scene is, not by merge, which has none; nor by phase 1, or phase 2 would spread it.
  how_.safety_ring = safety_ring::vertex;
  const summary in_one = bake(scene_, how_, out("whole.pvs"), true, {});
  EXPECT_GT(in_one.unseen_per_cell, 0.0);
  for (const std::uint32_t phase : {1u, 2u})
    for (const std::uint32_t i : {0u, 1u, 2u}) (void)part("m.pvs", i, 3, phase);
  const summary in_parts = merge(find_shard_files(out("m.pvs")), out("m.pvs"), {});
  EXPECT_EQ(test::file_bytes(out("m.pvs")), test::file_bytes(out("whole.pvs")));
  EXPECT_EQ(in_parts.unseen_per_cell, in_one.unseen_per_cell);
  EXPECT_EQ(in_parts.unseen_percent, in_one.unseen_percent);
}

TEST_F(shards, share_what_they_see_within_a_block_and_over_its_border) {
  // Or the tests above would compare cells that know nothing of each other.
  how_.samples = 6;
  how_.file.profile = slack_profile::exact;
  test::stored_file file(whole());
  std::vector<std::vector<std::uint32_t>> sets;  // the file has cells in another order than the shard
  for (std::uint32_t cell = 0; cell < file.reader().cell_count(); ++cell) sets.push_back(file.set(cell));
  (void)part("p.pvs", 0, 1, 1);
  const fs::path phase_1[] = {shard_file(out("p.pvs"), {0, 1, 1})};
  const shard_files before(phase_1, std::nullopt);
  std::size_t grown = 0, stored = 0;
  for (std::uint32_t cell = 0; before.file_with(cell, cell_stage::bounded); ++cell) {
    const cell_record record = before.load(cell, cell_stage::bounded);
    stored += record.stored ? 1 : 0;
    grown += record.stored && std::find(sets.begin(), sets.end(), record.set) == sets.end() ? 1 : 0;
  }
  EXPECT_EQ(stored, sets.size());
  EXPECT_GT(grown, 0u) << "phase 2 found nothing that phase 1 had missed";
}

TEST_F(shards, an_interrupted_shard_resumes_from_its_scratch_or_from_the_copy) {
  const std::vector<std::byte> one = whole();
  for (const bool scratch_is_lost : {false, true}) {
    const char* name = scratch_is_lost ? "lost.pvs" : "kept.pvs";
    how_.scratch = folder_ / "scratch";
    callbacks stop;
    stop.on_progress = [](const progress& now) { return now.cells_done < 5; };
    const summary sum = bake_shard(scene_, how_, out(name), {0, 2, 1}, false, stop);
    EXPECT_EQ(sum.result, outcome::cancelled);
    EXPECT_FALSE(fs::exists(shard_file(out(name), {0, 2, 1})));
    EXPECT_TRUE(fs::exists(shard_file(out(name), {0, 2, 1}).string() + ".bake")) << "the copy";
    if (scratch_is_lost) fs::remove_all(folder_ / "scratch"), fs::create_directories(folder_ / "scratch");
    EXPECT_GE(part(name, 0, 2, 1).cells_resumed, 5u);
    (void)part(name, 1, 2, 1);
    for (const std::uint32_t i : {0u, 1u}) (void)part(name, i, 2, 2);
    EXPECT_EQ(merged(name), one);
    EXPECT_FALSE(fs::exists(shard_file(out(name), {0, 2, 1}).string() + ".bake"));
  }
}

TEST_F(shards, a_single_bake_resumes_from_the_copy_too) {
  const std::vector<std::byte> one = whole();
  how_.scratch = folder_ / "scratch";
  callbacks stop;
  stop.on_progress = [](const progress& now) { return now.cells_done < 5; };
  EXPECT_EQ(bake(scene_, how_, out("s.pvs"), false, stop).result, outcome::cancelled);
  how_.scratch.clear();  // another machine, which works beside the output
  EXPECT_GE(bake(scene_, how_, out("s.pvs"), false, {}).cells_resumed, 5u);
  EXPECT_EQ(test::file_bytes(out("s.pvs")), one);
}

TEST_F(shards, the_order_of_cells_changes_no_set) {
  // The same boxes by hand in two orders: blocks of their own, which see each other in phase 2.
  const auto boxes = [](unsigned seed) {
    std::vector<cell_box> list;
    for (int i = 0; i < 40; ++i) {
      const float x = static_cast<float>(i % 8) * 1.5f - 6.0f, z = static_cast<float>(i / 8) * 1.5f - 4.0f;
      list.push_back({"", {x, 0, z}, {x + 1.5f, 1, z + 1.5f}});
    }
    std::shuffle(list.begin(), list.end(), std::mt19937(seed));
    return list;
  };
  how_.cells_grid.reset();
  how_.file.profile = slack_profile::exact;  // what slack adds depends on the cells before and after
  const auto sets = [&](unsigned seed) {
    how_.cells = boxes(seed);
    test::stored_file stored(whole());
    const format::reader& file = stored.reader();
    std::vector<std::vector<std::uint32_t>> by_place;
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
      format::box b;
      format::certificate_record proof;
      EXPECT_EQ(file.cell_box(cell, b), format::status::ok);
      EXPECT_EQ(file.certificate(cell, proof), format::status::ok);
      std::vector<std::uint32_t> one{static_cast<std::uint32_t>(100.0f * (b.min[0] + 50.0f)),
                                     static_cast<std::uint32_t>(100.0f * (b.min[2] + 50.0f)),
                                     static_cast<std::uint32_t>(proof.rays), static_cast<std::uint32_t>(proof.misses)};
      const std::vector<std::uint32_t> set = stored.set(cell);
      one.insert(one.end(), set.begin(), set.end());
      by_place.push_back(one);
    }
    std::sort(by_place.begin(), by_place.end());
    return by_place;
  };
  const auto first = sets(1);
  EXPECT_GT(first.size(), 20u);
  EXPECT_EQ(sets(2), first);
  EXPECT_EQ(sets(3), first);
}

TEST_F(shards, what_is_missing_is_named) {
  const auto text_of = [&](const auto& act) -> std::string {
    try {
      act();
    } catch (const error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error_id([&] { (void)merged("m.pvs"); }), "shard.none");
  (void)part("m.pvs", 0, 2, 1);
  EXPECT_EQ(error_id([&] { (void)part("m.pvs", 0, 2, 2); }), "shard.missing-blocks");
  EXPECT_NE(text_of([&] { (void)merged("m.pvs"); }).find("2 of 4 blocks are in no shard: block 0,-1"),
            std::string::npos);
  (void)part("m.pvs", 1, 2, 1);
  EXPECT_NE(text_of([&] { (void)merged("m.pvs"); }).find("4 of 4 blocks lack phase 2: block -1,-1"), std::string::npos);
  (void)part("m.pvs", 1, 2, 2);
  EXPECT_NE(text_of([&] { (void)merged("m.pvs"); }).find("2 of 4 blocks lack phase 2: block -1,-1"), std::string::npos);
  EXPECT_FALSE(fs::exists(out("m.pvs")));
}

TEST_F(shards, doubles_must_agree) {
  const std::vector<std::byte> one = whole();
  for (const std::uint32_t phase : {1u, 2u}) {
    for (const std::uint32_t i : {0u, 1u}) (void)part("m.pvs", i, 2, phase);
    (void)part("m.pvs", 1, 3, phase);  // of another cut
  }
  EXPECT_EQ(merged("m.pvs"), one);
  // As if one machine had seen something else.
  const fs::path odd = shard_file(out("m.pvs"), {1, 3, 2});
  {
    const fs::path copy = out("edited");
    fs::copy_file(odd, copy);
    const std::string key = checkpoint::open_to_read(odd).key();
    checkpoint edit(copy, key, false);
    std::optional<std::uint32_t> cell;
    edit.list([&](std::uint32_t which, cell_stage) { cell = which; });
    cell_record record = *edit.load(*cell, cell_stage::finished);
    record.rays_spent += 1;
    const stage_record changed{*cell, cell_stage::finished, record};
    edit.store({&changed, 1});
    edit.copy_to(odd);
  }
  EXPECT_EQ(error_id([&] { (void)merged("m.pvs"); }), "shard.doubles-differ");
}

TEST_F(shards, another_bakes_are_refused) {
  (void)part("m.pvs", 0, 2, 1);
  how_.seed = 2;
  EXPECT_EQ(error_id([&] { (void)part("m.pvs", 0, 2, 1); }), "shard.other-bake");
  (void)part("m.pvs", 1, 2, 1);
  EXPECT_EQ(error_id([&] { (void)merged("m.pvs"); }), "shard.other-bake");
  EXPECT_EQ(error_id([&] { (void)part("m.pvs", 0, 2, 2); }), "shard.other-bake");
  EXPECT_EQ(part("m.pvs", 0, 2, 1, true).result, outcome::done) << "fresh";
  EXPECT_EQ(part("m.pvs", 0, 2, 1).cells_resumed, 128u) << "there already, and left alone";
  EXPECT_EQ(error_id([&] { (void)part("m.pvs", 2, 2, 1); }), "shard.out-of-range");
  how_.time_budget = 60.0;
  EXPECT_EQ(error_id([&] { (void)part("m.pvs", 0, 2, 1); }), "settings.time-budget") << "one clock, one machine";
}

TEST_F(shards, damage_is_named) {
  (void)part("m.pvs", 0, 1, 1);
  (void)part("m.pvs", 0, 1, 2);
  const std::vector<std::byte> good = merged("m.pvs");
  const fs::path file = shard_file(out("m.pvs"), {0, 1, 2});
  const std::vector<std::byte> bytes = test::file_bytes(file);
  std::size_t refused = 0, by_record = 0;
  for (std::size_t at = 10; at < bytes.size(); at += bytes.size() / 60) {
    std::vector<std::byte> bad = bytes;
    bad[at] ^= std::byte{0x55};
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bad.data()), static_cast<std::streamsize>(bad.size()));
    const std::string id = error_id([&] { EXPECT_EQ(merged("m.pvs"), good) << "at " << at; });
    refused += id.empty() ? 0 : 1;
    by_record += id == "shard.damaged" ? 1 : 0;
  }
  EXPECT_GT(refused, 40u) << "the rest was in places that say nothing";
  EXPECT_GT(by_record, 20u) << "by the checksum of a record or of the plan";
  std::ofstream(file, std::ios::binary) << "no database";
  EXPECT_NE(error_id([&] { (void)merged("m.pvs"); }), "");
}

}  // namespace
}  // namespace sightcell::bake
