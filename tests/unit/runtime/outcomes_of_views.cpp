// What a view answers: cells, lists, clusters, boxes, importance.
#include <array>
#include <cmath>
#include <vector>

#include "golden/damaged_file.h"
#include "loaded_file.h"
#include "outcome_calls.h"
#include "paged_host.h"
#include "polygon_orders_writer.h"
#include "sightcell/casters.h"
#include "sightcell/clusters.h"
#include "sightcell/format/layout.h"
#include "sightcell/lights.h"
#include "sightcell/residency.h"
#include "table_encoder.h"
#include "unit/format/caster_samples.h"
#include "unit/format/importance_samples.h"
#include "unit/format/light_samples.h"
#include "unit/format/residency_samples.h"
#include "unit/format/viewpoint_samples.h"

namespace sightcell::test {
namespace {

namespace layout = sightcell::format::layout;
using bytes = std::vector<std::byte>;

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

}  // namespace

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
  RETURNS(ERR_ARGUMENT, sightcell_view_policy(view, SIGHTCELL_OUTSIDE_LAST + 1, 5.0f));
  const double origin[3] = {1, 2, 3};
  const double endless[3] = {1, 2, HUGE_VAL};
  RETURNS(OK, sightcell_view_origin(view, origin));
  RETURNS(ERR_ARGUMENT, sightcell_view_origin(view, endless));
  sightcell_view_destroy(view);
}

