// write_file of writer.h.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include "sightcell/format/writer.h"

#if defined(__linux__)
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#endif

namespace {

namespace fs = std::filesystem;
using sightcell::format::remove_unfinished;
using sightcell::format::status;
using sightcell::format::write_file;

class file_output : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("sightcell_file_output_" + std::to_string(std::hash<std::thread::id>()(std::this_thread::get_id())) +
               "_" + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const char* name) const {
    const std::u8string folder = folder_.u8string();
    return std::string(folder.begin(), folder.end()) + "/" + name;
  }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

std::vector<std::byte> some_bytes(std::size_t size, int value) {
  return std::vector<std::byte>(size, static_cast<std::byte>(value));
}

std::vector<std::byte> read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

TEST_F(file_output, writes_and_replaces) {
  const std::string name = path("a.pvs");
  ASSERT_EQ(write_file(name.c_str(), some_bytes(1000, 1)), status::ok);
  EXPECT_EQ(read(name), some_bytes(1000, 1));
  ASSERT_EQ(write_file(name.c_str(), some_bytes(10, 2)), status::ok);
  EXPECT_EQ(read(name), some_bytes(10, 2));
  ASSERT_EQ(write_file(name.c_str(), {}), status::ok);
  EXPECT_EQ(read(name).size(), 0u);
  EXPECT_EQ(files(), 1u);
}

TEST_F(file_output, names_are_utf8) {
  const std::string name = path("\xC3\xA9\xE2\x82\xAC.pvs");
  ASSERT_EQ(write_file(name.c_str(), some_bytes(3, 1)), status::ok);
  ASSERT_EQ(files(), 1u);
  EXPECT_TRUE(fs::directory_iterator(folder_)->path().filename().u8string() == u8"\u00E9\u20AC.pvs");
}

// A line feed stays one byte, and the bytes after a control-Z are kept.
TEST_F(file_output, bytes_are_not_text) {
  const std::string name = path("a.pvs");
  std::vector<std::byte> bytes;
  for (const int byte : {0x61, 0x0D, 0x0A, 0x0A, 0x1A, 0x00, 0xFF, 0x62}) bytes.push_back(static_cast<std::byte>(byte));
  ASSERT_EQ(write_file(name.c_str(), bytes), status::ok);
  EXPECT_EQ(read(name), bytes);
}

// Another process has the old file open and continues to read the old bytes. Windows rejects the new ones then, other
// systems do not.
TEST_F(file_output, a_file_that_is_being_read) {
  const std::string name = path("a.pvs");
  ASSERT_EQ(write_file(name.c_str(), some_bytes(100, 1)), status::ok);
  std::ifstream reader(name, std::ios::binary);
  EXPECT_EQ(reader.get(), 1);
  const status s = write_file(name.c_str(), some_bytes(100, 2));
#if defined(_WIN32)
  EXPECT_EQ(s, status::io);
#else
  EXPECT_EQ(s, status::ok);
#endif
  reader.seekg(99);
  EXPECT_EQ(reader.get(), 1);
  reader.close();
  EXPECT_EQ(read(name), some_bytes(100, s == status::ok ? 2 : 1));
  EXPECT_EQ(files(), 1u) << "the temporary file is gone";
  EXPECT_EQ(write_file(name.c_str(), some_bytes(100, 3)), status::ok);
  EXPECT_EQ(read(name), some_bytes(100, 3));
}

TEST_F(file_output, wrong_arguments) {
  EXPECT_EQ(write_file(nullptr, {}), status::argument);
  EXPECT_EQ(write_file("", {}), status::argument);
}

TEST_F(file_output, no_folder_no_file) {
  EXPECT_EQ(write_file(path("nowhere/a.pvs").c_str(), some_bytes(3, 1)), status::io);
  EXPECT_EQ(files(), 0u);
}

TEST_F(file_output, a_folder_is_not_replaced) {
  fs::create_directories(path("a.pvs/inside"));
  EXPECT_EQ(write_file(path("a.pvs").c_str(), some_bytes(3, 1)), status::io);
  EXPECT_EQ(files(), 1u) << "the temporary file is gone";
}

#if defined(__linux__)
TEST_F(file_output, what_is_no_file_is_not_replaced) {
  const std::string name = path("a.pvs");
  ASSERT_EQ(mkfifo(name.c_str(), 0600), 0);
  EXPECT_EQ(write_file(name.c_str(), some_bytes(3, 1)), status::io);
  EXPECT_TRUE(fs::is_fifo(folder_ / "a.pvs"));
  EXPECT_EQ(files(), 1u);
}
#endif

TEST_F(file_output, what_killed_writers_left_goes_and_nothing_else) {
  for (const std::string stem : {"a.pvs", "\xC3\xA9.pvs"}) {
    const std::vector<std::string> left{stem + ".tmp-1-0", stem + ".tmp-4194304-17"};
    const std::vector<std::string> kept{stem,
                                        stem + ".tmp",
                                        stem + ".tmp-",
                                        stem + ".tmp-1",
                                        stem + ".tmp-1-",
                                        stem + ".tmp-1-x",
                                        stem + ".tmp-1-2-3",
                                        stem + ".tmp-1-2.old",
                                        "b" + stem + ".tmp-1-2",
                                        stem + "b.tmp-1-2"};
    for (const auto* list : {&left, &kept})
      for (const std::string& name : *list) ASSERT_EQ(write_file(path(name.c_str()).c_str(), {}), status::ok);
    remove_unfinished(path(stem.c_str()).c_str());
    EXPECT_EQ(files(), kept.size());
    for (const std::string& name : kept)
      EXPECT_EQ(write_file(path(name.c_str()).c_str(), some_bytes(1, 1)), status::ok);
    EXPECT_EQ(files(), kept.size()) << "all of those were there";
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  remove_unfinished(nullptr);
  remove_unfinished("");
  remove_unfinished(path("no/such/folder/a.pvs").c_str());
  EXPECT_EQ(files(), 0u);
}

// A full disk, simulated by the limit on file sizes.
TEST_F(file_output, a_full_disk_keeps_the_old_file) {
#if !defined(__linux__)
  GTEST_SKIP() << "no limit on file sizes to play a full disk with";
#else
  const std::string name = path("a.pvs");
  ASSERT_EQ(write_file(name.c_str(), some_bytes(100, 1)), status::ok);
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const rlimit small{1 << 16, old.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const status s = write_file(name.c_str(), some_bytes(1 << 20, 2));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(s, status::io);
  EXPECT_EQ(read(name), some_bytes(100, 1));
  EXPECT_EQ(files(), 1u);
#endif
}

}  // namespace
