// Opening a file in each way, each failure of it, and deliveries.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "golden/damaged_file.h"
#include "loaded_file.h"
#include "outcome_calls.h"
#include "paged_host.h"
#include "sightcell/casters.h"
#include "sightcell/clusters.h"
#include "sightcell/format/layout.h"
#include "sightcell/identity.h"
#include "sightcell/lights.h"
#include "sightcell/residency.h"
#include "sightcell/viewpoints.h"

namespace sightcell::test {
namespace {

namespace layout = sightcell::format::layout;
using bytes = std::vector<std::byte>;

struct faulty_file {
  sightcell_status expected;
  bytes content;
};

std::vector<faulty_file> faulty_files() {
  const bytes whole = small_contents().encode();
  std::vector<faulty_file> files{{SIGHTCELL_ERR_NOT_OURS, bytes(200)}};
  const auto add = [&](sightcell_status expected, const auto& change) {
    files.push_back({expected, whole});
    change(files.back().content);
  };
  add(SIGHTCELL_ERR_VERSION, [](bytes& b) { set_u32(b, layout::header_version, layout::version + 1); });
  add(SIGHTCELL_ERR_TRUNCATED, [](bytes& b) { b.pop_back(); });
  add(SIGHTCELL_ERR_CHECKSUM, [](bytes& b) { b[section_offset(b, layout::section_cells)] ^= std::byte{1}; });
  add(SIGHTCELL_ERR_CORRUPT, [](bytes& b) { b.push_back(std::byte{}); });
  add(SIGHTCELL_ERR_LIMIT, [](bytes& b) {
    set_u32(b, layout::header_draw_count, layout::max_draws + 1);
    reseal(b);
  });
  return files;
}

// A .glb with the JSON {}.
bytes glb_without_pvs() {
  bytes b(24);
  set_u32(b, 0, 0x46546C67);
  set_u32(b, 4, 2);
  set_u32(b, 8, 24);
  set_u32(b, 12, 4);
  set_u32(b, 16, 0x4E4F534A);
  set_u32(b, 20, 0x20207D7B);
  return b;
}

// A file whose header claims more bytes before its rows than one request can name.
sightcell_status open_with_a_front_of_5_gb() {
  struct large_host {
    bytes content = small_contents().encode();
    sightcell_db* db = nullptr;
  } host;
  constexpr std::uint64_t size = 5'000'000'000;
  const std::size_t settings = section_place(host.content, layout::section_settings);
  set_u64(host.content, settings + 16, size - get_u64(host.content, settings + 8));
  set_u64(host.content, layout::header_total_size, size);
  reseal(host.content);
  host.content.resize(std::max<std::size_t>(host.content.size(), 1 << 16));
  const sightcell_source source{&host, size, [](void* user, std::uint64_t, std::uint32_t count, std::uint32_t ticket) {
                                  const auto& self = *static_cast<large_host*>(user);
                                  return sightcell_db_deliver(self.db, ticket, self.content.data(), count);
                                }};
  const sightcell_status begun = sightcell_db_begin_source(&source, nullptr, 1 << 20, &host.db);
  EXPECT_EQ(sightcell_db_open_source(&source, nullptr, 1 << 20, &host.db), begun);
  return begun;
}

}  // namespace

void open_from_memory(outcomes& out) {
  const bytes whole = small_contents().encode();
  sightcell_db* db = nullptr;
  RETURNS(OK, sightcell_db_open(whole.data(), whole.size(), nullptr, &db));
  sightcell_db_close(db);
  RETURNS(ERR_ARGUMENT, sightcell_db_open(nullptr, 5, nullptr, &db));
  few_blocks none(0);
  RETURNS(ERR_MEMORY, sightcell_db_open(whole.data(), whole.size(), &none.interface, &db));
  for (const auto& [expected, content] : faulty_files()) {
    out.note("sightcell_db_open", expected, sightcell_db_open(content.data(), content.size(), nullptr, &db));
  }
  const bytes glb = glb_without_pvs();
  RETURNS(ERR_ABSENT, sightcell_db_open(glb.data(), glb.size(), nullptr, &db));
}

void open_from_disk(outcomes& out) {
  const std::string name = testing::TempDir() + "sightcell_every_outcome.pvs";
  const auto write = [&](const bytes& content) {
    EXPECT_EQ(sightcell::format::write_file(name.c_str(), content), sightcell::format::status::ok);
  };
  sightcell_db* db = nullptr;
  write(small_contents().encode());
  RETURNS(OK, sightcell_db_open_file(name.c_str(), nullptr, &db));
  sightcell_db_close(db);
  RETURNS(ERR_ARGUMENT, sightcell_db_open_file(nullptr, nullptr, &db));
  few_blocks one(1);
  RETURNS(ERR_MEMORY, sightcell_db_open_file(name.c_str(), &one.interface, &db));
  RETURNS(ERR_IO, sightcell_db_open_file((name + ".none").c_str(), nullptr, &db));
  for (const auto& [expected, content] : faulty_files()) {
    write(content);
    out.note("sightcell_db_open_file", expected, sightcell_db_open_file(name.c_str(), nullptr, &db));
  }
  write(glb_without_pvs());
  RETURNS(ERR_ABSENT, sightcell_db_open_file(name.c_str(), nullptr, &db));
  std::remove(name.c_str());
}

void open_from_a_source(outcomes& out) {
  const auto open = [&out](sightcell_status expected, paged_host& host, std::uint64_t resident_bytes,
                           const sightcell_allocator* mem = nullptr) {
    out.note("sightcell_db_open_source", expected, host.open(resident_bytes, mem));
  };
  paged_host good(small_contents().encode());
  few_blocks two(2);
  open(SIGHTCELL_ERR_MEMORY, good, 1 << 20, &two.interface);
  open(SIGHTCELL_ERR_CAPACITY, good, 10);
  good.answer = SIGHTCELL_ERR_STALE;
  open(SIGHTCELL_ERR_STALE, good, 1 << 20);
  good.answer = SIGHTCELL_OK;
  open(SIGHTCELL_OK, good, 1 << 20);
  for (const auto& [expected, content] : faulty_files()) {
    paged_host host(content);
    open(expected, host, 1 << 20);
  }
  paged_host first_version(golden_file("v0_small"));
  open(SIGHTCELL_ERR_VERSION, first_version, 1 << 20);
  sightcell_db* db = nullptr;
  RETURNS(ERR_ARGUMENT, sightcell_db_open_source(nullptr, nullptr, 1 << 20, &db));
  const sightcell_source silent{nullptr, 5000,
                                [](void*, std::uint64_t, std::uint32_t, std::uint32_t) { return SIGHTCELL_OK; }};
  RETURNS(ERR_IO, sightcell_db_open_source(&silent, nullptr, 1 << 20, &db));
  const sightcell_status limit = open_with_a_front_of_5_gb();
  out.note("sightcell_db_open_source", SIGHTCELL_ERR_LIMIT, limit);
  out.note("sightcell_db_begin_source", SIGHTCELL_ERR_LIMIT, limit);
}

// Each failure at once, and after deliveries that came later.
void open_without_waiting(outcomes& out) {
  const auto open = [&out](sightcell_status expected, const bytes& content, std::uint64_t resident_bytes = 1 << 20,
                           int blocks = 99) {
    few_blocks memory(blocks);
    paged_host early(content);
    early.at_once = true;
    out.note("sightcell_db_begin_source", expected, early.begin(resident_bytes, &memory.interface));
    memory.left = blocks;
    paged_host late(content);
    sightcell_status s = late.begin(resident_bytes, &memory.interface);
    out.note("sightcell_db_begin_source", SIGHTCELL_PENDING, s);
    for (int request = 0; request < 2 && s == SIGHTCELL_PENDING; ++request) {
      EXPECT_EQ(late.deliver(late.waiting.back()), SIGHTCELL_OK);
      s = sightcell_db_opened(late.db());
      if (s == SIGHTCELL_PENDING) out.note("sightcell_db_opened", SIGHTCELL_PENDING, s);
    }
    out.note("sightcell_db_opened", expected, s);
  };
  const bytes good = small_contents().encode();
  open(SIGHTCELL_OK, good);
  open(SIGHTCELL_ERR_CAPACITY, good, 10);
  open(SIGHTCELL_ERR_MEMORY, good, 1 << 20, 2);
  for (const auto& [expected, content] : faulty_files()) open(expected, content);

  paged_host host(good);
  host.answer = SIGHTCELL_ERR_STALE;
  out.note("sightcell_db_begin_source", SIGHTCELL_ERR_STALE, host.begin(1 << 20));
  host.answer = SIGHTCELL_OK;
  ASSERT_EQ(host.begin(1 << 20), SIGHTCELL_PENDING);
  sightcell_view* view = nullptr;
  RETURNS(PENDING, sightcell_view_create(host.db(), &view));
  sightcell_cluster_map* map = nullptr;
  RETURNS(PENDING, sightcell_cluster_map_create(host.db(), nullptr, 0, 0, &map));
  sightcell_casters* casters = nullptr;
  RETURNS(PENDING, sightcell_casters_create(host.db(), &casters));
  sightcell_lights* lights = nullptr;
  RETURNS(PENDING, sightcell_lights_create(host.db(), &lights));
  sightcell_residency* residency = nullptr;
  RETURNS(PENDING, sightcell_residency_create(host.db(), &residency));
  RETURNS(PENDING, sightcell_cluster_map_of_file(host.db(), &map));
  float eye[3];
  RETURNS(PENDING, sightcell_db_cell_eye(host.db(), 0, 0, eye));
  sightcell_draw_match match{};
  match.struct_size = sizeof match;
  RETURNS(PENDING, sightcell_db_match(host.db(), nullptr, nullptr, 0, nullptr, &match));
  std::uint64_t hash = 0;
  std::size_t count = 0;
  EXPECT_EQ(sightcell_db_cluster_count(host.db()), 0u);
  RETURNS(PENDING, sightcell_db_clusters(host.db(), nullptr, 0, &count));
  RETURNS(PENDING, sightcell_db_error_bounds(host.db(), nullptr, 0, &count));
  RETURNS(PENDING, sightcell_db_draw_hash(host.db(), 0, &hash));
  RETURNS(PENDING, sightcell_db_draw_name(host.db(), 0, SIGHTCELL_NAME_NODE, nullptr, 0, &count));
  host.answer = SIGHTCELL_ERR_STALE;
  EXPECT_EQ(host.deliver(host.waiting.back()), SIGHTCELL_OK);
  out.note("sightcell_db_opened", SIGHTCELL_ERR_STALE, sightcell_db_opened(host.db()));
  out.note("sightcell_db_opened", SIGHTCELL_ERR_IO, sightcell_db_opened(host.db()));
  sightcell_db* db = nullptr;
  const sightcell_source unreadable{&db, 5000, [](void* user, std::uint64_t, std::uint32_t, std::uint32_t ticket) {
                                      return sightcell_db_deliver(*static_cast<sightcell_db**>(user), ticket, nullptr,
                                                                  0);
                                    }};
  RETURNS(ERR_IO, sightcell_db_begin_source(&unreadable, nullptr, 1 << 20, &db));
  RETURNS(ERR_ARGUMENT, sightcell_db_begin_source(nullptr, nullptr, 1 << 20, &db));
  RETURNS(ERR_ARGUMENT, sightcell_db_opened(nullptr));

  const loaded_file file(small_contents());
  sightcell_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(sightcell_db_info(file.db(), &info), SIGHTCELL_OK);
  RETURNS(OK, sightcell_db_same_scene(file.db(), info.scene_fingerprint));
  info.scene_fingerprint[15] ^= 1;
  RETURNS(ERR_OTHER_SCENE, sightcell_db_same_scene(file.db(), info.scene_fingerprint));
  RETURNS(ERR_ARGUMENT, sightcell_db_same_scene(file.db(), nullptr));
}

void deliver_and_prefetch(outcomes& out) {
  const sample_contents contents = random_contents(91, {.polygons = 900, .draws = 20, .cells = 512});
  bytes content = contents.encode();
  const std::size_t directory = section_offset(content, layout::section_row_directory);
  std::uint32_t largest = 0;
  for (std::size_t chunk = 0; chunk < 8; ++chunk)
    largest = std::max(largest, get_u32(content, directory + 16 * chunk + 8));
  paged_host host(std::move(content));
  ASSERT_EQ(host.open(largest), SIGHTCELL_OK);
  test_view view(host.db());
  const auto ask = [&](std::uint32_t cell) {
    const auto& b = contents.cells[cell];
    out.frame_flags |= view.move(b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f).flags;
    const page_request r = host.waiting.back();
    host.waiting.clear();
    return r;
  };
  const auto* const data = host.bytes().data();
  page_request r = ask(0);
  RETURNS(ERR_TRUNCATED, sightcell_db_deliver(host.db(), r.ticket, data + r.offset, r.size - 1));
  r = ask(0);
  RETURNS(ERR_CORRUPT, sightcell_db_deliver(host.db(), r.ticket, data + r.offset, r.size + 1));
  r = ask(0);
  const page_request later = ask(64);
  RETURNS(OK, sightcell_db_deliver(host.db(), later.ticket, data + later.offset, later.size));
  RETURNS(ERR_STALE, sightcell_db_deliver(host.db(), later.ticket, data + later.offset, later.size));
  RETURNS(ERR_CAPACITY, sightcell_db_deliver(host.db(), r.ticket, data + r.offset, r.size));
  r = ask(0);
  bytes damaged(data + r.offset, data + r.offset + r.size);
  damaged[r.size / 2] ^= std::byte{64};
  RETURNS(ERR_CHECKSUM, sightcell_db_deliver(host.db(), r.ticket, damaged.data(), r.size));
  out.frame_flags |= view.move(0.5f, 0.5f, 0.5f).flags;
  RETURNS(ERR_ARGUMENT, sightcell_db_deliver(nullptr, 1, data, 4));

  const float place[3] = {1, 1, 1};
  RETURNS(OK, sightcell_db_prefetch(host.db(), place, place, 1.0f));
  RETURNS(ERR_ARGUMENT, sightcell_db_prefetch(host.db(), place, place, -1.0f));
  RETURNS(ERR_IO, sightcell_db_check(host.db()));
}

}  // namespace sightcell::test
