// What a file knows: facts, valid viewpoints, identity and names of draws, named groups.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "golden/damaged_file.h"
#include "loaded_file.h"
#include "outcome_calls.h"
#include "paged_host.h"
#include "sightcell/format/layout.h"
#include "sightcell/identity.h"
#include "sightcell/viewpoints.h"
#include "unit/format/viewpoint_samples.h"

namespace sightcell::test {
namespace {

namespace layout = sightcell::format::layout;
using bytes = std::vector<std::byte>;

}  // namespace

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

  std::array<float, 67> bounds;
  RETURNS(OK, sightcell_db_error_bounds(db, bounds.data(), bounds.size(), &count));
  RETURNS(ERR_CAPACITY, sightcell_db_error_bounds(db, bounds.data(), 66, &count));
  RETURNS(ERR_ARGUMENT, sightcell_db_error_bounds(db, nullptr, 67, &count));
  sample_contents unproved = tiny_contents();
  unproved.certificate.clear();
  const loaded_file without(unproved);
  RETURNS(ERR_ABSENT, sightcell_db_error_bounds(without.db(), bounds.data(), bounds.size(), &count));

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

}  // namespace sightcell::test
