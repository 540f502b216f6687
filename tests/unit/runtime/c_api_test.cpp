// Opening, facts, arguments and statuses. The results of views: view_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "loaded_file.h"
#include "paged_host.h"
#include "sightcell/format/layout.h"
#include "sightcell/viewpoints.h"
#include "unit/format/viewpoint_samples.h"

namespace {

using namespace sightcell::test;
namespace layout = sightcell::format::layout;

sightcell_status open(const std::vector<std::byte>& bytes, const sightcell_allocator* mem = nullptr) {
  sightcell_db* db = reinterpret_cast<sightcell_db*>(8);
  const sightcell_status s = sightcell_db_open(bytes.data(), bytes.size(), mem, &db);
  EXPECT_EQ(db != nullptr, s == SIGHTCELL_OK);
  sightcell_db_close(db);
  return s;
}

TEST(c_api, version_and_texts) {
  EXPECT_EQ(sightcell_version(), 1u);
  for (int s = 0; s < 30; ++s) ASSERT_NE(sightcell_status_text(static_cast<sightcell_status>(s)), nullptr);
  EXPECT_STRNE(sightcell_status_text(SIGHTCELL_OK), sightcell_status_text(SIGHTCELL_ERR_STALE));
}

TEST(c_api, facts) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  EXPECT_EQ(sightcell_db_polygon_count(file.db()), 300u);
  EXPECT_EQ(sightcell_db_cell_count(file.db()), 67u);
  sightcell_info info{};
  info.struct_size = sizeof(info);
  ASSERT_EQ(sightcell_db_info(file.db(), &info), SIGHTCELL_OK);
  EXPECT_EQ(info.struct_size, 60u);
  EXPECT_EQ(info.format_version, 1u);
  EXPECT_EQ(info.layout, 0u);
  EXPECT_EQ(info.polygon_count, 300u);
  EXPECT_EQ(info.cell_count, 67u);
  EXPECT_EQ(info.draw_count, 3u);
  EXPECT_EQ(info.margin, 0.25f);
  EXPECT_EQ(info.max_pixel_error, 0.5f);
  EXPECT_EQ(info.confidence, 0.95f);
  EXPECT_EQ(info.player_radius, 0.0f);
  EXPECT_EQ(std::memcmp(info.scene_fingerprint, contents.facts.scene_fingerprint.data(), 16), 0);
  for (std::uint32_t cell = 0; cell < 67; ++cell) {
    float min[3];
    float max[3];
    ASSERT_EQ(sightcell_db_cell_box(file.db(), cell, min, max), SIGHTCELL_OK);
    EXPECT_EQ(std::memcmp(min, contents.cells[cell].min.data(), sizeof(min)), 0);
    EXPECT_EQ(std::memcmp(max, contents.cells[cell].max.data(), sizeof(max)), 0);
  }
  EXPECT_EQ(sightcell_db_check(file.db()), SIGHTCELL_OK);
}

TEST(c_api, draws_and_order) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  std::size_t count = 0;
  EXPECT_EQ(sightcell_db_draws(file.db(), nullptr, 0, &count), SIGHTCELL_ERR_CAPACITY);
  ASSERT_EQ(count, 3u);
  std::vector<sightcell_draw> draws(3);
  ASSERT_EQ(sightcell_db_draws(file.db(), draws.data(), 3, &count), SIGHTCELL_OK);
  EXPECT_EQ(draws[2].node, 6u);
  EXPECT_EQ(draws[2].mesh, 4u);
  EXPECT_EQ(draws[2].instance, 9u);
  EXPECT_EQ(draws[1].material, 0xFFFFFFFFu);
  EXPECT_EQ(draws[0].primitive, 2u);
  EXPECT_EQ(draws[2].first_source, 120u);
  EXPECT_EQ(draws[2].polygon_count, 180u);
  EXPECT_EQ(draws[2].first_stored, 120u);
  EXPECT_EQ(draws[2].base_vertex, 300u);
  EXPECT_EQ(draws[0].host_tag, 77u);
  std::vector<std::uint32_t> order(300);
  EXPECT_EQ(sightcell_db_order(file.db(), order.data(), 299, &count), SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(count, 300u);
  ASSERT_EQ(sightcell_db_order(file.db(), order.data(), 300, &count), SIGHTCELL_OK);
  EXPECT_EQ(order, all_polygons(300));
}

