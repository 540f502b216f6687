#include "checkpoint/checkpoint.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "sightcell/base/error.h"
#include "unit/bake/fresh_folder.h"

namespace sightcell::bake {
namespace {

namespace fs = std::filesystem;

cell_record record_of(std::uint32_t seed, std::uint32_t polygons = 1000) {
  cell_record r;
  for (std::uint32_t i = 0; i < polygons; ++i) r.set.push_back(seed + i * (seed % 7 + 1));
  r.rays = 1'000'000'000'000u + seed;
  r.misses = seed;
  r.upper_bound = 1.0 / 3.0;
  r.confidence = 0.95;
  r.rays_spent = std::numeric_limits<std::uint64_t>::max();
  r.samples = 24;
  r.bound_met = seed % 2 == 0;
  r.geometry_inside = true;
  r.valid_share = 0.1;
  r.witnesses = {{1.0f, -2.0f, 0.1f}, {3.0f, 4.0f, 5.0f}};
  for (std::uint32_t i = 0; i < polygons; ++i) r.witness_of.push_back(i / 3 % 2);
  return r;
}

constexpr cell_stage done = cell_stage::finished;

void store(checkpoint& c, std::uint32_t cell, const cell_record& record, cell_stage stage = done) {
  const stage_record one{cell, stage, record};
  c.store({&one, 1});
}
void store(checkpoint&& c, std::uint32_t cell, const cell_record& record) {
  store(c, cell, record);
}

std::string error_id(const std::function<void()>& act) {
  try {
    act();
  } catch (const error& e) {
    return e.id();
  }
  return "";
}

class checkpoint_test : public testing::Test {
 protected:
  std::size_t files_in_folder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }
  static void write_file(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  void write(const std::string& bytes) const { write_file(path_, bytes); }

  test::fresh_folder folder_;
  fs::path path_ = folder_ / "out.pvs.bake";
};

TEST_F(checkpoint_test, gives_back_what_was_stored) {
  cell_record empty, edge;
  empty.stored = false;
  edge.set = {0, 1, 0xFFFFFFFEu, 0xFFFFFFFFu};
  edge.upper_bound = std::numeric_limits<double>::denorm_min();
  {
    checkpoint c(path_, "key", false);
    EXPECT_EQ(c.count(done), 0u);
    EXPECT_FALSE(c.load(0, done).has_value());
    store(c, 0, record_of(5));
    store(c, 7, empty);
    store(c, 0xFFFFFFFEu, edge);
    EXPECT_EQ(c.load(0, done), record_of(5));
  }
  const checkpoint c(path_, "key", false);
  EXPECT_EQ(c.count(done), 3u);
  EXPECT_EQ(c.load(0, done), record_of(5));
  EXPECT_EQ(c.load(7, done), empty);
  EXPECT_EQ(c.load(0xFFFFFFFEu, done), edge);
  EXPECT_FALSE(c.load(1, done).has_value());
}

TEST_F(checkpoint_test, storing_again_replaces) {
  checkpoint c(path_, "key", false);
  store(c, 1, record_of(5));
  store(c, 1, record_of(6));
  EXPECT_EQ(c.load(1, done), record_of(6));
  EXPECT_EQ(c.count(done), 1u);
}

TEST_F(checkpoint_test, stages_are_records_of_their_own_and_first_rounds_are_forgotten) {
  checkpoint c(path_, "key", false);
  store(c, 3, record_of(1), cell_stage::sampled);
  store(c, 4, record_of(2), cell_stage::sampled);
  EXPECT_FALSE(c.load(3, cell_stage::bounded).has_value());
  const stage_record bounded{3, cell_stage::bounded, record_of(3)};
  const std::vector<std::uint32_t> forget{3};
  c.store({&bounded, 1}, forget);
  EXPECT_FALSE(c.load(3, cell_stage::sampled).has_value());
  EXPECT_EQ(c.load(3, cell_stage::bounded), record_of(3));
  EXPECT_EQ(c.load(4, cell_stage::sampled), record_of(2));
  EXPECT_EQ(c.count(cell_stage::sampled), 1u);
  EXPECT_EQ(c.count(done), 0u);
}

TEST_F(checkpoint_test, several_records_are_stored_or_none) {
  checkpoint c(path_, "key", false);
  std::vector<stage_record> both{{1, done, record_of(1)}, {2, done, record_of(2)}};
  c.store(both);
  EXPECT_EQ(c.load(1, done), record_of(1));
  EXPECT_EQ(c.load(2, done), record_of(2));
}

TEST_F(checkpoint_test, a_survey_tells_of_all_and_drops_what_is_damaged) {
  {
    checkpoint c(path_, "key", false);
    for (const std::uint32_t cell : {1u, 2u, 3u}) store(c, cell, record_of(cell, 100'000));
  }
  // A bit of the second record: its pages lie between those of the others.
  std::stringstream all;
  all << std::ifstream(path_, std::ios::binary).rdbuf();
  std::string bytes = all.str();
  const std::size_t middle_of_page = bytes.size() / 2 / 4096 * 4096 + 2000;
  bytes[middle_of_page] = static_cast<char>(bytes[middle_of_page] ^ 4);
  write(bytes);
  checkpoint c(path_, "key", false);
  std::vector<std::uint32_t> told;
  const std::uint32_t dropped = c.survey([&](std::uint32_t cell, cell_stage stage, const cell_summary& summary) {
    EXPECT_EQ(stage, done);
    EXPECT_EQ(summary.polygons, 100'000u);
    EXPECT_EQ(summary.misses, cell);
    told.push_back(cell);
  });
  EXPECT_EQ(dropped, 1u);
  EXPECT_EQ(told.size(), 2u);
  EXPECT_EQ(c.count(done), 2u) << "the damaged one is gone, and its cell baked anew";
}

TEST_F(checkpoint_test, a_copy_holds_all_and_is_read_without_a_lock) {
  checkpoint c(path_, "key", false, "the plan");
  store(c, 1, record_of(5));
  const fs::path copy = folder_ / "a copy # 100 %?.bake";
  write_file(copy, "what was there before");
  c.copy_to(copy);
  EXPECT_FALSE(fs::exists(copy.string() + ".partial"));
  const checkpoint read = checkpoint::open_to_read(copy), again = checkpoint::open_to_read(copy);
  EXPECT_EQ(read.key(), "key");
  EXPECT_EQ(read.plan(), "the plan");
  EXPECT_EQ(again.load(1, done), record_of(5));
  EXPECT_EQ(error_id([&] { c.copy_to(folder_ / "none" / "x"); }), "checkpoint.not-copied");
}

TEST_F(checkpoint_test, cells_are_stored_with_the_key_and_read_before_it_is_known) {
  const std::string cells("cells\0of a bake", 15);
  EXPECT_EQ(checkpoint::cells_in(path_), "") << "no file";
  EXPECT_EQ(files_in_folder(), 0u) << "and none is made";
  {
    checkpoint c(path_, "key", false, "the plan", cells);
    EXPECT_EQ(c.cells(), cells);
    store(c, 1, record_of(5));
    c.copy_to(folder_ / "copy");
    EXPECT_EQ(error_id([&] { (void)checkpoint::cells_in(path_); }), "checkpoint.in-use");
  }
  EXPECT_EQ(checkpoint::cells_in(path_), cells);
  EXPECT_EQ(checkpoint::open_to_read(folder_ / "copy").cells(), cells);
  EXPECT_EQ(checkpoint(path_, "key", false, "the plan", cells).load(1, done), record_of(5));
  const auto all = [](const std::string&) { return [](std::uint32_t, cell_stage) { return false; }; };
  const checkpoint next(path_, "next", false, "its plan", "its cells", all);
  EXPECT_EQ(next.cells(), "its cells");
  EXPECT_EQ(next.load(1, done), record_of(5));
}

TEST_F(checkpoint_test, damaged_cells_are_none_and_are_stored_again) {
  const std::string cells(100'000, 'c');
  { store(checkpoint(path_, "key", false, {}, cells), 1, record_of(5)); }
  std::stringstream all;
  all << std::ifstream(path_, std::ios::binary).rdbuf();
  std::string bytes = all.str();
  const std::size_t middle = bytes.find(std::string(2000, 'c')) + 1000;
  bytes[middle] = 'd';
  write(bytes);
  EXPECT_EQ(checkpoint::cells_in(path_), "");
  { EXPECT_EQ(checkpoint(path_, "key", false, {}, cells).load(1, done), record_of(5)); }
  EXPECT_EQ(checkpoint::cells_in(path_), cells);
}

TEST_F(checkpoint_test, cells_of_what_is_no_checkpoint_are_refused_by_name) {
  write("");
  EXPECT_EQ(checkpoint::cells_in(path_), "") << "what a kill right after creation leaves";
  fs::remove(path_);
  { store(checkpoint(path_, "key", false, {}, std::string(100'000, 'c')), 1, record_of(5)); }
  for (auto keep = fs::file_size(path_) - 4096; keep > 0; keep -= 4096) {
    fs::resize_file(path_, keep);
    EXPECT_EQ(error_id([&] { (void)checkpoint::cells_in(path_); }), "checkpoint.damaged") << keep;
  }
  write("this is no database, but long enough to be taken for one at first sight" + std::string(500, 'x'));
  EXPECT_EQ(error_id([&] { (void)checkpoint::cells_in(path_); }), "checkpoint.damaged");
}

TEST_F(checkpoint_test, a_file_of_another_version_is_not_read) {
  { store(checkpoint(path_, "key", false, {}, "cells"), 1, record_of(5)); }
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, "PRAGMA user_version=1", nullptr, nullptr, nullptr);
  sqlite3_close(database);
  EXPECT_EQ(error_id([&] { checkpoint::open_to_read(path_); }), "checkpoint.other-version");
  EXPECT_EQ(checkpoint::cells_in(path_), "");
  EXPECT_EQ(error_id([&] { checkpoint(path_, "key", false); }), "checkpoint.other-bake");
}

TEST_F(checkpoint_test, what_a_kill_leaves_is_brought_in) {
  const pid_t child = fork();
  if (child == 0) {
    checkpoint c(path_, "key", false);
    for (std::uint32_t cell = 0; cell < 20; ++cell) store(c, cell, record_of(cell));
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_GT(files_in_folder(), 1u) << "a log beside it";
  const checkpoint c(path_, "key", false);
  EXPECT_EQ(c.count(done), 20u);
}

TEST_F(checkpoint_test, remove_leaves_nothing_behind) {
  checkpoint c(path_, "key", false);
  store(c, 1, record_of(5));
  c.remove();
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(checkpoint_test, a_closed_checkpoint_is_one_file) {
  { store(checkpoint(path_, "key", false), 1, record_of(5)); }
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(checkpoint_test, another_bake_is_refused_by_name) {
  const std::string key = R"(scene 12 settings {"margin":0.25,"samples":24})";
  { store(checkpoint(path_, key, false), 1, record_of(5)); }
  const auto refusal = [&](const char* other) -> std::string {
    try {
      checkpoint(path_, other, false);
    } catch (const error& e) {
      EXPECT_EQ(e.id(), "checkpoint.other-bake");
      EXPECT_NE(std::string(e.what()).find("--fresh"), std::string::npos);
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refusal(R"(scene 12 settings {"margin":0.25,"samples":48})").find("differs in samples;"),
            std::string::npos);
  EXPECT_NE(refusal(R"(scene 13 settings {"margin":1,"samples":24})").find("differs in margin;"), std::string::npos);
  EXPECT_NE(refusal(R"(scene 13 settings {"margin":0.25,"samples":24})").find("differs in the scene or its cells;"),
            std::string::npos);
  EXPECT_NE(refusal(R"(scene 12 settings {"margin":0.25})").find("differs in samples;"), std::string::npos);
  EXPECT_NE(refusal("other words").find("differs in scene, settings or version;"), std::string::npos);
  EXPECT_EQ(checkpoint(path_, key, false).count(done), 1u);
}

TEST_F(checkpoint_test, fresh_throws_the_old_one_away) {
  { store(checkpoint(path_, "old", false), 1, record_of(5)); }
  { EXPECT_EQ(checkpoint(path_, "new", true).count(done), 0u); }
  EXPECT_EQ(checkpoint(path_, "new", false).count(done), 0u);
}

TEST_F(checkpoint_test, a_second_bake_is_refused_even_with_fresh) {
  checkpoint c(path_, "key", false);
  store(c, 1, record_of(5));
  EXPECT_EQ(error_id([&] { checkpoint(path_, "key", false); }), "checkpoint.in-use");
  EXPECT_EQ(error_id([&] { checkpoint(path_, "key", true); }), "checkpoint.in-use");
  const pid_t child = fork();
  if (child == 0) _exit(error_id([&] { checkpoint(path_, "key", true); }) == "checkpoint.in-use" ? 0 : 1);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(c.load(1, done), record_of(5));
}

TEST_F(checkpoint_test, damage_is_refused_by_name_and_fresh_cures_it) {
  write("this is no database, but long enough to be taken for one at first sight" + std::string(500, 'x'));
  EXPECT_EQ(error_id([&] { checkpoint(path_, "key", false); }), "checkpoint.damaged");
  EXPECT_EQ(error_id([&] { checkpoint(path_, "key", true); }), "");
}

TEST_F(checkpoint_test, a_flipped_bit_in_a_record_is_found) {
  { store(checkpoint(path_, "key", false), 1, record_of(5, 100'000)); }
  std::stringstream all;
  all << std::ifstream(path_, std::ios::binary).rdbuf();
  std::string bytes = all.str();
  bytes[bytes.size() - 5000] = static_cast<char>(bytes[bytes.size() - 5000] ^ 4);
  write(bytes);
  EXPECT_EQ(error_id([&] { (void)checkpoint(path_, "key", false).load(1, done); }), "checkpoint.damaged");
}

TEST_F(checkpoint_test, truncation_at_any_page_is_never_silent) {
  { store(checkpoint(path_, "key", false), 1, record_of(5, 100'000)); }
  const auto size = fs::file_size(path_);
  for (auto keep = size - 4096; keep > 0; keep -= 4096) {
    fs::resize_file(path_, keep);
    EXPECT_EQ(error_id([&] { (void)checkpoint(path_, "key", false).load(1, done); }), "checkpoint.damaged") << keep;
  }
}

TEST_F(checkpoint_test, an_empty_file_is_a_new_checkpoint) {
  write("");  // what a kill right after creation leaves
  EXPECT_EQ(checkpoint(path_, "key", false).count(done), 0u);
}

TEST_F(checkpoint_test, folder_that_is_not_there) {
  EXPECT_EQ(error_id([&] { checkpoint(folder_ / "none" / "x.bake", "key", false); }), "checkpoint.not-writable");
}

TEST_F(checkpoint_test, a_full_disk_loses_no_committed_cell) {
  { store(checkpoint(path_, "key", false), 1, record_of(5)); }
  const pid_t child = fork();
  if (child == 0) {
    // A file size limit is a disk that fills up: writes fail from there on.
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{256 << 10, 256 << 10};
    setrlimit(RLIMIT_FSIZE, &limit);
    checkpoint c(path_, "key", false);
    std::string id;
    for (std::uint32_t cell = 2; cell < 100 && id.empty(); ++cell)
      id = error_id([&] { store(c, cell, record_of(cell, 20'000)); });
    const bool kept = c.load(1, done) == record_of(5) && c.load(2, done) == record_of(2, 20'000);
    _exit(id == "checkpoint.disk-full" || id == "checkpoint.failed" ? (kept ? 0 : 2) : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(checkpoint(path_, "key", false).load(1, done), record_of(5));
}

TEST_F(checkpoint_test, kill_in_the_middle_keeps_every_committed_cell) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    checkpoint c(path_, "key", false);
    for (std::uint32_t cell = 0;; ++cell) {
      store(c, cell, record_of(cell, 20'000));
      (void)!::write(ready[1], "x", 1);
    }
  }
  char told = 0;
  for (int i = 0; i < 20; ++i) ASSERT_EQ(::read(ready[0], &told, 1), 1);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  close(ready[0]);
  close(ready[1]);
  const checkpoint c(path_, "key", false);
  EXPECT_GE(c.count(done), 20u);
  for (std::uint32_t cell = 0; cell < c.count(done); ++cell) EXPECT_EQ(c.load(cell, done), record_of(cell, 20'000));
}

}  // namespace
}  // namespace sightcell::bake
