// Every status, flag and kind of the headers, by a call of the C API that returns it; and for each function exactly the
// statuses that its comment documents. The list of functions and values is read from the headers, so that an addition
// needs a row here.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "golden/damaged_file.h"
#include "loaded_file.h"
#include "outcomes.h"
#include "paged_host.h"
#include "polygon_orders_writer.h"
#include "sightcell/casters.h"
#include "sightcell/clusters.h"
#include "sightcell/format/layout.h"
#include "sightcell/identity.h"
#include "sightcell/viewpoints.h"
#include "table_encoder.h"
#include "unit/format/caster_samples.h"
#include "unit/format/importance_samples.h"
#include "unit/format/viewpoint_samples.h"

namespace {

using namespace sightcell::test;
namespace layout = sightcell::format::layout;
using bytes = std::vector<std::byte>;

const statuses with_arguments{SIGHTCELL_OK, SIGHTCELL_ERR_ARGUMENT};
const statuses of_lists{SIGHTCELL_OK, SIGHTCELL_ERR_ARGUMENT, SIGHTCELL_ERR_CAPACITY};
const statuses of_open{SIGHTCELL_OK,           SIGHTCELL_ERR_ARGUMENT, SIGHTCELL_ERR_MEMORY,
                       SIGHTCELL_ERR_NOT_OURS, SIGHTCELL_ERR_VERSION,  SIGHTCELL_ERR_TRUNCATED,
                       SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT,  SIGHTCELL_ERR_LIMIT};

statuses operator+(statuses all, const statuses& more) {
  all.insert(more.begin(), more.end());
  return all;
}

// The statuses that the comments of sightcell.h document.
const statuses of_identity{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT, SIGHTCELL_PENDING};
const std::map<std::string, statuses> promised{
    {"sightcell_db_open", of_open},
    {"sightcell_db_open_file", of_open + statuses{SIGHTCELL_ERR_IO}},
    // STALE is what the host's request returned.
    {"sightcell_db_open_source", of_open + statuses{SIGHTCELL_ERR_IO, SIGHTCELL_ERR_CAPACITY, SIGHTCELL_ERR_STALE}},
    {"sightcell_db_begin_source",
     of_open + statuses{SIGHTCELL_PENDING, SIGHTCELL_ERR_IO, SIGHTCELL_ERR_CAPACITY, SIGHTCELL_ERR_STALE}},
    {"sightcell_db_opened",
     of_open + statuses{SIGHTCELL_PENDING, SIGHTCELL_ERR_IO, SIGHTCELL_ERR_CAPACITY, SIGHTCELL_ERR_STALE}},
    {"sightcell_db_same_scene", with_arguments + statuses{SIGHTCELL_ERR_OTHER_SCENE}},
    {"sightcell_db_deliver",
     with_arguments + statuses{SIGHTCELL_ERR_STALE, SIGHTCELL_ERR_TRUNCATED, SIGHTCELL_ERR_CORRUPT,
                               SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CAPACITY}},
    {"sightcell_db_prefetch", with_arguments},
    {"sightcell_db_cell_box", with_arguments},
    {"sightcell_db_cell_viewpoints", with_arguments},
    {"sightcell_db_volume_box", with_arguments},
    {"sightcell_db_named_group_name", of_lists},
    {"sightcell_db_find_named_group", with_arguments},
    {"sightcell_db_named_groups_of_draws", of_lists},
    {"sightcell_view_show_named_group", with_arguments},
    {"sightcell_db_info", with_arguments},
    // open finds the other faults of a file.
    {"sightcell_db_check",
     with_arguments + statuses{SIGHTCELL_ERR_MEMORY, SIGHTCELL_ERR_IO, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT}},
    {"sightcell_db_draws", of_lists},
    {"sightcell_db_order", of_lists},
    {"sightcell_view_create", with_arguments + statuses{SIGHTCELL_ERR_MEMORY, SIGHTCELL_PENDING}},
    {"sightcell_view_move", with_arguments},
    {"sightcell_view_move_box", with_arguments},
    {"sightcell_view_policy", with_arguments},
    {"sightcell_view_origin", with_arguments},
    {"sightcell_view_polygons", of_lists},
    {"sightcell_view_ranges", of_lists},
    {"sightcell_view_indices", of_lists},
    {"sightcell_view_commands", of_lists + statuses{SIGHTCELL_ERR_LIMIT}},
    {"sightcell_view_objects", of_lists},
    {"sightcell_view_importance",
     of_lists + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_STALE, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT}},
    {"sightcell_view_box_visible", with_arguments},
    {"sightcell_view_changes", of_lists + statuses{SIGHTCELL_ERR_STALE}},
    {"sightcell_view_statistics", with_arguments},
    {"sightcell_db_statistics", with_arguments},
    {"sightcell_view_debug_lines", of_lists + statuses{SIGHTCELL_ERR_CORRUPT}},
    {"sightcell_db_misses_text", of_lists},
    {"sightcell_db_cell_eye",
     with_arguments + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT, SIGHTCELL_PENDING}},
    {"sightcell_geometry_hash", with_arguments},
    {"sightcell_db_match", with_arguments + of_identity + statuses{SIGHTCELL_ERR_OTHER_SCENE, SIGHTCELL_ERR_MEMORY}},
    {"sightcell_db_draw_hash", with_arguments + of_identity},
    {"sightcell_db_draw_name", of_lists + of_identity},
    {"sightcell_cluster_map_create", with_arguments + statuses{SIGHTCELL_ERR_MEMORY, SIGHTCELL_PENDING}},
    {"sightcell_view_clusters", of_lists},
    {"sightcell_casters_create",
     with_arguments + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT,
                               SIGHTCELL_ERR_MEMORY, SIGHTCELL_PENDING}},
    {"sightcell_casters_suns", of_lists},
    {"sightcell_view_casters", of_lists},
    {"sightcell_view_caster_indices", of_lists},
    {"sightcell_cluster_list", of_lists},
    {"sightcell_cluster_changes", of_lists},
};

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
  std::remove(name.c_str());
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
  float eye[3];
  RETURNS(PENDING, sightcell_db_cell_eye(host.db(), 0, 0, eye));
  sightcell_draw_match match{};
  match.struct_size = sizeof match;
  RETURNS(PENDING, sightcell_db_match(host.db(), nullptr, nullptr, 0, nullptr, &match));
  std::uint64_t hash = 0;
  std::size_t count = 0;
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

