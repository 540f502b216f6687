#include "watch/input_watch.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "sightcell/scene/named_files.h"
#include "unit/bake/fresh_folder.h"

namespace sightcell::cli {
namespace {

// By events, and by comparing alone.
class input_watch_of : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    save(scene_, "first");
    watch_.follow({scene_, missing_});
    watch_.settle();
  }
  static void save(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }
  void save_by_rename(const std::filesystem::path& path, const std::string& text) {
    save(folder_ / "new", text);
    std::filesystem::rename(folder_ / "new", path);
  }
  // Longer than the time between two comparisons.
  bool changes() {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    return watch_.changed();
  }

  const test::fresh_folder folder_;
  const std::filesystem::path scene_ = folder_ / "scene.glb", missing_ = folder_ / "scene.bin";
  input_watch watch_{GetParam()};
};

TEST_P(input_watch_of, a_save_counts_until_it_is_settled) {
  EXPECT_FALSE(changes());
  save(scene_, "second and longer");
  EXPECT_TRUE(changes());
  EXPECT_TRUE(watch_.changed());
  watch_.settle();
  EXPECT_FALSE(changes());
}

TEST_P(input_watch_of, saves_by_rename_and_files_that_come_and_go_count) {
  save_by_rename(scene_, "other");
  EXPECT_TRUE(changes());
  watch_.settle();
  save(missing_, "");
  EXPECT_TRUE(changes());
  watch_.settle();
  std::filesystem::remove(missing_);
  EXPECT_TRUE(changes());
}

TEST_P(input_watch_of, other_files_of_the_folder_do_not_count) {
  save(folder_ / "scene.pvs", "output");
  save_by_rename(folder_ / "scene.pvs", "output");
  EXPECT_FALSE(changes());
}

TEST_P(input_watch_of, a_file_that_joins_the_list_has_not_changed) {
  save(folder_ / "picture.png", "pixels");
  watch_.follow({scene_, folder_ / "picture.png"});
  EXPECT_FALSE(changes());
  save(folder_ / "picture.png", "other pixels");
  EXPECT_TRUE(changes());
}

TEST_P(input_watch_of, a_wait_ends_when_it_is_asked_to) {
  int asked = 0;
  EXPECT_FALSE(watch_.wait([&] { return ++asked == 2; }));
  save(scene_, "second and longer");
  EXPECT_TRUE(watch_.wait([] { return false; }));
}

INSTANTIATE_TEST_SUITE_P(with_and_without_events, input_watch_of, ::testing::Bool());

TEST(named_files, buffers_and_images_in_the_folder_but_no_data_and_nothing_outside) {
  const test::fresh_folder folder;
  std::ofstream(folder / "s.gltf") << R"({"buffers": [{"uri": "a%20b.bin"}, {"uri": "data:;base64,AA"}, {}, 7],
    "images": [{"uri": "pictures/c.png"}, {"uri": "../outside.png"}, {"uri": "http://x/y.png"}, {"uri": 3}]})";
  EXPECT_EQ(scene::named_files(folder / "s.gltf"),
            (std::vector<std::filesystem::path>{folder / "a b.bin", folder / "pictures/c.png"}));
  std::ofstream(folder / "s.gltf") << R"({"buffers": [{"uri")";
  EXPECT_TRUE(scene::named_files(folder / "s.gltf").empty());
  EXPECT_TRUE(scene::named_files(folder / "missing.gltf").empty());
}

}  // namespace
}  // namespace sightcell::cli
