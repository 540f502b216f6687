// A new bake replaces a file while the game runs: a loader opens it, creates views and passes them to the cameras.
// Cameras on their own threads use the old views until then, and return them. Only then the old file is closed. For the
// address and the thread sanitizer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "held_memory.h"
#include "loaded_file.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;

constexpr std::uint32_t bakes = 6;
constexpr std::size_t cameras = 2;
constexpr std::uint32_t cells = 192;
constexpr std::uint32_t polygons = 400;

// One bake of the scene, opened, with a view for each camera.
class opened_bake {
 public:
  opened_bake(std::uint32_t number_of_bake, bool paged, const std::string& name, const sightcell_allocator& mem)
      : number(number_of_bake),
        contents(random_contents(70 + number_of_bake, {.polygons = polygons, .draws = 9, .cells = cells})) {
    bytes_ = contents.encode();
    if (paged) {
      const sightcell_source source{this, bytes_.size(),
                                    [](void* user, std::uint64_t offset, std::uint32_t size, std::uint32_t ticket) {
                                      const auto& self = *static_cast<opened_bake*>(user);
                                      return sightcell_db_deliver(self.db_, ticket, self.bytes_.data() + offset, size);
                                    }};
      EXPECT_EQ(sightcell_db_open_source(&source, &mem, 12'000, &db_), SIGHTCELL_OK);
    } else {
      // Replaces the file that the game has open.
      EXPECT_EQ(sightcell::format::write_file(name.c_str(), bytes_), sightcell::format::status::ok);
      EXPECT_EQ(sightcell_db_open_file(name.c_str(), &mem, &db_), SIGHTCELL_OK);
    }
    for (sightcell_view*& view : views) EXPECT_EQ(sightcell_view_create(db_, &view), SIGHTCELL_OK);
  }
  ~opened_bake() {
    for (sightcell_view* view : views) sightcell_view_destroy(view);
    sightcell_db_close(db_);
  }
  opened_bake(const opened_bake&) = delete;
  opened_bake& operator=(const opened_bake&) = delete;

  const std::uint32_t number;
  const sample_contents contents;
  std::array<sightcell_view*, cameras> views{};

 private:
  std::vector<std::byte> bytes_;
  sightcell_db* db_ = nullptr;
};

// What a camera and the loader share.
struct camera_desk {
  std::atomic<const opened_bake*> next{nullptr};  // to be used from the next frame on
  std::atomic<std::uint32_t> taken{0};            // number of bakes; all before the last one are returned
  std::atomic<std::uint32_t> frames{0};
  std::atomic<std::uint32_t> wrong{0};
};

// Runs one frame in a given cell.
bool is_right(const opened_bake& bake, sightcell_view* view, std::uint32_t cell, bool first) {
  const auto& b = bake.contents.cells[cell];
  const float eye[3] = {b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f};
  sightcell_frame frame;
  std::array<std::uint32_t, polygons> ids;
  std::size_t count = 0;
  if (sightcell_view_move(view, eye, &frame) != SIGHTCELL_OK || frame.cell != cell) return false;
  if (first && ((frame.flags & SIGHTCELL_FRAME_CHANGED) == 0 || frame.revision != 1)) return false;
  if (sightcell_view_polygons(view, ids.data(), ids.size(), &count) != SIGHTCELL_OK) return false;
  if ((frame.flags & SIGHTCELL_FRAME_PENDING) != 0) return count == polygons;  // the other camera's chunks are in use
  const auto& set = bake.contents.sets[cell];
  return count == set.size() && std::equal(set.begin(), set.end(), ids.begin());
}

void fly(camera_desk& desk, std::size_t number) {
  random_source random(static_cast<std::uint32_t>(number));
  const opened_bake* bake = nullptr;
  while (desk.taken < bakes || desk.frames < 150 * bakes) {
    const opened_bake* newer = desk.next.exchange(nullptr);
    if (newer != nullptr) {
      bake = newer;
      desk.taken = bake->number + 1;
    }
    if (bake == nullptr) continue;
    if (!is_right(*bake, bake->views[number], random() % cells, newer != nullptr)) ++desk.wrong;
    ++desk.frames;
  }
}

void reload(bool paged, const std::string& name) {
  held_memory memory;
  std::array<camera_desk, cameras> desks;
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < cameras; ++i) threads.emplace_back([&desks, i] { fly(desks[i], i); });
  const auto wait_for_all = [&desks](const auto& condition) {
    for (const camera_desk& desk : desks) {
      while (!condition(desk)) std::this_thread::yield();
    }
  };
  std::unique_ptr<opened_bake> bake;
  for (std::uint32_t number = 0; number < bakes; ++number) {
    auto newer = std::make_unique<opened_bake>(number, paged, name, memory.interface);
    wait_for_all([number](const camera_desk& desk) { return desk.frames >= 100 * number; });  // of the old one
    for (camera_desk& desk : desks) desk.next = newer.get();
    wait_for_all([number](const camera_desk& desk) { return desk.taken == number + 1; });
    bake = std::move(newer);  // closes the old one
  }
  for (std::thread& t : threads) t.join();
  for (const camera_desk& desk : desks) EXPECT_EQ(desk.wrong, 0u);
  EXPECT_GT(memory.bytes, 0u);
  bake.reset();
  EXPECT_EQ(memory.bytes, 0u);
}

TEST(hot_reload, of_a_file_that_is_replaced) {
  const std::string name = testing::TempDir() + "sightcell_hot_reload.pvs";
  reload(false, name);
  std::remove(name.c_str());
}

TEST(hot_reload, of_paged_files) {
  reload(true, {});
}

}  // namespace
