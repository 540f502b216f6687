// The whole bake as a library call, on rooms of a few polygons.
#include "sightcell/bake/bake.h"
#include "sightcell/bake/verify.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <stdexcept>
#include <thread>

#include "errors/error_id.h"
#include "sightcell/base/error.h"
#include "sightcell/format/eye_table.h"
#include "sightcell/format/reader.h"
#include "sightcell/picture/gl_context.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;

class bake_library : public testing::Test {
 protected:
  // A room with a screen in it that turns its back to the cells.
  static scene::scene room(std::uint32_t& back) {
    tiny_scene tiny;
    tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
    back = tiny.wall_x(5, +1, 1);
    return tiny.finished();
  }
  // Those that this machine has.
  static std::vector<std::string> sources() {
    std::vector<std::string> names{"cpu", "rays"};
    try {
      const picture::gl_context probe;
      names.push_back("gpu");
    } catch (const error& e) {
      std::fprintf(stderr, "without gpu: %s\n", e.what());
    }
    return names;
  }
  static settings four_cells() {
    settings how;
    how.cells_grid = {-2.0f, 0.0f, -2.0f, 2.0f, 1.0f, 2.0f};
    how.cell_size = 2.0f;
    how.resolution = 64;
    how.file.profile = slack_profile::exact;
    return how;
  }

  test::fresh_folder folder_;
};

TEST_F(bake_library, hemicubes_see_both_sides_when_told) {
  std::uint32_t back = 0;
  const scene::scene s = room(back);
  settings how = four_cells();
  how.max_pixel_error = 0.0;  // hemicubes alone
  for (const std::string& source : sources())
    for (const bool both : {false, true}) {
      how.source = source;
      how.all_double_sided = both;
      const auto path = folder_ / "room.pvs";
      const summary sum = bake(s, how, path, true, {});
      EXPECT_EQ(sum.result, outcome::done);
      test::stored_file file(test::file_bytes(path));
      EXPECT_EQ(file.reader().cell_count(), 4u);
      EXPECT_EQ(file.has(0, back), both) << source;
      format::eye_table eyes;
      ASSERT_EQ(format::eye_table::open(file.reader(), eyes), format::status::ok);
      for (std::uint32_t cell = 0; cell < 4; ++cell) EXPECT_EQ(eyes.count(cell), 1u);
    }
}

// Confetti in a white room: few coarse hemicubes see little of it, and rays beside what they saw find no more.
TEST_F(bake_library, the_error_is_that_of_the_metric) {
  tiny_scene tiny;
  tiny.closed_box({-3, -3, -3}, {3, 3, 3}, true);
  for (int i = 0; i < 400; ++i) {
    const float y = -2.0f + 0.2f * static_cast<float>(i % 20), z = -2.0f + 0.2f * static_cast<float>(i / 20);
    tiny.triangle({2, y, z}, {2, y, z + 0.05f}, {2, y + 0.05f, z}, {scene::alpha_mode::opaque, true});
  }
  const scene::scene s = tiny.finished();
  settings how;
  how.cells = {{"stand", {-0.2f, -0.2f, -0.2f}, {0.2f, 0.2f, 0.2f}}};
  how.source = "cpu";
  how.sampler = "halton";
  how.samples = 6;
  how.resolution = 16;
  const auto certificate = [&](const metric_settings& metric, const std::filesystem::path& path) {
    how.metric = metric;
    EXPECT_EQ(bake(s, how, path, true, {}).result, outcome::done);
    const std::vector<std::byte> bytes = test::file_bytes(path);
    format::reader file;
    format::certificate_record record;
    EXPECT_EQ(format::reader::open(bytes, file), format::status::ok);
    EXPECT_EQ(file.certificate(0, record), format::status::ok);
    return record;
  };
  // A first look is 97.5 % sure, whatever comes after it more.
  EXPECT_GT(certificate({}, folder_ / "pixel.pvs").confidence, 0.99);
  for (const metric_settings& metric :
       {metric_settings{.kind = metric_kind::color}, metric_settings{.kind = metric_kind::view, .view_least = 1e6}}) {
    const format::certificate_record record = certificate(metric, folder_ / "other.pvs");
    EXPECT_NEAR(record.confidence, 0.9875, 1e-7) << "all is white, or too small";
    EXPECT_EQ(record.misses, 0u);
  }
}