void facts(outcomes& out) {
  sample_contents contents = small_contents();
  add_volumes(contents, 3, 1);
  const bytes whole = contents.encode();
  const loaded_file file(whole);
  const auto* const db = file.db();
  float min[3];
  float max[3];
  RETURNS(OK, sightcell_db_cell_box(db, 66, min, max));
  RETURNS(ERR_ARGUMENT, sightcell_db_cell_box(db, 67, min, max));
  RETURNS(OK, sightcell_db_cell_viewpoints(db, 66, min, max));
  RETURNS(ERR_ARGUMENT, sightcell_db_cell_viewpoints(db, 67, min, max));
  RETURNS(OK, sightcell_db_volume_box(db, 2, min, max));
  RETURNS(ERR_ARGUMENT, sightcell_db_volume_box(db, 3, min, max));
  sightcell_info info{};
  RETURNS(ERR_ARGUMENT, sightcell_db_info(db, &info));
  info.struct_size = sizeof info;
  RETURNS(OK, sightcell_db_info(db, &info));

  RETURNS(OK, sightcell_db_check(db));
  RETURNS(ERR_ARGUMENT, sightcell_db_check(nullptr));
  few_blocks one(1);
  const loaded_file poor(whole, &one.interface);
  RETURNS(ERR_MEMORY, sightcell_db_check(poor.db()));
  sightcell_view* view = nullptr;
  RETURNS(ERR_MEMORY, sightcell_view_create(poor.db(), &view));
  bytes changed = small_contents().encode();
  changed.back() ^= std::byte{1};  // rows
  const loaded_file damaged(std::move(changed));
  RETURNS(ERR_CHECKSUM, sightcell_db_check(damaged.db()));
  changed = small_contents().encode();
  set_u32(changed, layout::header_range_bound, get_u32(changed, layout::header_range_bound) + 1);
  reseal(changed);
  const loaded_file boasting(std::move(changed));
  RETURNS(ERR_CORRUPT, sightcell_db_check(boasting.db()));

  std::array<sightcell_draw, 3> draws;
  std::array<std::uint32_t, 300> order;
  std::size_t count = 0;
  RETURNS(OK, sightcell_db_draws(db, draws.data(), draws.size(), &count));
  RETURNS(ERR_CAPACITY, sightcell_db_draws(db, draws.data(), 2, &count));
  RETURNS(ERR_ARGUMENT, sightcell_db_draws(db, nullptr, 3, &count));
  RETURNS(OK, sightcell_db_order(db, order.data(), order.size(), &count));
  RETURNS(ERR_CAPACITY, sightcell_db_order(db, order.data(), 299, &count));
  RETURNS(ERR_ARGUMENT, sightcell_db_order(db, order.data(), 300, nullptr));

  sightcell_db_stats stats{};
  RETURNS(ERR_ARGUMENT, sightcell_db_statistics(db, &stats));
  stats.struct_size = sizeof stats;
  RETURNS(OK, sightcell_db_statistics(db, &stats));
  const sightcell_miss miss{{1, 2, 3}, 5, 0};
  const sightcell_miss wrong{{1, 2, std::nan("")}, 5, 0};
  std::array<char, 500> text;
  RETURNS(OK, sightcell_db_misses_text(db, &miss, 1, text.data(), text.size(), &count));
  RETURNS(ERR_CAPACITY, sightcell_db_misses_text(db, &miss, 1, text.data(), 10, &count));
  RETURNS(ERR_ARGUMENT, sightcell_db_misses_text(db, &wrong, 1, text.data(), text.size(), &count));
}

