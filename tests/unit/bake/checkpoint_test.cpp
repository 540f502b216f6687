#include "checkpoint.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "sightcell/scene/error.h"

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
  r.seconds = 0.1;
  return r;
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
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "sightcell-checkpoint-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    path_ = folder_ / "out.pvs.bake";
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::size_t files_in_folder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }

  fs::path folder_, path_;
};

TEST_F(checkpoint_test, gives_back_what_was_stored) {
  cell_record empty, edge;
  empty.stored = false;
  edge.set = {0, 1, 0xFFFFFFFEu, 0xFFFFFFFFu};
  edge.upper_bound = std::numeric_limits<double>::denorm_min();
  {
    checkpoint c(path_, "key", false);
    EXPECT_EQ(c.finished(), 0u);
    EXPECT_FALSE(c.load(0).has_value());
    c.store(0, record_of(5));
    c.store(7, empty);
    c.store(0xFFFFFFFEu, edge);
    EXPECT_EQ(c.load(0), record_of(5));
  }
  const checkpoint c(path_, "key", false);
  EXPECT_EQ(c.finished(), 3u);
  EXPECT_EQ(c.load(0), record_of(5));
  EXPECT_EQ(c.load(7), empty);
  EXPECT_EQ(c.load(0xFFFFFFFEu), edge);
  EXPECT_FALSE(c.load(1).has_value());
}

TEST_F(checkpoint_test, storing_again_replaces) {
  checkpoint c(path_, "key", false);
  c.store(1, record_of(5));
  c.store(1, record_of(6));
  EXPECT_EQ(c.load(1), record_of(6));
  EXPECT_EQ(c.finished(), 1u);
}

TEST_F(checkpoint_test, remove_leaves_nothing_behind) {
  checkpoint c(path_, "key", false);
  c.store(1, record_of(5));
  c.remove();
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(checkpoint_test, a_closed_checkpoint_is_one_file) {
  { checkpoint(path_, "key", false).store(1, record_of(5)); }
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(checkpoint_test, another_bake_is_refused_by_name) {
  const std::string key = R"(scene 12 settings {"margin":0.25,"samples":24})";
  { checkpoint(path_, key, false).store(1, record_of(5)); }
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
  EXPECT_EQ(checkpoint(path_, key, false).finished(), 1u);
}

TEST_F(checkpoint_test, fresh_throws_the_old_one_away) {
  { checkpoint(path_, "old", false).store(1, record_of(5)); }
  { EXPECT_EQ(checkpoint(path_, "new", true).finished(), 0u); }
  EXPECT_EQ(checkpoint(path_, "new", false).finished(), 0u);
}

TEST_F(checkpoint_test, a_second_bake_is_refused_even_with_fresh) {
  checkpoint c(path_, "key", false);
  c.store(1, record_of(5));
  EXPECT_EQ(error_id([&] { checkpoint(path_, "key", false); }), "checkpoint.in-use");
  EXPECT_EQ(error_id([&] { checkpoint(path_, "key", true); }), "checkpoint.in-use");
  const pid_t child = fork();
  if (child == 0) _exit(error_id([&] { checkpoint(path_, "key", true); }) == "checkpoint.in-use" ? 0 : 1);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(c.load(1), record_of(5));
}

TEST_F(checkpoint_test, damage_is_refused_by_name_and_fresh_cures_it) {
  write("this is no database, but long enough to be taken for one at first sight" + std::string(500, 'x'));
  EXPECT_EQ(error_id([&] { checkpoint(path_, "key", false); }), "checkpoint.damaged");
  EXPECT_EQ(error_id([&] { checkpoint(path_, "key", true); }), "");
}

TEST_F(checkpoint_test, a_flipped_bit_in_a_record_is_found) {
  { checkpoint(path_, "key", false).store(1, record_of(5, 100'000)); }
  std::stringstream all;
  all << std::ifstream(path_, std::ios::binary).rdbuf();
  std::string bytes = all.str();
  bytes[bytes.size() - 5000] = static_cast<char>(bytes[bytes.size() - 5000] ^ 4);
  write(bytes);
  EXPECT_EQ(error_id([&] { (void)checkpoint(path_, "key", false).load(1); }), "checkpoint.damaged");
}

TEST_F(checkpoint_test, truncation_at_any_page_is_never_silent) {
  { checkpoint(path_, "key", false).store(1, record_of(5, 100'000)); }
  const auto size = fs::file_size(path_);
  for (auto keep = size - 4096; keep > 0; keep -= 4096) {
    fs::resize_file(path_, keep);
    EXPECT_EQ(error_id([&] { (void)checkpoint(path_, "key", false).load(1); }), "checkpoint.damaged") << keep;
  }
}

TEST_F(checkpoint_test, an_empty_file_is_a_new_checkpoint) {
  write("");  // what a kill right after creation leaves
  EXPECT_EQ(checkpoint(path_, "key", false).finished(), 0u);
}

TEST_F(checkpoint_test, folder_that_is_not_there) {
  EXPECT_EQ(error_id([&] { checkpoint(folder_ / "none" / "x.bake", "key", false); }), "checkpoint.not-writable");
}

TEST_F(checkpoint_test, a_full_disk_loses_no_committed_cell) {
  { checkpoint(path_, "key", false).store(1, record_of(5)); }
  const pid_t child = fork();
  if (child == 0) {
    // A file size limit is a disk that fills up: writes fail from there on.
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{256 << 10, 256 << 10};
    setrlimit(RLIMIT_FSIZE, &limit);
    checkpoint c(path_, "key", false);
    std::string id;
    for (std::uint32_t cell = 2; cell < 100 && id.empty(); ++cell)
      id = error_id([&] { c.store(cell, record_of(cell, 20'000)); });
    const bool kept = c.load(1) == record_of(5) && c.load(2) == record_of(2, 20'000);
    _exit(id == "checkpoint.disk-full" || id == "checkpoint.failed" ? (kept ? 0 : 2) : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(checkpoint(path_, "key", false).load(1), record_of(5));
}

TEST_F(checkpoint_test, kill_in_the_middle_keeps_every_committed_cell) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    checkpoint c(path_, "key", false);
    for (std::uint32_t cell = 0;; ++cell) {
      c.store(cell, record_of(cell, 20'000));
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
  EXPECT_GE(c.finished(), 20u);
  for (std::uint32_t cell = 0; cell < c.finished(); ++cell) EXPECT_EQ(c.load(cell), record_of(cell, 20'000));
}

}  // namespace
}  // namespace sightcell::bake