TEST_F(bake_library, what_moves_is_in_the_sets_unless_told_to_be_left_out) {
  tiny_scene tiny;
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const std::uint32_t screen = tiny.wall_x(5, -1, 1);
  scene::scene s = tiny.finished();
  s.draws.back().tags.animated = true;
  scene::finish(s);
  settings how = four_cells();
  how.max_pixel_error = 0.0;
  for (const auto animated : {scene::animated_as::always, scene::animated_as::rest, scene::animated_as::dynamic}) {
    how.animated = animated;
    (void)bake(s, how, folder_ / "screen.pvs", true, {});
    test::stored_file file(test::file_bytes(folder_ / "screen.pvs"));
    EXPECT_EQ(file.has(0, screen), animated != scene::animated_as::dynamic);
  }
}

// A room with twelve cells, and pillars that make each see something else.
class several_cells : public bake_library {
 protected:
  void SetUp() override {
    bake_library::SetUp();
    tiny_scene tiny;
    tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
    for (int i = 0; i < 30; ++i) {
      const float x = -7.0f + 0.5f * static_cast<float>(i), z = i % 2 == 0 ? 3.1f : -3.6f;
      tiny.closed_box({x, -9, z}, {x + 0.3f, 4, z + 0.4f});
    }
    scene_ = tiny.finished();
    how_.cells_grid = {-6.0f, 0.0f, -2.0f, 6.0f, 1.0f, 2.0f};
    how_.cell_size = 2.0f;
    how_.resolution = 32;
    how_.samples = 12;
    how_.max_pixel_error = 0.05;
  }
  std::vector<std::byte> baked(const char* name, const callbacks& events = {}, outcome expected = outcome::done) {
    const summary sum = bake(scene_, how_, folder_ / name, false, events);
    EXPECT_EQ(sum.result, expected);
    EXPECT_EQ(sum.source, how_.source);
    resumed_ = sum.cells_resumed;
    return test::file_bytes(folder_ / name);
  }

  static constexpr std::uint32_t cells = 12;
  const tbb::global_control allowed_{tbb::global_control::max_allowed_parallelism, 8};
  scene::scene scene_;
  settings how_;
  std::uint32_t resumed_ = 0;
};

TEST_F(several_cells, threads_change_no_byte) {
  std::set<std::vector<std::byte>> by_source;
  for (const std::string& source : sources()) {
    how_.source = source;
    std::vector<std::byte> first;
    for (const std::uint32_t threads : {1u, 2u, 8u}) {
      how_.threads = threads;
      const std::vector<std::byte> bytes = baked("room.pvs");
      ASSERT_FALSE(bytes.empty());
      if (first.empty()) first = bytes;
      EXPECT_EQ(bytes, first) << source << " with " << threads << " threads";
    }
    by_source.insert(first);
  }
  EXPECT_EQ(by_source.size(), sources().size()) << "the file says which source it was";
}

// No device here can be taken away; what the driver says of it can. From the given question on it was reset.
class device_to_lose {
 public:
  explicit device_to_lose(int at) : driver_(epoxy_glGetGraphicsResetStatus) {
    questions_ = 0;
    lost_at_ = at;
    epoxy_glGetGraphicsResetStatus = says;
  }
  ~device_to_lose() { epoxy_glGetGraphicsResetStatus = driver_; }
  device_to_lose(const device_to_lose&) = delete;
  device_to_lose& operator=(const device_to_lose&) = delete;
  int questions() const { return questions_; }

 private:
  static GLenum GLAPIENTRY says() { return ++questions_ >= lost_at_ ? GL_INNOCENT_CONTEXT_RESET : GL_NO_ERROR; }
  static inline int questions_ = 0, lost_at_ = 0;
  decltype(epoxy_glGetGraphicsResetStatus) driver_;
};