void eyes(outcomes& out) {
  sample_contents contents = tiny_contents();
  add_viewpoints(contents, 1);
  contents.viewpoints[0].eyes = {{0, 2048, 4095}};
  const bytes whole = contents.encode();
  const loaded_file file(whole);
  float eye[3];
  RETURNS(OK, sightcell_db_cell_eye(file.db(), 0, 0, eye));
  RETURNS(ERR_ABSENT, sightcell_db_cell_eye(file.db(), 0, 1, eye));
  RETURNS(ERR_ABSENT, sightcell_db_cell_eye(file.db(), 1, 0, eye));
  RETURNS(ERR_ARGUMENT, sightcell_db_cell_eye(file.db(), 2, 0, eye));
  const loaded_file none(tiny_contents());
  RETURNS(ERR_ABSENT, sightcell_db_cell_eye(none.db(), 0, 0, eye));
  const std::size_t section = section_offset(whole, layout::section_eyes);
  bytes changed = whole;
  changed[section] ^= std::byte{16};  // more eyes than a cell may have
  const loaded_file damaged(changed);
  RETURNS(ERR_CHECKSUM, sightcell_db_cell_eye(damaged.db(), 0, 0, eye));
  reseal(changed);
  const loaded_file corrupt(std::move(changed));
  RETURNS(ERR_CORRUPT, sightcell_db_cell_eye(corrupt.db(), 0, 0, eye));
}