// A host finds from any draw of a group where the group is stored.
TEST(c_api, draws_of_a_merged_file) {
  sample_contents contents = random_contents(2, {.polygons = 500, .draws = 20, .cells = 3});
  put_in_groups(contents, 1);
  const loaded_file file(contents);
  sightcell_info info{};
  info.struct_size = sizeof(info);
  ASSERT_EQ(sightcell_db_info(file.db(), &info), SIGHTCELL_OK);
  EXPECT_EQ(info.layout, 1u);
  ASSERT_EQ(info.draw_count, 20u);
  std::vector<sightcell_draw> draws(20);
  std::size_t count = 0;
  ASSERT_EQ(sightcell_db_draws(file.db(), draws.data(), draws.size(), &count), SIGHTCELL_OK);
  std::uint32_t begin = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    if (i > 0 && draws[i].group != draws[i - 1].group) begin = contents.draws[i].first_stored;
    EXPECT_EQ(draws[i].group, contents.draws[i].group);
    EXPECT_EQ(draws[i].first_stored, begin);
    EXPECT_EQ(draws[i].polygon_count, contents.draws[i].polygon_count);
  }
}

TEST(c_api, info_of_callers_with_other_headers) {
  const loaded_file file(tiny_contents());
  struct later_info {
    sightcell_info known;
    std::uint32_t more;
  } later{};
  later.known.struct_size = sizeof(later);
  later.more = 42;
  EXPECT_EQ(sightcell_db_info(file.db(), &later.known), SIGHTCELL_OK);
  EXPECT_EQ(later.known.struct_size, sizeof(sightcell_info));
  EXPECT_EQ(later.more, 42u);
  sightcell_info info{};
  EXPECT_EQ(sightcell_db_info(file.db(), &info), SIGHTCELL_ERR_ARGUMENT);
  info.struct_size = 55;
  EXPECT_EQ(sightcell_db_info(file.db(), &info), SIGHTCELL_ERR_ARGUMENT);
}

// The struct ended with the fingerprint before player_radius was added.
TEST(c_api, info_of_callers_from_before_player_radius) {
  sample_contents contents = tiny_contents();
  add_viewpoints(contents, 1);
  const loaded_file file(contents);
  for (const std::uint32_t size : {56u, 57u, 59u}) {
    sightcell_info info{};
    info.struct_size = size;
    info.player_radius = 42.0f;  // what is behind the struct of the caller
    EXPECT_EQ(sightcell_db_info(file.db(), &info), SIGHTCELL_OK);
    EXPECT_EQ(info.struct_size, 56u);
    EXPECT_EQ(info.polygon_count, 6u);
    EXPECT_EQ(info.scene_fingerprint[15], 0xAF);
    EXPECT_EQ(info.player_radius, 42.0f);
  }
  EXPECT_EQ(file.info().player_radius, 0.05f);
}

void expect_viewpoints(const sightcell_db* db, const sample_contents& contents) {
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    float valid = 0.0f;
    float outside = 0.0f;
    ASSERT_EQ(sightcell_db_cell_viewpoints(db, cell, &valid, &outside), SIGHTCELL_OK);
    const bool there = !contents.viewpoints.empty();
    EXPECT_EQ(valid, there ? contents.viewpoints[cell].valid_share : 1.0f) << cell;
    EXPECT_EQ(static_cast<double>(outside), there ? contents.viewpoints[cell].outside_share : 0.0) << cell;
  }
}

TEST(c_api, error_bounds_of_cells) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  std::vector<float> bounds(contents.cells.size(), -1.0f);
  std::size_t count = 0;
  ASSERT_EQ(sightcell_db_error_bounds(file.db(), bounds.data(), bounds.size(), &count), SIGHTCELL_OK);
  ASSERT_EQ(count, contents.cells.size());
  for (std::size_t cell = 0; cell < count; ++cell) EXPECT_EQ(bounds[cell], contents.certificate[cell].upper_bound);
  EXPECT_EQ(*std::max_element(bounds.begin(), bounds.end()), file.info().max_pixel_error);
  sample_contents unmeasured = contents;
  unmeasured.certificate[3] = {.cell = 3, .upper_bound = 1.0};
  const loaded_file other(unmeasured);
  ASSERT_EQ(sightcell_db_error_bounds(other.db(), bounds.data(), bounds.size(), &count), SIGHTCELL_OK);
  EXPECT_EQ(bounds[3], 1.0f);
  EXPECT_LT(bounds[2], 1.0f);
}