TEST_F(several_cells, a_lost_graphics_device_costs_no_finished_cell) {
  if (sources().back() != "gpu") GTEST_SKIP() << "no OpenGL here";
  how_.source = "gpu";
  how_.threads = 1;  // several share calls of the device, now more, now fewer
  std::vector<std::byte> whole;
  int questions = 0;
  {
    const device_to_lose kept(std::numeric_limits<int>::max());
    whole = baked("whole.pvs");
    questions = kept.questions();
  }
  ASSERT_GT(questions, 2 * static_cast<int>(cells)) << "asked whenever something is read back";
  std::uint32_t most = 0;
  for (const int at : {1, questions / 4, questions / 2, questions}) {
    std::uint32_t finished = 0;
    callbacks events;
    events.on_progress = [&](const progress& now) {
      finished = now.cells_done;
      return true;
    };
    {
      const device_to_lose lost(at);
      EXPECT_EQ(test::error_id([&] { (void)bake(scene_, how_, folder_ / "lost.pvs", false, events); }), "gl.lost")
          << at;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "lost.pvs"));
    EXPECT_EQ(baked("lost.pvs"), whole) << "lost at " << at << " of " << questions;
    EXPECT_GE(resumed_, finished);
    most = std::max(most, resumed_);
    std::filesystem::remove(folder_ / "lost.pvs");
  }
  EXPECT_GT(most, 0u);
}

TEST_F(several_cells, a_cancelled_bake_leaves_no_file_and_resumes_to_the_same_bytes) {
  std::uint32_t most_resumed = 0;
  for (const std::string& source : sources())
    for (const std::uint32_t threads : {1u, 2u, 8u}) {
      if (source == "gpu" && threads != 2) continue;  // to save time
      how_.source = source;
      how_.threads = threads;
      const std::vector<std::byte> whole = baked("whole.pvs");
      callbacks events;
      bool cancelled = false;
      events.on_progress = [&cancelled](const progress& now) {
        EXPECT_FALSE(cancelled) << "no word after the bake was cancelled";
        cancelled = now.cells_done >= 2;
        return !cancelled;
      };
      EXPECT_TRUE(baked("broken.pvs", events, outcome::cancelled).empty());

      const auto caller = std::this_thread::get_id();
      std::vector<progress> told;
      events.on_progress = [&](const progress& now) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        if (now.phase != bake_phase::estimating || now.cells_done > 0) told.push_back(now);  // not of trial cells
        return true;
      };
      EXPECT_EQ(baked("broken.pvs", events), whole) << source << ", " << threads;
      EXPECT_GE(resumed_, 2u);
      most_resumed = std::max(most_resumed, resumed_);
      if (threads == 1) {
        EXPECT_EQ(resumed_, 2u);
      }
      ASSERT_GE(told.size(), 2u);
      EXPECT_EQ(told.front().cells_done, resumed_);
      EXPECT_EQ(told.front().cells_per_second, 0.0) << "what was resumed cost nothing and tells nothing";
      for (std::size_t i = 0; i < told.size(); ++i) {
        EXPECT_EQ(told[i].cells_total, cells);
        EXPECT_LE(told[i].cells_checked, told[i].cells_done);
        if (i == 0) continue;
        EXPECT_GE(told[i].cells_done, told[i - 1].cells_done);
        EXPECT_GE(told[i].cells_checked, told[i - 1].cells_checked);
        // Of what is left some may be in work, at most a cell per thread.
        if (told[i].cells_done == told[0].cells_done) continue;  // no rate before a cell is done
        EXPECT_GT(told[i].cells_per_second, 0.0) << i;
        const double left = told[i].seconds_left * told[i].cells_per_second;
        EXPECT_LE(left, cells - static_cast<double>(told[i].cells_checked) + 1e-6);
        EXPECT_LE(told[i].cells_per_second * told[i].seconds, cells - 0.0 + 0.25 * threads + 1e-6);
      }
      EXPECT_EQ(told.back().cells_done, cells);
      EXPECT_EQ(told.back().cells_checked, cells);
      EXPECT_EQ(told.back().seconds_left, 0.0);
      // Nothing is left beside the two files.
      EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2);
      std::filesystem::remove(folder_ / "broken.pvs");
    }
  EXPECT_GT(most_resumed, 2u) << "with threads, cells that were in work are kept too";
}

TEST_F(several_cells, what_a_callback_throws_ends_the_bake_and_finished_cells_are_kept) {
  how_.source = "cpu";
  for (const std::uint32_t threads : {1u, 4u}) {
    how_.threads = threads;
    const std::vector<std::byte> whole = baked("whole.pvs");
    callbacks events;
    bool thrown = false;
    events.on_progress = [&thrown](const progress& now) -> bool {
      EXPECT_FALSE(thrown) << "no word after that";
      thrown = now.cells_done >= 2;
      if (thrown) throw std::runtime_error("enough");
      return true;
    };
    EXPECT_THROW((void)bake(scene_, how_, folder_ / "broken.pvs", false, events), std::runtime_error);
    EXPECT_EQ(baked("broken.pvs"), whole);
    EXPECT_GE(resumed_, 2u);
    std::filesystem::remove(folder_ / "broken.pvs");
  }
}