void identities(outcomes& out) {
  sample_contents contents = tiny_contents();
  contents.geometry_hashes = {5};
  contents.node_names = {"", "", "Cube"};
  const bytes whole = contents.encode();
  const std::size_t section = section_offset(whole, layout::section_identity);
  bytes changed = whole;
  changed[section] ^= std::byte{16};  // more hashes than draws
  const loaded_file wrong_sum(changed);
  reseal(changed);
  const loaded_file corrupt(std::move(changed));
  const loaded_file none(tiny_contents());
  few_blocks one(1);
  const loaded_file poor(whole, &one.interface);
  const loaded_file file(whole);
  std::uint64_t hash = 5;
  std::uint32_t draw = 0;
  std::size_t count = 0;
  std::array<char, 4> name{};
  sightcell_draw_match match{};
  match.struct_size = sizeof match;
  RETURNS(OK, sightcell_db_match(file.db(), &hash, nullptr, 1, &draw, &match));
  RETURNS(ERR_OTHER_SCENE, sightcell_db_match(file.db(), nullptr, nullptr, 0, nullptr, &match));
  RETURNS(ERR_ARGUMENT, sightcell_db_match(file.db(), &hash, nullptr, 1, nullptr, &match));
  RETURNS(ERR_MEMORY, sightcell_db_match(poor.db(), &hash, nullptr, 1, &draw, &match));
  RETURNS(OK, sightcell_db_draw_hash(file.db(), 0, &hash));
  RETURNS(ERR_ARGUMENT, sightcell_db_draw_hash(file.db(), 1, &hash));
  RETURNS(OK, sightcell_db_draw_name(file.db(), 0, SIGHTCELL_NAME_NODE, name.data(), 4, &count));
  RETURNS(ERR_CAPACITY, sightcell_db_draw_name(file.db(), 0, SIGHTCELL_NAME_NODE, name.data(), 3, &count));
  RETURNS(ERR_ARGUMENT, sightcell_db_draw_name(file.db(), 0, 2, name.data(), 4, &count));
  const std::array<std::pair<const loaded_file*, sightcell_status>, 3> faulty{
      {{&wrong_sum, SIGHTCELL_ERR_CHECKSUM}, {&corrupt, SIGHTCELL_ERR_CORRUPT}, {&none, SIGHTCELL_ERR_ABSENT}}};
  for (const auto& [from, expected] : faulty) {
    out.note("sightcell_db_match", expected, sightcell_db_match(from->db(), &hash, nullptr, 1, &draw, &match));
    out.note("sightcell_db_draw_hash", expected, sightcell_db_draw_hash(from->db(), 0, &hash));
    out.note("sightcell_db_draw_name", expected,
             sightcell_db_draw_name(from->db(), 0, SIGHTCELL_NAME_MESH, name.data(), 4, &count));
  }
  const std::array<float, 9> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::array<std::uint32_t, 3> triangle{0, 1, 2};
  RETURNS(OK, sightcell_geometry_hash(positions.data(), 12, 3, triangle.data(), 3, &hash));
  RETURNS(ERR_ARGUMENT, sightcell_geometry_hash(positions.data(), 12, 2, triangle.data(), 3, &hash));
  RETURNS(ERR_ARGUMENT, sightcell_geometry_hash(positions.data(), 11, 3, triangle.data(), 3, &hash));
  RETURNS(ERR_ARGUMENT, sightcell_geometry_hash(positions.data(), 12, 3, triangle.data(), 2, &hash));
}

void names(outcomes& out) {
  sample_contents contents = tiny_contents();
  contents.named_groups = {"door"};
  contents.draws[0].named_group = 0;
  const loaded_file file(contents);
  const test_view view(file.db());
  std::array<char, 4> name;
  std::array<std::uint32_t, 1> groups;
  std::uint32_t found = 0;
  std::size_t count = 0;
  ASSERT_EQ(contents.draws.size(), groups.size());
  RETURNS(OK, sightcell_db_named_group_name(file.db(), 0, name.data(), 4, &count));
  RETURNS(ERR_CAPACITY, sightcell_db_named_group_name(file.db(), 0, name.data(), 3, &count));
  RETURNS(ERR_ARGUMENT, sightcell_db_named_group_name(file.db(), 1, name.data(), 4, &count));
  RETURNS(OK, sightcell_db_find_named_group(file.db(), "door", &found));
  RETURNS(ERR_ARGUMENT, sightcell_db_find_named_group(file.db(), nullptr, &found));
  RETURNS(OK, sightcell_db_named_groups_of_draws(file.db(), groups.data(), 1, &count));
  RETURNS(ERR_CAPACITY, sightcell_db_named_groups_of_draws(file.db(), groups.data(), 0, &count));
  RETURNS(ERR_ARGUMENT, sightcell_db_named_groups_of_draws(file.db(), groups.data(), 1, nullptr));
  RETURNS(OK, sightcell_view_show_named_group(view.get(), 0, 0));
  RETURNS(ERR_ARGUMENT, sightcell_view_show_named_group(view.get(), 1, 0));
}