// Whether the last set is kept while another one is on its way, with each policy.
void sets_while_pending(outcomes& out) {
  const sample_contents contents = random_contents(91, {.polygons = 900, .draws = 20, .cells = 512});
  for (const std::uint32_t policy : {0u, static_cast<std::uint32_t>(SIGHTCELL_PENDING_LAST)}) {
    paged_host host(contents.encode());
    EXPECT_EQ(host.open(1 << 20), SIGHTCELL_OK);
    test_view view(host.db());
    RETURNS(OK, sightcell_view_policy(view.get(), policy, 1e6f));
    const auto go_to = [&](const auto& cell) {
      return view.move((cell.min[0] + cell.max[0]) / 2, (cell.min[1] + cell.max[1]) / 2,
                       (cell.min[2] + cell.max[2]) / 2);
    };
    static_cast<void>(go_to(contents.cells.front()));
    host.deliver_all();
    static_cast<void>(go_to(contents.cells.front()));
    const sightcell_frame frame = go_to(contents.cells.back());
    EXPECT_NE(frame.flags & SIGHTCELL_FRAME_PENDING, 0u);
    if ((frame.flags & SIGHTCELL_FRAME_DRAW_ALL) == 0) out.kept_while_pending.insert(policy);
  }
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

void clusters_of_files(outcomes& out) {
  sightcell_cluster_map* map = nullptr;
  std::array<sightcell_range, 3> list;
  std::size_t count = 0;
  const loaded_file of_polygons(tiny_contents());
  RETURNS(ERR_ABSENT, sightcell_cluster_map_of_file(of_polygons.db(), &map));
  RETURNS(ERR_ARGUMENT, sightcell_cluster_map_of_file(nullptr, &map));
  sample_contents contents = tiny_contents();
  contents.orders = {{0, 1, 2, 3, 4, 5}};
  contents.order_of_draw = {0};
  contents.clusters = {{3, 1, 2}};
  few_blocks two(2);
  const loaded_file file(contents.encode(), &two.interface);
  EXPECT_EQ(sightcell_db_cluster_count(file.db()), 3u);
  RETURNS(OK, sightcell_db_clusters(file.db(), list.data(), 3, &count));
  EXPECT_TRUE(list[2].draw == 0 && list[2].first == 4 && list[2].count == 2);
  RETURNS(ERR_CAPACITY, sightcell_db_clusters(file.db(), list.data(), 2, &count));
  RETURNS(ERR_ARGUMENT, sightcell_db_clusters(nullptr, list.data(), 3, &count));
  RETURNS(OK, sightcell_cluster_map_of_file(file.db(), &map));
  sightcell_cluster_map* none = nullptr;
  RETURNS(ERR_MEMORY, sightcell_cluster_map_of_file(file.db(), &none));
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

void lamps(outcomes& out) {
  few_blocks three(3);
  const sample_contents contents = tiny_contents();
  const bytes whole = with_lights(contents.encode(), sample_lights(contents));
  const loaded_file file(whole, &three.interface);
  test_view view(file.db());
  static_cast<void>(view.move(1, 1, 1));
  sightcell_lights* lights = nullptr;
  RETURNS(ERR_ARGUMENT, sightcell_lights_create(nullptr, &lights));
  RETURNS(OK, sightcell_lights_create(file.db(), &lights));
  sightcell_lights* none = nullptr;
  RETURNS(ERR_MEMORY, sightcell_lights_create(file.db(), &none));
  const loaded_file without(contents);
  RETURNS(ERR_ABSENT, sightcell_lights_create(without.db(), &none));
  bytes changed = whole;
  changed[section_offset(whole, layout::section_lights) + 4] ^= std::byte{64};  // more runs than polygons
  const loaded_file wrong_sum(changed);
  RETURNS(ERR_CHECKSUM, sightcell_lights_create(wrong_sum.db(), &none));
  reseal(changed);
  const loaded_file corrupt(std::move(changed));
  RETURNS(ERR_CORRUPT, sightcell_lights_create(corrupt.db(), &none));
  std::array<sightcell_light, 10> list;
  std::array<sightcell_range, 6> ranges;
  std::array<std::uint32_t, 18> indices{};
  std::array<std::uint32_t, 18> drawn;
  std::size_t count = 0;
  RETURNS(OK, sightcell_lights_list(lights, list.data(), 10, &count));
  RETURNS(ERR_CAPACITY, sightcell_lights_list(lights, list.data(), 9, &count));
  RETURNS(ERR_ARGUMENT, sightcell_lights_list(nullptr, list.data(), 10, &count));
  RETURNS(OK, sightcell_view_lights(view.get(), lights, drawn.data(), 10, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_lights(view.get(), lights, nullptr, 0, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_lights(view.get(), nullptr, drawn.data(), 10, &count));
  RETURNS(OK, sightcell_view_light_ranges(view.get(), lights, 9, ranges.data(), 6, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_light_ranges(view.get(), lights, 9, ranges.data(), 0, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_light_ranges(view.get(), lights, 10, ranges.data(), 6, &count));
  RETURNS(OK, sightcell_view_light_indices(view.get(), lights, 9, indices.data(), drawn.data(), 18, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_light_indices(view.get(), lights, 9, indices.data(), drawn.data(), 3, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_light_indices(view.get(), lights, 9, nullptr, drawn.data(), 18, &count));
  sightcell_lights_destroy(lights);
}

void residencies(outcomes& out) {
  few_blocks three(3);
  const sample_contents contents = tiny_contents();
  const bytes whole = with_residency(contents.encode(), sample_residency(contents));
  const loaded_file file(whole, &three.interface);
  test_view view(file.db());
  static_cast<void>(view.move(1, 1, 1));
  sightcell_residency* residency = nullptr;
  RETURNS(ERR_ARGUMENT, sightcell_residency_create(nullptr, &residency));
  RETURNS(OK, sightcell_residency_create(file.db(), &residency));
  sightcell_residency* none = nullptr;
  RETURNS(ERR_MEMORY, sightcell_residency_create(file.db(), &none));
  const loaded_file without(contents);
  RETURNS(ERR_ABSENT, sightcell_residency_create(without.db(), &none));
  bytes changed = whole;
  changed[section_offset(whole, layout::section_residency)] ^= std::byte{2};  // another number of textures
  const loaded_file wrong_sum(changed);
  RETURNS(ERR_CHECKSUM, sightcell_residency_create(wrong_sum.db(), &none));
  reseal(changed);
  const loaded_file corrupt(std::move(changed));
  RETURNS(ERR_CORRUPT, sightcell_residency_create(corrupt.db(), &none));
  std::array<sightcell_texture, 3> textures;
  std::array<std::uint8_t, 3> levels;
  std::size_t count = 0;
  RETURNS(OK, sightcell_residency_textures(residency, textures.data(), 3, &count));
  RETURNS(ERR_CAPACITY, sightcell_residency_textures(residency, textures.data(), 2, &count));
  RETURNS(ERR_ARGUMENT, sightcell_residency_textures(nullptr, textures.data(), 3, &count));
  RETURNS(OK, sightcell_view_texture_levels(view.get(), residency, 900.0f, levels.data(), 3, &count));
  RETURNS(ERR_CAPACITY, sightcell_view_texture_levels(view.get(), residency, 900.0f, levels.data(), 2, &count));
  RETURNS(ERR_ARGUMENT, sightcell_view_texture_levels(view.get(), residency, 0.0f, levels.data(), 3, &count));
  RETURNS(OK, sightcell_residency_cell_levels(residency, 1, 900.0f, levels.data(), 3, &count));
  RETURNS(ERR_CAPACITY, sightcell_residency_cell_levels(residency, 1, 900.0f, nullptr, 0, &count));
  RETURNS(ERR_ARGUMENT, sightcell_residency_cell_levels(residency, 2, 900.0f, levels.data(), 3, &count));
  sightcell_residency_destroy(residency);
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

}  // namespace sightcell::test