TEST_F(several_cells, another_source_is_another_bake) {
  callbacks stop;
  stop.on_progress = [](const progress& now) { return now.cells_done < 2; };
  const std::vector<std::string> names = sources();
  for (std::size_t i = 0; i < names.size(); ++i) {
    how_.source = names[i];
    (void)baked("stopped.pvs", stop, outcome::cancelled);
    for (const std::string& other : names) {
      if (other == names[i]) continue;
      how_.source = other;
      try {
        (void)bake(scene_, how_, folder_ / "stopped.pvs", false, {});
        ADD_FAILURE() << other << " went on with what " << names[i] << " had begun";
      } catch (const error& e) {
        EXPECT_EQ(e.id(), "checkpoint.other-bake");
        EXPECT_NE(std::string(e.what()).find("device, source"), std::string::npos) << e.what();
      }
    }
    how_.source = names[i];
    (void)baked("stopped.pvs");
    EXPECT_GE(resumed_, 2u);
  }
}

TEST_F(several_cells, auto_is_gpu_on_hardware_only_and_says_so) {
  how_.source = "auto";
  how_.cell_limit = 1;
  std::string device;
  callbacks events;
  events.on_message = [&](severity, const std::string& text) {
    if (text.find("device: ") == 0) device = text;
  };
  const summary sum = bake(scene_, how_, folder_ / "room.pvs", false, events);
  const auto hardware = picture::gl_context::on_hardware();
  EXPECT_EQ(sum.source, hardware ? "gpu" : "cpu");
  EXPECT_FALSE(hardware && hardware->software());
  EXPECT_EQ(device, "device: " + sum.device + ", source " + sum.source + " (" + (hardware ? "a" : "no") +
                        " hardware GPU was found)");
  // The same bytes as by its name.
  const std::vector<std::byte> bytes = test::file_bytes(folder_ / "room.pvs");
  how_.source = sum.source;
  EXPECT_EQ(baked("room.pvs"), bytes);
}

// A room with a curtain across it: what is behind the curtain is seen by nobody, unless the curtain is never there.
class curtain_room : public bake_library {
 protected:
  void SetUp() override {
    bake_library::SetUp();
    test::tiny_scene tiny;
    tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
    curtain_ = tiny.wall_x(2, -1, 9.5f);
    behind_ = tiny.wall_x(5, -1, 1);
    turned_ = tiny.wall_x(-5, -1, 1);  // shows its back to the cells
    scene_ = tiny.finished();
    scene_.node_names = {"room", "curtain", "behind", "turned"};
    how_.resolution = 64;
    how_.samples = 12;
    how_.cells_file = folder_ / "cells.json";
  }
  void write_cells(const std::string& top, const std::string& second_cell = "") const {
    std::ofstream(*how_.cells_file) << "{" << top << R"("cells":[{"min":[-1,-1,-1],"max":[0,0,0])"
                                    << R"(},{"min":[0,0,0],"max":[1,1,1])" << second_cell << "}]}";
  }
  std::vector<std::byte> baked() {
    EXPECT_EQ(bake(scene_, how_, folder_ / "room.pvs", true, {}).result, outcome::done);
    return test::file_bytes(folder_ / "room.pvs");
  }
  static bool in_set(const std::vector<std::byte>& bytes, std::uint32_t cell, std::uint32_t polygon) {
    return test::stored_file(bytes).has(cell, polygon);
  }

  scene::scene scene_;
  settings how_;
  std::uint32_t curtain_ = 0, behind_ = 0, turned_ = 0;
};

TEST_F(curtain_room, hides_and_turns_its_back_without_overrides) {
  write_cells("");
  const auto bytes = baked();
  for (const std::uint32_t cell : {0u, 1u}) {
    EXPECT_TRUE(in_set(bytes, cell, curtain_));
    EXPECT_FALSE(in_set(bytes, cell, behind_));
    EXPECT_FALSE(in_set(bytes, cell, turned_));
  }
}