void places(outcomes& out) {
  const loaded_file file(tiny_contents());
  sightcell_view* view = nullptr;
  RETURNS(OK, sightcell_view_create(file.db(), &view));
  RETURNS(ERR_ARGUMENT, sightcell_view_create(file.db(), nullptr));
  const float inside[3] = {1, 1, 1};  // of the first cell
  const float beyond[3] = {9, 1, 1};  // nearer to the second
  const float nowhere[3] = {1, std::nanf(""), 1};
  sightcell_frame frame;
  RETURNS(ERR_ARGUMENT, sightcell_view_move(view, nowhere, &frame));
  RETURNS(ERR_ARGUMENT, sightcell_view_move_box(view, beyond, inside, &frame));
  for (const std::uint32_t policy : {SIGHTCELL_OUTSIDE_ALL, SIGHTCELL_OUTSIDE_NEAREST, SIGHTCELL_OUTSIDE_LAST}) {
    RETURNS(OK, sightcell_view_policy(view, policy, 5.0f));
    RETURNS(OK, sightcell_view_move(view, inside, &frame));
    out.frame_flags |= frame.flags;
    EXPECT_EQ(frame.cell, 0u);
    RETURNS(OK, sightcell_view_move_box(view, beyond, beyond, &frame));
    out.frame_flags |= frame.flags;
    EXPECT_EQ(frame.cell, SIGHTCELL_NO_CELL);
    out.polygons_outside[policy] = frame.polygon_count;
  }
  RETURNS(OK, sightcell_view_policy(view, SIGHTCELL_PENDING_LAST, 5.0f));  // paging_test has what it does
  RETURNS(ERR_ARGUMENT, sightcell_view_policy(view, SIGHTCELL_OUTSIDE_LAST + 1, 5.0f));
  const double origin[3] = {1, 2, 3};
  const double endless[3] = {1, 2, HUGE_VAL};
  RETURNS(OK, sightcell_view_origin(view, origin));
  RETURNS(ERR_ARGUMENT, sightcell_view_origin(view, endless));
  sightcell_view_destroy(view);
}

