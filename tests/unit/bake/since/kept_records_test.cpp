#include "since/kept_records.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "sightcell/base/error.h"
#include "unit/bake/fresh_folder.h"

namespace sightcell::bake {
namespace {

kept_records some_records() {
  kept_records records;
  records.key = "settings {}";
  records.polygons.names = {7, 8, 0};
  records.polygons.near = {1, 2, 3};
  records.polygons.corners.resize(3,
                                  triangle{glm::vec3{0.0f}, glm::vec3{1.0f, 0.0f, 0.0f}, glm::vec3{0.0f, 1.0f, 0.0f}});
  records.partner_reach = 0.01f;
  records.partners = {{0, 2}, {1, 2}};
  records.steps.push_back({5, {1, 2, 3, 4, 5, 6}, step_kind::check, 9, 10, true, {1, 2, 3}, {{4, 5}, {7}}, {6}});
  records.steps.push_back({4, {1, 2, 3, 4, 5, 6}, step_kind::sample, 9, 10, false, {1}, {}, {}});
  return records;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string id_of_reading(const std::filesystem::path& pvs) {
  try {
    (void)read_records(pvs);
    return "";
  } catch (const error& failure) {
    return failure.id();
  }
}

TEST(kept_records, come_back_sorted) {
  const test::fresh_folder folder;
  const std::filesystem::path pvs = folder / "a.pvs";
  kept_records records = some_records();
  write_records(records, pvs);
  const kept_records again = read_records(pvs);
  EXPECT_EQ(again.key, records.key);
  EXPECT_EQ(again.polygons.names, records.polygons.names);
  EXPECT_EQ(again.polygons.near, records.polygons.near);
  EXPECT_EQ(again.polygons.corners, records.polygons.corners);
  EXPECT_EQ(again.partner_reach, records.partner_reach);
  EXPECT_EQ(again.partners, records.partners);
  ASSERT_EQ(again.steps.size(), 2u);
  EXPECT_EQ(again.steps[0].place, 4u);
  EXPECT_EQ(again.steps[1].kind, step_kind::check);
  EXPECT_EQ(again.steps[1].own_inputs, 9u);
  EXPECT_EQ(again.steps[1].neighbor_inputs, 10u);
  EXPECT_TRUE(again.steps[1].started);
  EXPECT_FALSE(again.steps[0].started);
  EXPECT_EQ(again.steps[1].record, (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_EQ(again.steps[1].spaces, (std::vector<std::vector<std::uint8_t>>{{4, 5}, {7}}));
  EXPECT_EQ(again.steps[1].tested, std::vector<std::uint8_t>{6});
}

// Whatever the bytes, reading returns or throws. With a checksum that fits, the reader itself is tested.
TEST(kept_records, damaged_files) {
  const test::fresh_folder folder;
  const std::filesystem::path pvs = folder / "a.pvs";
  EXPECT_EQ(id_of_reading(pvs), "records.missing");
  kept_records records = some_records();
  write_records(records, pvs);
  const std::filesystem::path path = records_beside(pvs);
  const std::string whole = read_file(path);
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    put_file(path, whole.substr(0, size));
    EXPECT_EQ(id_of_reading(pvs), "records.damaged") << size;
  }
  for (std::size_t i = 0; i + 8 < whole.size(); ++i)
    for (const char value : {'\x00', '\x7F', '\xFF'}) {
      std::string damaged = whole;
      damaged[i] = value;
      const std::uint64_t checksum = XXH3_64bits(damaged.data(), damaged.size() - 8);
      std::memcpy(damaged.data() + damaged.size() - 8, &checksum, 8);
      put_file(path, damaged);
      const std::string id = id_of_reading(pvs);
      EXPECT_TRUE(id.empty() || id == "records.damaged") << i << ' ' << id;
    }
}

}  // namespace
}  // namespace sightcell::bake
