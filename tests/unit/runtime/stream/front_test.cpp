// Fronts and chunks: what a host reads from them, and what is rejected.
#include <gtest/gtest.h>

#include <algorithm>

#include "small_stream.h"
#include "unit/runtime/held_memory.h"

namespace {

using namespace sightcell::test;

sightcell_status open_bytes(const bytes& front) {
  sightcell_stream* stream = nullptr;
  const sightcell_status status = sightcell_stream_open(front.data(), front.size(), 1 << 20, nullptr, &stream);
  EXPECT_EQ(stream != nullptr, status == SIGHTCELL_OK);
  sightcell_stream_close(stream);
  return status;
}

// Opens a scene whose first chunk has other bytes, of the right hash.
sightcell_status deliver_chunk(const small_stream& content, const bytes& chunk) {
  const bytes front = content.front({chunk});
  sightcell_stream* stream = nullptr;
  EXPECT_EQ(sightcell_stream_open(front.data(), front.size(), 1 << 20, nullptr, &stream), SIGHTCELL_OK);
  const sightcell_status status = sightcell_stream_deliver(stream, 0, chunk.data(), chunk.size());
  EXPECT_EQ(sightcell_stream_state(stream, 0) == SIGHTCELL_STREAM_PRESENT, status == SIGHTCELL_OK);
  sightcell_stream_close(stream);
  return status;
}

TEST(stream_front, describes_the_scene) {
  small_stream content = four_rooms();
  content.draws[1].material = 7;
  content.draws[1].flags = SIGHTCELL_STREAM_MOVES | SIGHTCELL_STREAM_ALWAYS;
  content.draws[1].object = 0, content.draws[1].level = 2;
  content.draws[1].node = 70'000, content.draws[1].mesh = 3, content.draws[1].primitive = 1;
  content.draws[1].instance = 9;
  content.draws[1].matrix[10] = -2.5f;
  const open_stream scene(content);
  ASSERT_EQ(scene.status, SIGHTCELL_OK);
  sightcell_stream_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(sightcell_stream_describe(scene.stream, &info), SIGHTCELL_OK);
  EXPECT_EQ(info.polygon_count, 10u);
  EXPECT_EQ(info.chunk_count, 2u);
  EXPECT_EQ(info.page_count, 4u);
  EXPECT_EQ(info.image_count, 2u);
  EXPECT_EQ(info.image_file_count, 4u);
  EXPECT_EQ(info.file_count, 10u);
  EXPECT_EQ(info.cell_count, 4u);
  EXPECT_EQ(info.max[2], 51.0f);
  EXPECT_EQ(sightcell_stream_same_scene(scene.stream, content.fingerprint.data()), SIGHTCELL_OK);
  content.fingerprint[15] = 1;
  EXPECT_EQ(sightcell_stream_same_scene(scene.stream, content.fingerprint.data()), SIGHTCELL_ERR_OTHER_SCENE);

  std::size_t count = 0;
  std::vector<sightcell_stream_draw> draws(5);
  EXPECT_EQ(sightcell_stream_draws(scene.stream, nullptr, 0, &count), SIGHTCELL_ERR_CAPACITY);
  ASSERT_EQ(count, 5u);
  ASSERT_EQ(sightcell_stream_draws(scene.stream, draws.data(), 5, &count), SIGHTCELL_OK);
  EXPECT_TRUE(std::equal(reinterpret_cast<const char*>(draws.data()), reinterpret_cast<const char*>(draws.data() + 5),
                         reinterpret_cast<const char*>(content.draws.data())));
  std::string json(content.json.size(), ' ');
  ASSERT_EQ(sightcell_stream_json(scene.stream, json.data(), json.size(), &count), SIGHTCELL_OK);
  EXPECT_EQ(json, content.json);
  std::uint32_t polygons = 0, first = 0, files = 0;
  ASSERT_EQ(sightcell_stream_geometries(scene.stream, &polygons, 1, &count), SIGHTCELL_OK);
  EXPECT_EQ(polygons, 2u);
  ASSERT_EQ(sightcell_stream_image_files(scene.stream, 1, &first, &files), SIGHTCELL_OK);
  EXPECT_EQ(first, content.image(1));
  EXPECT_EQ(files, 1u);
}

TEST(stream_front, names_files) {
  const small_stream content = four_rooms();
  const open_stream scene(content);
  const auto describe = [&](std::uint32_t file) {
    sightcell_stream_file out{};
    EXPECT_EQ(sightcell_stream_describe_file(scene.stream, file, &out), SIGHTCELL_OK);
    std::string hex;
    for (const std::uint8_t byte : hash_of_file(content.file(file)))
      for (const int half : {byte >> 4, byte & 15}) hex += "0123456789abcdef"[half];
    const char* const folders[] = {"cells/", "pages/", "images/"};
    const char* const extensions[] = {".cells", ".glb", ".webp"};
    EXPECT_EQ(out.name, folders[out.kind] + hex + extensions[out.kind]);
    EXPECT_EQ(out.size, content.file(file).size());
    return out;
  };
  EXPECT_EQ(describe(1).kind, std::uint32_t{SIGHTCELL_STREAM_CHUNK});
  EXPECT_EQ(describe(content.page(3)).number, 3u);
  const sightcell_stream_file image = describe(content.image(0, 2));
  EXPECT_EQ(image.number, 0u);
  EXPECT_EQ(image.width, 64u);
  sightcell_stream_file out;
  EXPECT_EQ(sightcell_stream_describe_file(scene.stream, 10, &out), SIGHTCELL_ERR_ARGUMENT);
}

TEST(stream_front, rejects_what_is_none) {
  const bytes good = four_rooms().front();
  ASSERT_EQ(open_bytes(good), SIGHTCELL_OK);
  bytes other = good;
  other[0] = 'X';
  EXPECT_EQ(open_bytes(other), SIGHTCELL_ERR_NOT_OURS);
  other = good;
  other[8] = 2;
  EXPECT_EQ(open_bytes(other), SIGHTCELL_ERR_VERSION);
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_NE(open_bytes({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}), SIGHTCELL_OK) << size;
  other = good;
  other.push_back(0);
  EXPECT_EQ(open_bytes(other), SIGHTCELL_ERR_CORRUPT);
}

TEST(stream_front, a_payload_that_claims_gigabytes_costs_no_memory) {
  held_memory memory;
  bytes front = four_rooms().front();
  std::fill_n(front.begin() + 12, 4, std::uint8_t{0xFF});
  sightcell_stream* stream = nullptr;
  EXPECT_EQ(sightcell_stream_open(front.data(), front.size(), 0, &memory.interface, &stream), SIGHTCELL_ERR_CORRUPT);
  EXPECT_EQ(memory.bytes, 0u);
}

TEST(stream_front, changed_bytes_are_rejected_or_harmless) {
  const bytes payload = four_rooms().front_payload();
  int accepted = 0, rejected = 0;
  for (std::size_t at = 0; at < payload.size(); ++at)
    for (const int change : {1, 2, 128, 255}) {
      bytes other = payload;
      other[at] = static_cast<std::uint8_t>(other[at] ^ change);
      const sightcell_status status = open_bytes(small_stream::as_front(other));
      ASSERT_TRUE(status == SIGHTCELL_OK || status == SIGHTCELL_ERR_CORRUPT);
      ++(status == SIGHTCELL_OK ? accepted : rejected);
    }
  EXPECT_GT(accepted, 100);  // names, hashes, matrices
  EXPECT_GT(rejected, 100);  // counts, references, boxes
}

TEST(stream_front, rejects_numbers_out_of_range) {
  const auto expect_corrupt = [](auto change) {
    small_stream content = four_rooms();
    change(content);
    EXPECT_EQ(open_bytes(content.front()), SIGHTCELL_ERR_CORRUPT);
  };
  expect_corrupt([](small_stream& s) { s.pages_everywhere = {4}; });
  expect_corrupt([](small_stream& s) { s.images_everywhere = {2}; });
  expect_corrupt([](small_stream& s) { s.box[0] = 60; });
  expect_corrupt([](small_stream& s) { s.pages[0].box[0] = 200; });
  expect_corrupt([](small_stream& s) { s.draws[0].flags = 8; });
  expect_corrupt([](small_stream& s) { s.draws[0].flags = SIGHTCELL_STREAM_ALWAYS | SIGHTCELL_STREAM_HOST_SHOWS; });
  expect_corrupt([](small_stream& s) { s.draws[0].matrix[3] = std::bit_cast<float>(0x7FC00000u); });
}

TEST(stream_chunk, rejects_other_bytes) {
  const small_stream content = four_rooms();
  const open_stream scene(content);
  bytes chunk = content.chunk_file(0);
  chunk.back() ^= 1;
  EXPECT_EQ(sightcell_stream_deliver(scene.stream, 0, chunk.data(), chunk.size()), SIGHTCELL_ERR_CHECKSUM);
  EXPECT_EQ(sightcell_stream_deliver(scene.stream, 0, chunk.data(), chunk.size() - 1), SIGHTCELL_ERR_TRUNCATED);
  EXPECT_EQ(sightcell_stream_state(scene.stream, 0), std::uint32_t{SIGHTCELL_STREAM_ABSENT});
  const bytes page = content.file(content.page(1));
  EXPECT_EQ(sightcell_stream_deliver(scene.stream, content.page(0), page.data(), page.size()), SIGHTCELL_ERR_TRUNCATED);
}

TEST(stream_chunk, rejects_numbers_out_of_range) {
  const auto expect_corrupt = [](auto change) {
    small_stream content = four_rooms();
    change(content.chunks[0]);
    EXPECT_EQ(deliver_chunk(four_rooms(), content.chunk_file(0)), SIGHTCELL_ERR_CORRUPT);
  };
  expect_corrupt([](std::vector<small_cell>& cells) { cells[0].box[1] = 11; });
  expect_corrupt([](std::vector<small_cell>& cells) { cells[0].pages[0].number = 4; });
  expect_corrupt([](std::vector<small_cell>& cells) { cells[0].images[0].number = 2; });
  expect_corrupt([](std::vector<small_cell>& cells) { cells[0].runs[0] = {0, 6}; });
  expect_corrupt([](std::vector<small_cell>& cells) { cells[0].weight = -1.0f; });
  expect_corrupt([](std::vector<small_cell>& cells) { cells.pop_back(); });
}

TEST(stream_chunk, changed_bytes_are_rejected_or_harmless) {
  const small_stream content = four_rooms();
  const bytes payload = content.chunk_payload(0);
  int accepted = 0, rejected = 0;
  for (std::size_t at = 0; at < payload.size(); ++at)
    for (const int change : {1, 2, 128, 255}) {
      bytes other = payload;
      other[at] = static_cast<std::uint8_t>(other[at] ^ change);
      const sightcell_status status = deliver_chunk(content, small_stream::as_chunk(other));
      ASSERT_TRUE(status == SIGHTCELL_OK || status == SIGHTCELL_ERR_CORRUPT);
      ++(status == SIGHTCELL_OK ? accepted : rejected);
    }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(rejected, 50);
  for (std::size_t size = 0; size < payload.size(); ++size)
    EXPECT_EQ(deliver_chunk(content, small_stream::as_chunk(
                                         {payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(size)})),
              SIGHTCELL_ERR_CORRUPT);
}

TEST(stream_chunk, without_memory_nothing_is_lost) {
  const small_stream content = four_rooms();
  for (int granted = 0;; ++granted) {
    struct limited {
      int left;
      std::size_t held = 0;
    } memory{granted};
    const sightcell_allocator mem{[](void* user, std::size_t size, std::size_t) -> void* {
                                    auto& m = *static_cast<limited*>(user);
                                    if (m.left-- <= 0) return nullptr;
                                    m.held += size;
                                    return std::malloc(size);
                                  },
                                  [](void* user, void* block, std::size_t size) {
                                    static_cast<limited*>(user)->held -= size;
                                    std::free(block);
                                  },
                                  &memory};
    sightcell_status delivered = SIGHTCELL_ERR_MEMORY;
    {
      const open_stream scene(content, 1 << 20, &mem);
      if (scene.status == SIGHTCELL_OK) {
        const bytes chunk = content.chunk_file(0);
        delivered = sightcell_stream_deliver(scene.stream, 0, chunk.data(), chunk.size());
      }
      EXPECT_TRUE(scene.status == SIGHTCELL_OK || scene.status == SIGHTCELL_ERR_MEMORY);
    }
    EXPECT_EQ(memory.held, 0u) << granted;
    if (delivered == SIGHTCELL_OK) {
      EXPECT_GT(granted, 4);
      return;
    }
    EXPECT_EQ(delivered, SIGHTCELL_ERR_MEMORY);
  }
}

}  // namespace
