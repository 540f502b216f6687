// A .pvs file inside of a .glb.
#include "embedded_pvs.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "held_memory.h"
#include "loaded_file.h"
#include "sightcell/format/writer.h"

namespace {

using namespace sightcell::test;
using bytes = std::vector<std::byte>;

void append(bytes& out, std::string_view text) {
  for (const char c : text) out.push_back(static_cast<std::byte>(c));
}

void append_u32(bytes& out, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::byte>(value >> shift & 0xFFu));
}

// before: bytes of the BIN chunk in front of the file.
bytes glb_of(std::string json, const bytes& pvs, std::size_t before = 0) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::size_t binary = (before + pvs.size() + 3) / 4 * 4;
  bytes out;
  append(out, "glTF");
  append_u32(out, 2);
  append_u32(out, 12 + 8 + json.size() + 8 + binary);
  append_u32(out, json.size());
  append(out, "JSON" + json);
  append_u32(out, binary);
  append(out, std::string_view("BIN\0", 4));
  out.resize(out.size() + before);
  out.insert(out.end(), pvs.begin(), pvs.end());
  out.resize(out.size() + binary - before - pvs.size());
  return out;
}

std::string json_with(const std::string& view, const std::string& number = "1") {
  return R"({"asset":{"extras":{"a":["\"]",{}]}},"bufferViews":[{"buffer":0,"byteLength":4},)" + view +
         R"(],"extras":{"x":{"pvs":[]},"sightcell" : {"other":-1.5e3,"pvs":{"bufferView":)" + number + "}}}}";
}

std::string view_of(std::size_t length, std::size_t offset = 4) {
  return R"({"name":"}","byteOffset":)" + std::to_string(offset) + R"(,"byteLength":)" + std::to_string(length) +
         R"(,"buffer":0})";
}

sightcell_status status_of(const bytes& file) {
  sightcell_db* db = nullptr;
  const sightcell_status s = sightcell_db_open(file.data(), file.size(), nullptr, &db);
  sightcell_db_close(db);
  return s;
}

TEST(embedded_pvs, opens_from_memory_and_from_disk_and_is_the_file) {
  const bytes pvs = small_contents().encode(), glb = glb_of(json_with(view_of(pvs.size())), pvs, 4);
  const loaded_file plain(pvs), inside(glb);
  EXPECT_EQ(std::memcmp(inside.info().scene_fingerprint, plain.info().scene_fingerprint, 16), 0);
  test_view a(plain.db()), b(inside.db());
  a.move(1, 1, 1);
  b.move(1, 1, 1);
  EXPECT_EQ(a.polygons(), b.polygons());

  const std::string name = testing::TempDir() + "sightcell_embedded.glb";
  ASSERT_EQ(sightcell::format::write_file(name.c_str(), glb), sightcell::format::status::ok);
  held_memory held;
  sightcell_db* db = nullptr;
  ASSERT_EQ(sightcell_db_open_file(name.c_str(), &held.interface, &db), SIGHTCELL_OK);
  EXPECT_EQ(sightcell_db_check(db), SIGHTCELL_OK);
  sightcell_db_close(db);
  EXPECT_EQ(held.bytes.load(), 0u);
}

TEST(embedded_pvs, what_the_json_may_have) {
  const bytes pvs = tiny_contents().encode();
  const std::string good = json_with(view_of(pvs.size()));
  const auto with = [&](const std::string& json) { return status_of(glb_of(json, pvs, 4)); };
  EXPECT_EQ(with(good), SIGHTCELL_OK);
  EXPECT_EQ(with("\n\t " + good), SIGHTCELL_OK);
  for (const char* without :
       {"{}", "", "[]", "7", R"({"extras":3})", R"({"extras":{"sightcell":[]}})",
        R"({"extras":{"sightcell":{"pvs":{"uri":"a.pvs"}}}})", R"({"nodes":[{"extras":{}}]})", R"({"asset":"\)",
        R"({"asset":[[[[[[)", "{\"a\":1]", R"({"extras":{"sight\u0063ell":{}}})"})
    EXPECT_EQ(with(without), SIGHTCELL_ERR_ABSENT) << without;
  for (const std::string number : {"2", "-1", "1.5", "\"1\"", "99999999999999999999999", "null", ""})
    EXPECT_EQ(with(json_with(view_of(pvs.size()), number)), SIGHTCELL_ERR_CORRUPT) << number;
  const std::string size = std::to_string(pvs.size());
  for (const std::string& view :
       {std::string("{}"), std::string("7"), view_of(0), view_of(pvs.size(), 5000), view_of(std::size_t{1} << 33),
        view_of(pvs.size() + 4), R"({"byteOffset":4,"byteLength":)" + size + "}",
        R"({"buffer":1,"byteOffset":4,"byteLength":)" + size + "}",
        R"({"buffer":0,"byteOffset":-4,"byteLength":)" + size + "}"})
    EXPECT_EQ(with(json_with(view)), SIGHTCELL_ERR_CORRUPT) << view;
  EXPECT_EQ(with(json_with(view_of(pvs.size(), 0))), SIGHTCELL_ERR_NOT_OURS);
  EXPECT_EQ(with(json_with(view_of(pvs.size() - 8))), SIGHTCELL_ERR_TRUNCATED);
}

// Each byte of the container and its JSON, with each of a few values; each length. Nothing is read outside of the file:
// each is in a block of its own for the address sanitizer.
TEST(embedded_pvs, hostile_containers) {
  const bytes pvs = tiny_contents().encode(), glb = glb_of(json_with(view_of(pvs.size())), pvs, 4);
  const std::size_t head = glb.size() - pvs.size();
  for (std::size_t at = 0; at < head; ++at)
    for (const char value : {'\0', '\xFF', '"', '{', '}', '[', ',', '9'}) {
      bytes file = glb;
      file[at] = static_cast<std::byte>(value);
      (void)status_of(file);
    }
  for (std::size_t length = 0; length < glb.size(); ++length) {
    bytes file(glb.begin(), glb.begin() + static_cast<std::ptrdiff_t>(length));
    file.shrink_to_fit();
    EXPECT_NE(status_of(file), SIGHTCELL_OK) << length;
    if (length < 20) continue;
    bytes shorter_header = file;
    for (std::size_t i = 0; i < 4; ++i) shorter_header[8 + i] = static_cast<std::byte>(length >> (8 * i) & 0xFFu);
    EXPECT_NE(status_of(shorter_header), SIGHTCELL_OK) << length;
  }
}

}  // namespace