TEST(c_api, viewpoints_of_cells) {
  sample_contents contents = small_contents();
  expect_viewpoints(loaded_file(contents).db(), contents);
  add_viewpoints(contents, 3);
  const loaded_file file(contents);
  expect_viewpoints(file.db(), contents);
  float valid = 7.0f;
  float outside = 7.0f;
  EXPECT_EQ(sightcell_db_cell_viewpoints(nullptr, 0, &valid, &outside), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_cell_viewpoints(file.db(), 0, nullptr, &outside), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_cell_viewpoints(file.db(), 0, &valid, nullptr), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_cell_viewpoints(file.db(), 67, &valid, &outside), SIGHTCELL_ERR_ARGUMENT);
  const loaded_file without(small_contents());
  EXPECT_EQ(sightcell_db_cell_viewpoints(without.db(), 67, &valid, &outside), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(valid, 7.0f);
  EXPECT_EQ(outside, 7.0f);
  paged_host paged(contents.encode());
  ASSERT_EQ(paged.open(1u << 20), SIGHTCELL_OK);
  expect_viewpoints(paged.db(), contents);
  EXPECT_EQ(paged.requests, 0u) << "no set is needed";
}

TEST(c_api, nulls_are_arguments) {
  const loaded_file file(tiny_contents());
  const test_view view(file.db());
  const auto bytes = tiny_contents().encode();
  sightcell_db* db = nullptr;
  sightcell_view* made = nullptr;
  sightcell_info info{};
  sightcell_frame frame;
  std::size_t count = 7;
  std::uint32_t number = 0;
  float place[3] = {0, 0, 0};
  const auto argument = SIGHTCELL_ERR_ARGUMENT;
  EXPECT_EQ(sightcell_db_open(bytes.data(), bytes.size(), nullptr, nullptr), argument);
  EXPECT_EQ(sightcell_db_open(nullptr, 5, nullptr, &db), argument);
  const sightcell_allocator broken{nullptr, nullptr, nullptr};
  EXPECT_EQ(sightcell_db_open(bytes.data(), bytes.size(), &broken, &db), argument);
  EXPECT_EQ(sightcell_db_open_file(nullptr, nullptr, &db), argument);
  EXPECT_EQ(sightcell_db_open_file("x", nullptr, nullptr), argument);
  EXPECT_EQ(sightcell_db_polygon_count(nullptr), 0u);
  EXPECT_EQ(sightcell_db_cell_count(nullptr), 0u);
  EXPECT_EQ(sightcell_db_cell_box(nullptr, 0, place, place), argument);
  EXPECT_EQ(sightcell_db_cell_box(file.db(), 0, nullptr, place), argument);
  EXPECT_EQ(sightcell_db_cell_box(file.db(), 0, place, nullptr), argument);
  EXPECT_EQ(sightcell_db_cell_box(file.db(), 2, place, place), argument);
  EXPECT_EQ(sightcell_db_info(nullptr, &info), argument);
  EXPECT_EQ(sightcell_db_info(file.db(), nullptr), argument);
  EXPECT_EQ(sightcell_db_check(nullptr), argument);
  EXPECT_EQ(sightcell_db_draws(nullptr, nullptr, 0, &count), argument);
  EXPECT_EQ(sightcell_db_draws(file.db(), nullptr, 1, &count), argument);
  EXPECT_EQ(sightcell_db_draws(file.db(), nullptr, 0, nullptr), argument);
  EXPECT_EQ(sightcell_db_order(nullptr, nullptr, 0, &count), argument);
  EXPECT_EQ(sightcell_view_create(nullptr, &made), argument);
  EXPECT_EQ(sightcell_view_create(file.db(), nullptr), argument);
  EXPECT_EQ(sightcell_view_move(nullptr, place, &frame), argument);
  EXPECT_EQ(sightcell_view_polygons(nullptr, nullptr, 0, &count), argument);
  EXPECT_EQ(sightcell_view_polygons(view.get(), nullptr, 1, &count), argument);
  EXPECT_EQ(sightcell_view_polygons(view.get(), &number, 1, nullptr), argument);
  EXPECT_EQ(sightcell_view_ranges(nullptr, nullptr, 0, &count), argument);
  EXPECT_EQ(sightcell_view_indices(nullptr, nullptr, nullptr, 0, &count), argument);
  EXPECT_EQ(sightcell_view_commands(nullptr, 0, nullptr, sizeof(sightcell_command), 0, &count), argument);
  EXPECT_EQ(sightcell_view_changes(nullptr, 0, nullptr, 0, &count, nullptr, 0, &count), argument);
  EXPECT_EQ(sightcell_view_changes(view.get(), 0, nullptr, 0, nullptr, nullptr, 0, &count), argument);
  EXPECT_EQ(sightcell_view_changes(view.get(), 0, nullptr, 1, &count, nullptr, 0, &count), argument);
  EXPECT_EQ(count, 7u) << "outputs are unchanged";
  sightcell_db_close(nullptr);
  sightcell_view_destroy(nullptr);
}

TEST(c_api, every_status_of_open) {
  auto bytes = small_contents().encode();
  EXPECT_EQ(open(bytes), SIGHTCELL_OK);
  EXPECT_EQ(open({}), SIGHTCELL_ERR_TRUNCATED);
  EXPECT_EQ(open(std::vector<std::byte>(200)), SIGHTCELL_ERR_NOT_OURS);
  auto changed = bytes;
  set_u32(changed, layout::header_version, 7);
  EXPECT_EQ(open(changed), SIGHTCELL_ERR_VERSION);
  changed = bytes;
  changed.pop_back();
  EXPECT_EQ(open(changed), SIGHTCELL_ERR_TRUNCATED);
  changed = bytes;
  changed[section_offset(bytes, layout::section_cells)] ^= std::byte{1};
  EXPECT_EQ(open(changed), SIGHTCELL_ERR_CHECKSUM);
  changed = bytes;
  changed.push_back(std::byte{});
  EXPECT_EQ(open(changed), SIGHTCELL_ERR_CORRUPT);
  changed = bytes;
  set_u32(changed, layout::header_draw_count, layout::max_draws + 1);
  reseal(changed);
  EXPECT_EQ(open(changed), SIGHTCELL_ERR_LIMIT);
}

TEST(c_api, check_finds_what_open_leaves_out) {
  auto bytes = small_contents().encode();
  bytes.back() ^= std::byte{1};
  const loaded_file file(std::move(bytes));
  EXPECT_EQ(sightcell_db_check(file.db()), SIGHTCELL_ERR_CHECKSUM);
}

struct failing_allocator {
  int left = 0;  // number of blocks that it still returns
  int given = 0;
  sightcell_allocator interface {
    [](void* user, std::size_t size, std::size_t) -> void* {
      auto* self = static_cast<failing_allocator*>(user);
      if (self->left-- <= 0) return nullptr;
      ++self->given;
      return std::malloc(size);
    },
        [](void* user, void* block, std::size_t) {
          --static_cast<failing_allocator*>(user)->given;
          std::free(block);
        },
        this
  };
};

TEST(c_api, out_of_memory_is_a_status_and_leaks_nothing) {
  const auto bytes = small_contents().encode();
  failing_allocator memory;
  EXPECT_EQ(open(bytes, &memory.interface), SIGHTCELL_ERR_MEMORY);
  memory.left = 1;
  const loaded_file file(bytes, &memory.interface);
  sightcell_view* view = nullptr;
  EXPECT_EQ(sightcell_view_create(file.db(), &view), SIGHTCELL_ERR_MEMORY);
  EXPECT_EQ(view, nullptr);
  EXPECT_EQ(sightcell_db_check(file.db()), SIGHTCELL_ERR_MEMORY);
  EXPECT_EQ(memory.given, 1);
}

class c_api_file : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("sightcell_c_api_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // The encoding that the C API takes, independent of the system.
  static std::string utf8(const std::filesystem::path& path) {
    const std::u8string name = path.u8string();
    return {name.begin(), name.end()};
  }
  [[nodiscard]] std::string write(const std::vector<std::byte>& bytes) const {
    const std::string name = utf8(folder_ / "a.pvs");
    EXPECT_EQ(sightcell::format::write_file(name.c_str(), bytes), sightcell::format::status::ok);
    return name;
  }

  std::filesystem::path folder_;
};

TEST_F(c_api_file, opens_from_disk) {
  const std::string name = write(small_contents().encode());
  failing_allocator memory;
  memory.left = 2;
  sightcell_db* db = nullptr;
  ASSERT_EQ(sightcell_db_open_file(name.c_str(), &memory.interface, &db), SIGHTCELL_OK);
  EXPECT_EQ(memory.given, 2);
  EXPECT_EQ(sightcell_db_cell_count(db), 67u);
  sightcell_db_close(db);
  EXPECT_EQ(memory.given, 0);
  for (const int blocks : {0, 1}) {
    memory.left = blocks;
    EXPECT_EQ(sightcell_db_open_file(name.c_str(), &memory.interface, &db), SIGHTCELL_ERR_MEMORY);
    EXPECT_EQ(memory.given, 0);
  }
}

// The standard library passes the name to the system (wide on Windows); the C API takes it as UTF-8.
TEST_F(c_api_file, names_are_utf8) {
  const auto bytes = small_contents().encode();
  const std::filesystem::path path = folder_ / std::u8string(u8"\u00E9\u20AC\u4E2D\U0001F3D9.pvs");
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  sightcell_db* db = nullptr;
  EXPECT_EQ(sightcell_db_open_file(utf8(path).c_str(), nullptr, &db), SIGHTCELL_OK);
  sightcell_db_close(db);
  EXPECT_EQ(sightcell_db_open_file((utf8(folder_) + "/\xFF\xFE.pvs").c_str(), nullptr, &db), SIGHTCELL_ERR_IO);
}

TEST_F(c_api_file, long_names) {
#if defined(_WIN32)
  // Windows accepts more than 260 characters only in this form.
  std::filesystem::path path = L"\\\\?\\" + std::filesystem::absolute(folder_).make_preferred().wstring();
#else
  std::filesystem::path path = folder_;
#endif
  std::vector<std::filesystem::path> made;
  while (utf8(path).size() < 1500) {
    path /= std::string(100, 'x');
    std::filesystem::create_directory(path);
    made.push_back(path);
  }
  const std::string name = utf8(path / "a.pvs");
  const auto bytes = small_contents().encode();
  ASSERT_EQ(sightcell::format::write_file(name.c_str(), bytes), sightcell::format::status::ok);
  failing_allocator memory;
  memory.left = 3;
  sightcell_db* db = nullptr;
  EXPECT_EQ(sightcell_db_open_file(name.c_str(), &memory.interface, &db), SIGHTCELL_OK);
  EXPECT_EQ(memory.given, 2);
  sightcell_db_close(db);
  EXPECT_EQ(memory.given, 0);
  EXPECT_TRUE(std::filesystem::remove(path / "a.pvs"));
  // One by one: not every library can list such a folder.
  for (; !made.empty(); made.pop_back()) EXPECT_TRUE(std::filesystem::remove(made.back()));
}

// Sizes above 4 GB survive the C library's file functions: the allocator is asked for the whole size, and returns NULL.
TEST_F(c_api_file, size_of_a_file_above_4_gb) {
  const std::string name = write(small_contents().encode());
  constexpr std::uint64_t size = 5'000'000'000u;
  std::error_code error;
  std::filesystem::resize_file(folder_ / "a.pvs", size, error);
  if (error) GTEST_SKIP() << "no room for a file with holes: " << error.message();
  static std::uint64_t asked = 0;
  const sightcell_allocator none{[](void*, std::size_t bytes, std::size_t) -> void* {
                                   asked = bytes;
                                   return nullptr;
                                 },
                                 [](void*, void*, std::size_t) {}, nullptr};
  sightcell_db* db = nullptr;
  if (sizeof(std::size_t) < 8) {
    EXPECT_EQ(sightcell_db_open_file(name.c_str(), &none, &db), SIGHTCELL_ERR_LIMIT);
  } else {
    EXPECT_EQ(sightcell_db_open_file(name.c_str(), &none, &db), SIGHTCELL_ERR_MEMORY);
    EXPECT_EQ(asked, size);
  }
}

TEST_F(c_api_file, files_that_are_none) {
  sightcell_db* db = nullptr;
#if defined(_WIN32)
  EXPECT_EQ(sightcell_db_open_file("NUL", nullptr, &db), SIGHTCELL_ERR_TRUNCATED);
#else
  EXPECT_EQ(sightcell_db_open_file("/dev/null", nullptr, &db), SIGHTCELL_ERR_TRUNCATED);
  EXPECT_EQ(sightcell_db_open_file("/dev/zero", nullptr, &db), SIGHTCELL_ERR_IO);
#endif
  EXPECT_EQ(sightcell_db_open_file(utf8(folder_ / "missing").c_str(), nullptr, &db), SIGHTCELL_ERR_IO);
  EXPECT_EQ(sightcell_db_open_file(utf8(folder_).c_str(), nullptr, &db), SIGHTCELL_ERR_IO);
  EXPECT_EQ(sightcell_db_open_file("", nullptr, &db), SIGHTCELL_ERR_IO);
  EXPECT_EQ(sightcell_db_open_file(write({}).c_str(), nullptr, &db), SIGHTCELL_ERR_TRUNCATED);
  EXPECT_EQ(sightcell_db_open_file(write(std::vector<std::byte>(5, std::byte{7})).c_str(), nullptr, &db),
            SIGHTCELL_ERR_NOT_OURS);
  EXPECT_EQ(db, nullptr);
}

}  // namespace