TEST_F(curtain_room, never_is_in_no_set_hides_nothing_and_verify_knows) {
  write_cells(R"("never":{"nodes":["curtain"]},)");
  const auto bytes = baked();
  for (const std::uint32_t cell : {0u, 1u}) {
    EXPECT_FALSE(in_set(bytes, cell, curtain_));
    EXPECT_TRUE(in_set(bytes, cell, behind_));
  }
  const verification v = verify(scene_, bytes, "room.pvs", {.rays = 20'000}, {});
  EXPECT_EQ(v.misses, 0u) << "verify takes the curtain as absent";
}

TEST_F(curtain_room, always_is_in_every_set) {
  write_cells(R"("always":{"nodes":["turned"]},)");
  const auto bytes = baked();
  for (const std::uint32_t cell : {0u, 1u})
    EXPECT_TRUE(in_set(bytes, cell, turned_) && in_set(bytes, cell, turned_ + 1));
}

TEST_F(curtain_room, a_cell_adds_to_its_own_set) {
  write_cells("", R"(,"add":{"polygons":[)" + std::to_string(behind_ + 1) + "]}");
  auto bytes = baked();
  EXPECT_FALSE(in_set(bytes, 0, behind_ + 1));
  EXPECT_TRUE(in_set(bytes, 1, behind_ + 1));
  EXPECT_FALSE(in_set(bytes, 1, behind_));
  how_.cell_limit = 1;  // the second of two
  bytes = baked();
  EXPECT_TRUE(in_set(bytes, 0, behind_ + 1));
}

TEST_F(curtain_room, other_overrides_are_another_bake) {
  write_cells("");
  callbacks stop;
  stop.on_progress = [](const progress& now) { return now.cells_done < 1; };
  const auto path = folder_ / "stopped.pvs";
  EXPECT_EQ(bake(scene_, how_, path, false, stop).result, outcome::cancelled);
  for (const char* top : {R"("always":{"polygons":[1]},)", R"("never":{"polygons":[1]},)"}) {
    write_cells(top);
    EXPECT_EQ(test::error_id([&] { (void)bake(scene_, how_, path, false, {}); }), "checkpoint.other-bake") << top;
  }
  write_cells("", R"(,"add":{"polygons":[1]})");
  EXPECT_EQ(test::error_id([&] { (void)bake(scene_, how_, path, false, {}); }), "checkpoint.other-bake");
  write_cells("");
  EXPECT_EQ(bake(scene_, how_, path, false, {}).result, outcome::done);
}

TEST_F(bake_library, cells_share_nothing_where_the_sampler_is_alone) {
  tiny_scene tiny;
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j) {
      const glm::vec3 at{0.9f * static_cast<float>(i), -1.0f, 0.9f * static_cast<float>(j)};
      tiny.closed_box(at - glm::vec3{0.1f, 0.5f, 0.1f}, at + glm::vec3{0.1f, 0.5f, 0.1f}, false);
    }
  const scene::scene s = tiny.finished();
  const auto seen = [&](const settings& how) {
    const auto path = folder_ / "room.pvs";
    (void)bake(s, how, path, true, {});
    test::stored_file file(test::file_bytes(path));
    std::size_t polygons = 0;
    for (std::uint32_t cell = 0; cell < file.reader().cell_count(); ++cell) polygons += file.set(cell).size();
    return polygons;
  };
  settings how = four_cells();
  how.cells_grid = {};
  how.samples = 6;
  how.resolution = 16;
  how.max_pixel_error = 0.0;
  std::size_t alone = 0;
  std::vector<cell_box> all;
  for (const float x : {-2.0f, 0.0f})
    for (const float z : {-2.0f, 0.0f}) {
      all.push_back({"", {x, 0.0f, z}, {x + 2.0f, 1.0f, z + 2.0f}});
      how.cells = {all.back()};
      alone += seen(how);
    }
  how.cells = all;
  EXPECT_EQ(seen(how), alone);
}

TEST_F(bake_library, another_seed_is_another_bake) {
  std::uint32_t back = 0;
  const scene::scene s = room(back);
  settings how = four_cells();
  callbacks events;
  events.on_progress = [](const progress& now) { return now.cells_done < 2; };
  (void)bake(s, how, folder_ / "a.pvs", false, events);
  how.seed = 2;
  try {
    (void)bake(s, how, folder_ / "a.pvs", false, {});
    FAIL() << "the checkpoint of another seed was taken";
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "checkpoint.other-bake");
  }
}

}  // namespace
}  // namespace sightcell::bake