// One mesh of 100,000 polygons, 15,000 times. The writer would take gigabytes for it, so only the tables are that
// large.
void more_polygons_than_commands_can_number(outcomes& out) {
  constexpr std::uint32_t of_mesh = 100'000;
  sample_contents contents = tiny_contents();
  contents.cells.clear();
  contents.sets.clear();
  contents.draws.clear();
  const auto add_draws_of = [&contents](std::uint32_t polygons) {
    contents.draws.clear();
    for (std::uint32_t d = 0; d < 15'000; ++d) {
      const std::uint32_t first = polygons * d;
      contents.draws.push_back({.node = d, .first_source = first, .polygon_count = polygons, .first_stored = first});
    }
  };
  add_draws_of(1);
  contents.facts.polygon_count = 15'000;
  contents.order_of_draw.assign(15'000, 0);
  contents.orders = {{0}};
  bytes file = contents.encode();
  add_draws_of(of_mesh);
  contents.orders[0] = all_polygons(of_mesh);
  bytes orders;
  sightcell::format::put_orders(contents.orders, orders);
  set_u32(file, layout::header_polygon_count, 15'000 * of_mesh);
  file = with_section(file, layout::section_draws,
                      sightcell::format::encode_draws(contents.draws, contents.order_of_draw));
  const loaded_file many(with_section(file, layout::section_orders, orders));
  const test_view view(many.db());
  std::size_t count = 0;
  RETURNS(ERR_LIMIT, sightcell_view_commands(view.get(), 0, nullptr, sizeof(sightcell_command), 0, &count));
}

void lists(outcomes& out) {
  const loaded_file file(tiny_contents());
  test_view view(file.db());
  const auto* const v = view.get();
  static_cast<void>(view.move(5, 1, 1));
  static_cast<void>(view.move(1, 1, 1));  // polygons 0, 1, 2 and 4 instead of 5
  std::array<std::uint32_t, 4> ids;
  std::array<sightcell_range, 2> ranges;
  std::array<sightcell_range, 2> others;
  std::array<std::uint32_t, 18> stored{};
  std::array<std::uint32_t, 12> indices;
  std::array<sightcell_command, 2> commands;
  constexpr std::size_t stride = sizeof(sightcell_command);
  std::uint64_t bits = 0;
  std::size_t count = 0;
  std::size_t other = 0;
  RETURNS(OK, sightcell_view_polygons(v, ids.data(), 4, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_polygons(v, ids.data(), 3, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_polygons(v, nullptr, 4, &count));
  RETURNS(OK, sightcell_view_ranges(v, ranges.data(), 2, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_ranges(v, ranges.data(), 1, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_ranges(v, nullptr, 2, &count));
  RETURNS(OK, sightcell_view_indices(v, stored.data(), indices.data(), 12, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_indices(v, stored.data(), indices.data(), 11, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_indices(v, nullptr, indices.data(), 12, &count));
  RETURNS(OK, sightcell_view_commands(v, 0, commands.data(), stride, 2, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_commands(v, 0, commands.data(), stride, 1, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_commands(v, 0, commands.data(), stride - 1, 2, &count));
  RETURNS(OK, sightcell_view_objects(v, &bits, 1));
  RETURNS(ERR_CAPACITY, sightcell_view_objects(v, &bits, 0));
  RETURNS(ERR_ARGUMENT, sightcell_view_objects(v, nullptr, 1));
  RETURNS(OK, sightcell_view_changes(v, 1, ranges.data(), 2, &count, others.data(), 2, &other));
  RETURNS(ERR_CAPACITY, sightcell_view_changes(v, 1, ranges.data(), 1, &count, others.data(), 2, &other));
  RETURNS(ERR_STALE, sightcell_view_changes(v, 0, ranges.data(), 2, &count, others.data(), 2, &other));
  RETURNS(ERR_ARGUMENT, sightcell_view_changes(v, 1, nullptr, 2, &count, others.data(), 2, &other));
  sightcell_view_stats stats{};
  RETURNS(ERR_ARGUMENT, sightcell_view_statistics(v, &stats));
  stats.struct_size = sizeof stats;
  RETURNS(OK, sightcell_view_statistics(v, &stats));
  more_polygons_than_commands_can_number(out);
}

void clusters(outcomes& out) {
  few_blocks three(3);
  const loaded_file file(tiny_contents().encode(), &three.interface);
  test_view view(file.db());
  static_cast<void>(view.move(1, 1, 1));  // polygons 0, 1, 2 and 4
  const std::array<std::uint32_t, 6> table{0, 0, 1, 2, 2, 3};
  sightcell_cluster_map* map = nullptr;
  RETURNS(ERR_ARGUMENT, sightcell_cluster_map_create(file.db(), table.data(), 6, 3, &map));
  RETURNS(OK, sightcell_cluster_map_create(file.db(), table.data(), 6, 4, &map));
  sightcell_cluster_map* none = nullptr;
  RETURNS(ERR_MEMORY, sightcell_cluster_map_create(file.db(), table.data(), 6, 4, &none));
  std::uint32_t bits = 0;
  const std::uint32_t before = 1;
  RETURNS(OK, sightcell_view_clusters(view.get(), map, &bits, 1));
  EXPECT_EQ(bits, 7u);
  RETURNS(ERR_CAPACITY, sightcell_view_clusters(view.get(), map, &bits, 0));
  RETURNS(ERR_ARGUMENT, sightcell_view_clusters(view.get(), map, nullptr, 1));
  std::array<std::uint32_t, 3> list;
  sightcell_cluster_word word;
  std::size_t count = 0;
  RETURNS(OK, sightcell_cluster_list(&bits, 1, list.data(), 3, &count));
  RETURNS(ERR_CAPACITY, sightcell_cluster_list(&bits, 1, list.data(), 2, &count));
  RETURNS(ERR_ARGUMENT, sightcell_cluster_list(nullptr, 1, list.data(), 3, &count));
  RETURNS(OK, sightcell_cluster_changes(&before, &bits, 1, &word, 1, &count));
  RETURNS(ERR_CAPACITY, sightcell_cluster_changes(&before, &bits, 1, &word, 0, &count));
  RETURNS(ERR_ARGUMENT, sightcell_cluster_changes(&before, nullptr, 1, &word, 1, &count));
  sightcell_cluster_map_destroy(map);
}

void shadow_casters(outcomes& out) {
  few_blocks three(3);
  const sample_contents contents = tiny_contents();
  const bytes whole = with_casters(contents.encode(), sample_casters(contents));
  const loaded_file file(whole, &three.interface);
  test_view view(file.db());
  static_cast<void>(view.move(1, 1, 1));
  sightcell_casters* casters = nullptr;
  RETURNS(ERR_ARGUMENT, sightcell_casters_create(nullptr, &casters));
  RETURNS(OK, sightcell_casters_create(file.db(), &casters));
  sightcell_casters* none = nullptr;
  RETURNS(ERR_MEMORY, sightcell_casters_create(file.db(), &none));
  const loaded_file without(contents);
  RETURNS(ERR_ABSENT, sightcell_casters_create(without.db(), &none));
  bytes changed = whole;
  changed[section_offset(whole, layout::section_casters)] ^= std::byte{2};  // no sun
  const loaded_file wrong_sum(changed);
  RETURNS(ERR_CHECKSUM, sightcell_casters_create(wrong_sum.db(), &none));
  reseal(changed);
  const loaded_file corrupt(std::move(changed));
  RETURNS(ERR_CORRUPT, sightcell_casters_create(corrupt.db(), &none));
  std::array<sightcell_sun, 2> suns;
  std::array<sightcell_range, 6> ranges;
  std::array<std::uint32_t, 18> indices{};
  std::array<std::uint32_t, 18> drawn;
  std::size_t count = 0;
  RETURNS(OK, sightcell_casters_suns(casters, suns.data(), 2, &count));
  RETURNS(ERR_CAPACITY, sightcell_casters_suns(casters, suns.data(), 1, &count));
  RETURNS(ERR_ARGUMENT, sightcell_casters_suns(nullptr, suns.data(), 2, &count));
  RETURNS(OK, sightcell_view_casters(view.get(), casters, 1, ranges.data(), 6, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_casters(view.get(), casters, 1, ranges.data(), 0, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_casters(view.get(), casters, 2, ranges.data(), 6, &count));
  RETURNS(OK, sightcell_view_caster_indices(view.get(), casters, 0, indices.data(), drawn.data(), 18, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_caster_indices(view.get(), casters, 0, indices.data(), drawn.data(), 3, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_caster_indices(view.get(), casters, 0, nullptr, drawn.data(), 18, &count));
  sightcell_casters_destroy(casters);
}

void boxes(outcomes& out) {
  sample_contents contents = tiny_contents();
  add_volumes(contents, 4, 3);
  contents.sets = {{0, 6}, {5, 7}};
  add_viewpoints(contents, 4);
  contents.viewpoints[0].region = packed_nodes("201");
  const loaded_file file(contents);
  test_view view(file.db());
  const auto* const v = view.get();
  static_cast<void>(view.move(1, 1, 1));
  const float low[3] = {0, 0, 0};
  const float high[3] = {1, 1, 1};
  std::uint32_t visible = 0;
  RETURNS(OK, sightcell_view_box_visible(v, low, high, &visible));
  RETURNS(ERR_ARGUMENT, sightcell_view_box_visible(v, high, low, &visible));
  std::array<sightcell_debug_line, 60> lines;  // a box of each kind
  constexpr std::uint32_t every_kind = 0xFFFFFFFFu;
  std::size_t count = 0;
  RETURNS(OK, sightcell_view_debug_lines(v, every_kind, lines.data(), lines.size(), &count));
  ASSERT_EQ(count, lines.size());
  for (const sightcell_debug_line& line : lines) out.debug_kinds |= line.kind;
  RETURNS(ERR_CAPACITY, sightcell_view_debug_lines(v, every_kind, lines.data(), 59, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_debug_lines(v, every_kind, nullptr, 60, &count));
  bytes changed = contents.encode();
  const std::size_t place = section_place(changed, layout::section_viewpoints);
  const auto regions = section_of(changed, layout::section_viewpoints).size() - contents.viewpoints[0].region.size() -
                       contents.viewpoints[1].region.size();
  changed[get_u64(changed, place + 8) + regions] = std::byte{3};  // no node
  reseal(changed);
  const loaded_file damaged(std::move(changed));
  test_view other(damaged.db());
  static_cast<void>(other.move(1, 1, 1));
  RETURNS(ERR_CORRUPT, sightcell_view_debug_lines(other.get(), every_kind, lines.data(), lines.size(), &count));
}

void importance(outcomes& out) {
  const bytes whole = with_importance(tiny_contents().encode(), sample_class);
  const std::size_t section = section_offset(whole, layout::section_importance);
  bytes changed = whole;
  changed[section] ^= std::byte{1};  // the checksum of the section
  bytes torn = whole;                // no codes, with the right checksums
  for (std::size_t at = section + 4 + 16; at < torn.size(); ++at) torn[at] = std::byte{0xFF};
  reseal_importance(torn);
  const loaded_file good(whole), plain(tiny_contents()), damaged(std::move(changed)), corrupt(std::move(torn));
  std::array<float, 1> values;
  std::size_t count = 0;
  const auto ask = [&](const loaded_file& file, float x, sightcell_status expected, std::size_t capacity) {
    test_view view(file.db());
    static_cast<void>(view.move(x, 1, 1));
    out.note("sightcell_view_importance(...)", expected,
             sightcell_view_importance(view.get(), values.data(), capacity, &count));
  };
  ask(good, 1, SIGHTCELL_OK, 1);
  ask(good, 1, SIGHTCELL_ERR_CAPACITY, 0);
  ask(good, -100, SIGHTCELL_ERR_STALE, 1);
  ask(plain, 1, SIGHTCELL_ERR_ABSENT, 1);
  ask(damaged, 1, SIGHTCELL_ERR_CHECKSUM, 1);
  ask(corrupt, 1, SIGHTCELL_ERR_CORRUPT, 1);
  RETURNS(ERR_ARGUMENT, sightcell_view_importance(nullptr, values.data(), 1, &count));
}

TEST(every_outcome, is_reached) {
  outcomes out;
  open_from_memory(out);
  open_from_disk(out);
  open_from_a_source(out);
  open_without_waiting(out);
  deliver_and_prefetch(out);
  facts(out);
  eyes(out);
  identities(out);
  names(out);
  places(out);
  lists(out);
  clusters(out);
  shadow_casters(out);
  boxes(out);
  importance(out);

  const header there = read_headers();
  ASSERT_GT(there.functions.size(), 20u);
  ASSERT_GT(there.enumerators.size(), 20u);
  for (const std::string& name : there.functions) {
    EXPECT_TRUE(promised.contains(name)) << name << " has no row";
  }
  EXPECT_EQ(there.functions.size(), promised.size());
  statuses all;
  for (const auto& [name, expected] : promised) {
    EXPECT_EQ(out.of_function[name], expected) << name;
    all = all + out.of_function[name];
  }
  std::map<std::string, int> families;
  for (const auto& [name, value] : there.enumerators) {
    const auto is = [&, &of = name](const char* family) { return of.starts_with(family) && ++families[family] > 0; };
    if (is("FRAME_")) {
      EXPECT_NE(out.frame_flags & value, 0u) << name;
    } else if (is("DEBUG_")) {
      EXPECT_NE(out.debug_kinds & value, 0u) << name;
    } else if (is("OUTSIDE_")) {
      EXPECT_TRUE(out.polygons_outside.contains(value)) << name;
    } else if (is("PENDING_")) {
      EXPECT_EQ(value, static_cast<std::uint32_t>(SIGHTCELL_PENDING_LAST)) << name;
    } else {
      const auto status = static_cast<sightcell_status>(value);
      EXPECT_TRUE(all.contains(status)) << name;
    }
  }
  EXPECT_EQ(families.size(), 4u) << "the header is read as it is written";
  const std::map<std::uint32_t, std::uint32_t> outside{
      {SIGHTCELL_OUTSIDE_ALL, 6}, {SIGHTCELL_OUTSIDE_NEAREST, 1}, {SIGHTCELL_OUTSIDE_LAST, 4}};
  EXPECT_EQ(out.polygons_outside, outside);
}

}  // namespace
