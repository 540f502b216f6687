// Contents of every kind are read as they were written: by the reader, by the classes for tools and by the runtime.
// SIGHTCELL_TEST_ROUNDS: the number of contents (300); SIGHTCELL_TEST_SEED: the seed of the first one (1).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <set>
#include <span>

#include "any_contents.h"
#include "cluster_samples.h"
#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"
#include "unit/case_step.h"
#include "unit/runtime/loaded_file.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;
using numbers = std::vector<std::uint32_t>;

constexpr std::uint32_t usual_rounds = 300;

std::uint32_t number_in_environment(const char* name, std::uint32_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

// Counts each kind, so that a missing one is noticed.
struct kinds_met {
  std::uint32_t merged = 0, on_lattice = 0, on_grid = 0, shared_orders = 0, source_orders = 0, moving = 0,
                no_polygons = 0;
  std::uint32_t own = 0, first_differences = 0, second_differences = 0, shared_rows = 0;
  std::uint32_t empty_sets = 0, full_sets = 0, sets_of_one = 0, widened_sets = 0, chunks = 0, overlapping = 0;
  std::uint32_t volumes = 0, from_polygons_on = 0, widened_with_volumes = 0, small_chunks = 0;
  std::uint32_t in_clusters = 0, widened_by_clusters = 0;
};

void expect_facts(const any_contents& in, const reader& file) {
  const file_facts& facts = file.facts();
  EXPECT_EQ(facts.polygon_count, in.facts.polygon_count);
  EXPECT_EQ(facts.layout, in.facts.layout);
  EXPECT_EQ(facts.margin, in.facts.margin);
  EXPECT_EQ(facts.max_pixel_error, in.facts.max_pixel_error);
  EXPECT_EQ(facts.confidence, in.facts.confidence);
  EXPECT_EQ(facts.repeatable, in.facts.repeatable);
  EXPECT_EQ(facts.scene_fingerprint, in.facts.scene_fingerprint);
  EXPECT_EQ(file.settings(), in.settings);
  ASSERT_EQ(file.certificate_count(), in.certificate.size());
  for (std::uint32_t i = 0; i < file.certificate_count(); ++i) {
    certificate_record c;
    ASSERT_EQ(file.certificate(i, c), status::ok);
    const certificate_record& given = in.certificate[i];
    EXPECT_TRUE(c.cell == given.cell && c.rays == given.rays && c.misses == given.misses && c.seed == given.seed) << i;
    EXPECT_TRUE(c.upper_bound == given.upper_bound && c.confidence == given.confidence) << i;
  }
}

void expect_viewpoints(const any_contents& in, const reader& file) {
  ASSERT_EQ(file.viewpoints().exists(), !in.viewpoints.empty());
  if (in.viewpoints.empty()) return;
  EXPECT_EQ(file.viewpoints().player_radius(), in.player_radius);
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    const viewpoint_record& given = in.viewpoints[cell];
    EXPECT_EQ(file.viewpoints().valid_share(cell), given.valid_share) << cell;
    EXPECT_EQ(static_cast<double>(file.viewpoints().outside_share(cell)), given.outside_share) << cell;
    const auto region = file.viewpoints().region_bytes(cell);
    EXPECT_TRUE(std::equal(region.begin(), region.end(), given.region.begin(), given.region.end())) << cell;
  }
}

bool same_draw(const draw_record& a, const draw_record& b) {
  return a.node == b.node && a.mesh == b.mesh && a.primitive == b.primitive && a.instance == b.instance &&
         a.material == b.material && a.group == b.group && a.first_source == b.first_source &&
         a.polygon_count == b.polygon_count && a.first_stored == b.first_stored && a.base_vertex == b.base_vertex &&
         a.host_tag == b.host_tag && a.flags == b.flags && a.named_group == b.named_group;
}

void expect_draws_and_orders(const any_contents& in, const reader& file) {
  ASSERT_EQ(file.draw_count(), in.draws.size());
  for (std::uint32_t i = 0; i < file.draw_count(); ++i) {
    draw_record d;
    ASSERT_EQ(file.draw(i, d), status::ok);
    EXPECT_TRUE(same_draw(d, in.draws[i])) << i;
    EXPECT_EQ(file.order_of_draw(i), in.order_of_draw[i]) << i;
  }
  ASSERT_EQ(file.named_groups().count(), in.named_groups.size());
  for (std::uint32_t i = 0; i < in.named_groups.size(); ++i) {
    std::string_view name;
    EXPECT_TRUE(file.named_groups().name(i, name) && name == in.named_groups[i]) << i;
  }
  numbers all(file.order_begin(file.order_count()));
  ASSERT_EQ(file.orders(all), status::ok);
  ASSERT_EQ(file.order_count(), in.orders.size());
  numbers expected;
  for (std::uint32_t number = 0; number < in.orders.size(); ++number) {
    EXPECT_EQ(file.order_begin(number), expected.size());
    expected.insert(expected.end(), in.orders[number].begin(), in.orders[number].end());
  }
  EXPECT_EQ(all, expected);
  numbers sources(file.polygon_count());
  ASSERT_EQ(file.source_of_stored(sources), status::ok);
  EXPECT_EQ(sources, in.source_of_stored);
  ASSERT_EQ(file.range_unit_count() + 1, in.unit_begins.size());
  for (std::uint32_t unit = 0; unit < in.unit_begins.size(); ++unit) {
    EXPECT_EQ(file.range_unit_begin(unit), in.unit_begins[unit]);
  }
}

void expect_cells(const any_contents& in, const reader& file) {
  ASSERT_EQ(file.cell_count(), in.sets.size());
  ASSERT_EQ(file.lattice() != nullptr, in.lattice.has_value());
  if (in.lattice) {
    EXPECT_EQ(file.lattice()->shape().width, in.lattice->width);
    EXPECT_EQ(file.lattice()->shape().height, in.lattice->height);
  }
  ASSERT_EQ(file.grid() != nullptr, in.grid.has_value());
  if (in.grid) {
    EXPECT_EQ(file.grid()->step().width, in.grid->width);
    EXPECT_EQ(file.grid()->step().height, in.grid->height);
  }
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    box b;
    ASSERT_EQ(file.cell_box(cell, b), status::ok);
    EXPECT_TRUE(b.min == in.cells[cell].min && b.max == in.cells[cell].max) << cell;
  }
}

void expect_volumes(const any_contents& in, const reader& file) {
  ASSERT_EQ(file.volumes().count(), in.volumes.size());
  if (in.volumes.empty()) return;
  EXPECT_EQ(file.volumes().shape().width, in.volume_shape.width);
  EXPECT_EQ(file.volumes().shape().height, in.volume_shape.height);
  for (std::uint32_t volume = 0; volume < file.volumes().count(); ++volume) {
    box b;
    lattice_place p;
    ASSERT_TRUE(file.volumes().place(volume, p));
    ASSERT_TRUE(file.volumes().volume_box(volume, b));
    const lattice_place& given = in.volumes[volume];
    const box expected = box_of(in.volume_shape, given);
    EXPECT_TRUE(p.x == given.x && p.y == given.y && p.z == given.z && p.level == 0) << volume;
    EXPECT_TRUE(b.min == expected.min && b.max == expected.max) << volume;
  }
}

// The set of a cell by the reader alone, in memory with other contents before.
numbers stored_set(const reader& file, std::uint32_t cell, std::uint64_t& runs, std::uint64_t& ranges) {
  std::vector<std::uint64_t> code_memory(file.codes_size() / 8 + 1);
  std::vector<std::uint32_t> scratch(file.scratch_size() / 4 + 1, 0xAAAAAAAAu);
  std::vector<run> row(file.run_bound(), run{7, 7});
  const row_codes* codes = nullptr;
  EXPECT_EQ(file.make_codes(std::as_writable_bytes(std::span(code_memory)), codes), status::ok);
  std::size_t count = 0;
  EXPECT_EQ(file.decode_row(cell, codes, row, std::as_writable_bytes(std::span(scratch)), count), status::ok);
  numbers polygons;
  std::uint64_t next = 0;
  for (const run& r : std::span(row).first(count)) {
    EXPECT_TRUE(r.count > 0 && r.first >= next) << "runs ascend and do not touch";
    next = std::uint64_t{r.first} + r.count + 1;
    for (std::uint32_t i = 0; i < r.count; ++i) polygons.push_back(r.first + i);
  }
  runs = count;
  ranges = file.count_ranges(std::span(row).first(count));
  return polygons;
}

// Counts the runs inside each draw or draw group, one polygon at a time.
std::uint64_t ranges_of(const any_contents& in, const numbers& stored) {
  std::uint64_t ranges = 0;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const bool follows = i > 0 && stored[i] == stored[i - 1] + 1;
    const bool begins = std::binary_search(in.unit_begins.begin(), in.unit_begins.end(), stored[i]);
    ranges += follows && !begins ? 0 : 1;
  }
  return ranges;
}

// All ascending.
struct read_sets {
  std::vector<numbers> stored;  // polygons
  std::vector<numbers> ids;     // source ids
  std::vector<numbers> items;   // source ids and volumes
};

// The volumes of a cell: its items without the polygons. Counts their runs, and whether the first one continues the run
// of the last polygons.
std::uint64_t expect_volumes_of(set_reader& sets, std::uint32_t cell, const numbers& stored, const numbers& items,
                                bool& from_polygons_on) {
  row_parts parts;
  EXPECT_EQ(sets.parts(cell, parts), status::ok);
  const std::uint32_t polygons = sets.file().polygon_count();
  numbers read, volumes;
  std::uint64_t next = 0;
  for (const run& r : parts.volumes) {
    EXPECT_TRUE(r.count > 0 && r.first >= next) << "runs ascend and do not touch";
    next = std::uint64_t{r.first} + r.count + 1;
    for (std::uint32_t i = 0; i < r.count; ++i) read.push_back(r.first + i);
  }
  std::uint64_t in_runs = 0;
  for (const run& r : parts.polygons) in_runs += r.count;
  EXPECT_EQ(in_runs, stored.size());
  for (const std::uint32_t item : items) {
    if (item >= polygons) volumes.push_back(item - polygons);
  }
  EXPECT_EQ(read, volumes) << cell;
  from_polygons_on = !stored.empty() && stored.back() + 1 == polygons && !read.empty() && read.front() == 0;
  return parts.volumes.size();
}

// All sets, which must be equal through all classes.
read_sets expect_sets_agree(const any_contents& in, const reader& file) {
  read_sets out;
  set_reader sets;
  EXPECT_EQ(sets.open(file), status::ok);
  EXPECT_EQ(sets.check(), status::ok);
  std::uint64_t most_runs = 0;
  std::uint64_t most_ranges = 0;
  row_statistics expected;
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    std::uint64_t ranges = 0;
    std::span<const run> runs;
    EXPECT_EQ(sets.source_ids(cell, out.ids.emplace_back()), status::ok);
    EXPECT_EQ(sets.item_ids(cell, out.items.emplace_back()), status::ok);
    EXPECT_EQ(sets.runs(cell, runs), status::ok);
    numbers& stored = out.stored.emplace_back();
    const std::size_t polygon_runs = runs.size();
    for (const run& r : runs) {
      for (std::uint32_t i = 0; i < r.count; ++i) stored.push_back(r.first + i);
    }
    if (cell % 16 == 0) {
      std::uint64_t count = 0;
      EXPECT_EQ(stored_set(file, cell, count, ranges), stored) << cell;
      EXPECT_EQ(count, runs.size());
      EXPECT_EQ(ranges, ranges_of(in, stored));
    }
    numbers ids;
    for (const std::uint32_t polygon : stored) ids.push_back(in.source_of_stored.at(polygon));
    std::sort(ids.begin(), ids.end());
    EXPECT_EQ(out.ids.back(), ids) << cell;
    bool from_polygons_on = false;
    const std::uint64_t of_volumes = expect_volumes_of(sets, cell, stored, out.items.back(), from_polygons_on);
    most_runs = std::max<std::uint64_t>(most_runs, polygon_runs + of_volumes - (from_polygons_on ? 1 : 0));
    most_ranges = std::max(most_ranges, ranges_of(in, stored) + of_volumes);
    expected.runs += polygon_runs;
    expected.volume_runs += of_volumes;
    expected.volumes += out.items.back().size() - stored.size();
    expected.ranges += ranges_of(in, stored);
    expected.polygons += stored.size();
  }
  EXPECT_EQ(file.run_bound(), most_runs);
  EXPECT_EQ(file.range_bound(), most_ranges);
  row_statistics sums;
  EXPECT_EQ(sets.statistics(sums), status::ok);
  EXPECT_TRUE(sums.runs == expected.runs && sums.ranges == expected.ranges && sums.polygons == expected.polygons);
  EXPECT_TRUE(sums.volumes == expected.volumes && sums.volume_runs == expected.volume_runs);
  return out;
}

// The polygons of a set, or its clusters.
std::size_t columns_of(const any_contents& in, const numbers& cluster, const numbers& set) {
  std::set<std::uint32_t> columns;
  for (const std::uint32_t item : set) {
    if (item < in.facts.polygon_count) columns.insert(cluster.empty() ? item : cluster[item]);
  }
  return columns.size();
}

// Exact sets, or supersets within the budget; and the header has the slack of all together.
void expect_sets(const any_contents& in, const reader& file, const read_sets& out, kinds_met& met) {
  const double share = in.slack_to_add;
  const numbers cluster = in.clusters.empty() ? numbers() : cluster_of_source(in);
  std::uint64_t seen = 0;
  std::uint64_t held = 0;
  for (std::size_t cell = 0; cell < in.sets.size(); ++cell) {
    const numbers& exact = in.sets[cell];
    const numbers& read = out.items[cell];
    const auto volumes =
        static_cast<std::size_t>(exact.end() - std::lower_bound(exact.begin(), exact.end(), in.facts.polygon_count));
    const std::size_t columns = columns_of(in, cluster, exact);
    const std::size_t columns_read = columns_of(in, cluster, read);
    seen += columns;
    held += columns_read;
    met.widened_sets += read.size() > exact.size() ? 1 : 0;
    met.widened_by_clusters += columns_read > columns && !cluster.empty() ? 1 : 0;
    met.widened_with_volumes += read.size() > exact.size() && volumes > 0 ? 1 : 0;
    if (share == 0.0) {
      EXPECT_EQ(read, exact) << cell;
      continue;
    }
    EXPECT_TRUE(std::includes(read.begin(), read.end(), exact.begin(), exact.end())) << cell;
    EXPECT_LE(static_cast<double>(columns_read - columns), share * static_cast<double>(columns) + 1e-9) << cell;
    EXPECT_EQ(read.size() - out.ids[cell].size(), volumes) << "no volume is added";
  }
  const double added = seen == 0 ? 0.0 : static_cast<double>(held - seen) / static_cast<double>(seen);
  const double together = (1.0 + static_cast<double>(in.facts.slack)) * (1.0 + added) - 1.0;
  EXPECT_NEAR(static_cast<double>(file.facts().slack), together, 1e-7);
  EXPECT_GE(static_cast<double>(file.facts().slack), together - 1e-12) << "never rounded down";
}

// Decoding gives the same bytes, however often it is done and whatever the memory contains.
void expect_asking_makes_no_difference(const any_contents& in, const std::vector<std::byte>& bytes) {
  std::uint32_t passes = 0;
  std::uint32_t expected = 0;  // the lowest cell that may come next
  std::vector<bool> asked(in.sets.size(), false);
  file_contents all = in.contents_to_write();
  all.cell_sets.get = [&](std::uint32_t cell, numbers& set) {
    EXPECT_TRUE(set.empty());
    if (cell < expected) ++passes;
    expected = cell + 1;
    asked[cell] = true;
    set.reserve(in.sets[cell].size() + passes);
    for (const std::uint32_t id : in.sets[cell]) set.push_back(id);
    return status::ok;
  };
  std::vector<std::byte> again;
  EXPECT_EQ(encode(all, again), status::ok);
  EXPECT_TRUE(again == bytes);
  EXPECT_EQ(std::count(asked.begin(), asked.end(), false), 0);
}

// The parts that tools take out of a file make it again; with slack only if none is added a second time.
void expect_parts_make_the_file(const any_contents& in, const reader& file, const read_sets& sets,
                                const std::vector<std::byte>& bytes) {
  file_parts parts;
  ASSERT_EQ(take_apart(file, parts), status::ok);
  parts.chunk_bytes = in.chunk_bytes;
  std::vector<std::byte> again;
  ASSERT_EQ(encode(parts.contents(sets_of(sets.items)), again), status::ok);
  if (in.slack_to_add == 0.0) {
    EXPECT_TRUE(again == bytes);
    return;
  }
  reader second;
  ASSERT_EQ(reader::open(again, second), status::ok);
  EXPECT_EQ(second.facts().slack, file.facts().slack);
  EXPECT_EQ(expect_sets_agree(in, second).items, sets.items);
}

// ---- The runtime.

void expect_info(const any_contents& in, const reader& file, const sightcell_db* db) {
  sightcell_info info{};
  info.struct_size = sizeof(info);
  ASSERT_EQ(sightcell_db_info(db, &info), SIGHTCELL_OK);
  EXPECT_EQ(info.layout, static_cast<std::uint32_t>(in.facts.layout));
  EXPECT_EQ(info.polygon_count, in.facts.polygon_count);
  EXPECT_EQ(info.cell_count, in.cells.size());
  EXPECT_EQ(info.draw_count, in.draws.size());
  const std::uint64_t of_everything = ranges_of(in, all_polygons(in.facts.polygon_count));
  EXPECT_EQ(info.range_bound, std::max<std::uint64_t>(file.range_bound(), of_everything));
  EXPECT_EQ(info.margin, in.facts.margin);
  EXPECT_EQ(info.player_radius, in.player_radius);
  for (std::uint32_t cell = 0; cell < in.cells.size(); ++cell) {
    float valid = 0.0f;
    float outside = 0.0f;
    ASSERT_EQ(sightcell_db_cell_viewpoints(db, cell, &valid, &outside), SIGHTCELL_OK);
    EXPECT_EQ(valid, in.viewpoints.empty() ? 1.0f : in.viewpoints[cell].valid_share) << cell;
    EXPECT_EQ(static_cast<double>(outside), in.viewpoints.empty() ? 0.0 : in.viewpoints[cell].outside_share) << cell;
  }
  EXPECT_EQ(std::memcmp(info.scene_fingerprint, in.facts.scene_fingerprint.data(), 16), 0);
  EXPECT_EQ(sightcell_db_check(db), SIGHTCELL_OK);
  std::size_t count = 0;
  std::vector<sightcell_draw> draws(in.draws.size());
  ASSERT_EQ(sightcell_db_draws(db, draws.data(), draws.size(), &count), SIGHTCELL_OK);
  ASSERT_EQ(count, in.draws.size());
  numbers named_groups(in.draws.size());
  ASSERT_EQ(sightcell_db_named_groups_of_draws(db, named_groups.data(), named_groups.size(), &count), SIGHTCELL_OK);
  const bool merged = in.facts.layout == host_layout::merged;
  for (std::size_t i = 0; i < count; ++i) {
    draw_record expected = in.draws[i];
    if (merged) expected.first_stored = in.unit_begins[expected.group];
    const sightcell_draw& d = draws[i];
    EXPECT_TRUE(same_draw({d.node, d.mesh, d.primitive, d.instance, d.material, d.group, d.first_source,
                           d.polygon_count, d.first_stored, d.base_vertex, d.host_tag, expected.flags, named_groups[i]},
                          expected))
        << i;
  }
  numbers order(in.facts.polygon_count);
  ASSERT_EQ(sightcell_db_order(db, order.data(), order.size(), &count), SIGHTCELL_OK);
  EXPECT_EQ(order, in.source_of_stored);
}

double volume_of(const box& b) {
  double volume = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    volume *= static_cast<double>(b.max[axis]) - static_cast<double>(b.min[axis]);
  }
  return volume;
}

// By testing all: the smallest, then the lowest number.
std::uint32_t cell_at(const any_contents& in, const std::array<float, 3>& eye) {
  std::uint32_t found = SIGHTCELL_NO_CELL;
  for (std::uint32_t cell = 0; cell < in.cells.size(); ++cell) {
    const box& b = in.cells[cell];
    bool holds = true;
    for (std::size_t axis = 0; axis < 3; ++axis) holds = holds && b.min[axis] <= eye[axis] && eye[axis] < b.max[axis];
    if (holds && (found == SIGHTCELL_NO_CELL || volume_of(b) < volume_of(in.cells[found]))) found = cell;
  }
  return found;
}

// Ids in stored order, ranges and indices all give these stored polygons.
void expect_outputs(const any_contents& in, const test_view& view, const numbers& stored) {
  numbers ids;
  numbers indices;
  for (const std::uint32_t polygon : stored) {
    ids.push_back(in.source_of_stored[polygon]);
    for (std::uint32_t corner = 0; corner < 3; ++corner) indices.push_back(7 * (3 * polygon + corner) + 1);
  }
  EXPECT_EQ(view.polygons(), ids);
  const auto ranges = view.ranges();
  EXPECT_EQ(ranges.size(), ranges_of(in, stored));
  EXPECT_EQ(polygons_of(ranges, in), stored);
  numbers host(std::size_t{3} * in.facts.polygon_count);
  for (std::size_t i = 0; i < host.size(); ++i) host[i] = static_cast<std::uint32_t>(7 * i + 1);
  EXPECT_EQ(view.indices(host), indices);
}

// From the center of each cell that no other cell covers. Each with a view of its own, as the margin may keep an old
// cell.
void expect_runtime(const any_contents& in, const reader& file, const read_sets& sets,
                    const std::vector<std::byte>& bytes, kinds_met& met) {
  const loaded_file loaded(bytes);
  ASSERT_NE(loaded.db(), nullptr);
  expect_info(in, file, loaded.db());
  for (std::uint32_t cell = 0; cell < in.cells.size(); cell += 1 + static_cast<std::uint32_t>(in.cells.size()) / 24) {
    std::array<float, 3> eye{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      eye[axis] = in.cells[cell].min[axis] + (in.cells[cell].max[axis] - in.cells[cell].min[axis]) / 2;
    }
    const std::uint32_t found = cell_at(in, eye);
    met.overlapping += found != cell ? 1 : 0;
    test_view view(loaded.db());
    const sightcell_frame frame = view.move(eye[0], eye[1], eye[2]);
    ASSERT_EQ(frame.cell, found) << cell;
    EXPECT_EQ(frame.flags, SIGHTCELL_FRAME_CHANGED);
    EXPECT_EQ(frame.polygon_count, sets.stored[found].size());
    expect_outputs(in, view, sets.stored[found]);
  }
  test_view outside(loaded.db());
  EXPECT_NE(outside.move(3.0e9f, 0, 0).flags & SIGHTCELL_FRAME_DRAW_ALL, 0u);
  expect_outputs(in, outside, all_polygons(in.facts.polygon_count));
}

// ---- All of it.

void count_kinds(const any_contents& in, const reader& file, kinds_met& met) {
  met.merged += in.facts.layout == host_layout::merged ? 1 : 0;
  met.on_lattice += in.lattice ? 1 : 0;
  met.on_grid += in.grid ? 1 : 0;
  met.shared_orders += in.facts.layout == host_layout::instanced && in.orders.size() < in.draws.size() ? 1 : 0;
  met.source_orders += in.orders_left_out ? 1 : 0;
  met.no_polygons += in.facts.polygon_count == 0 ? 1 : 0;
  met.chunks = std::max(met.chunks, file.chunk_count());
  met.small_chunks += file.chunk_count() > (file.cell_count() + 63) / 64 ? 1 : 0;
  met.volumes += in.volumes.empty() ? 0 : 1;
  met.in_clusters += file.cluster_count() > 0 ? 1 : 0;
  for (const draw_record& d : in.draws) met.moving += d.flags != 0 ? 1 : 0;
  for (const numbers& set : in.sets) {
    met.empty_sets += set.empty() ? 1 : 0;
    met.sets_of_one += set.size() == 1 ? 1 : 0;
    const auto volume = std::lower_bound(set.begin(), set.end(), in.facts.polygon_count);
    met.from_polygons_on += volume != set.begin() && volume != set.end() && *(volume - 1) + 1 == *volume ? 1 : 0;
    met.full_sets += set.size() == in.facts.polygon_count ? 1 : 0;
  }
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    row_record row;
    row_record reference;
    ASSERT_EQ(file.row(cell, row), status::ok);
    if (row.delta) {
      ASSERT_EQ(file.row(row.reference, reference), status::ok);
    }
    met.own += row.delta ? 0 : 1;
    met.first_differences += row.delta && !reference.delta ? 1 : 0;
    met.second_differences += row.delta && reference.delta ? 1 : 0;
    met.shared_rows += row.shared ? 1 : 0;
  }
}

void expect_round_trip(std::uint32_t seed, kinds_met& met) {
  const any_contents in = make_any_contents(seed);
  const std::vector<std::byte> bytes = in.write();
  EXPECT_TRUE(bytes == in.write()) << "same contents, same bytes";
  EXPECT_TRUE(bytes == make_any_contents(seed).write()) << "in any memory";
  expect_asking_makes_no_difference(in, bytes);
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  expect_facts(in, file);
  expect_draws_and_orders(in, file);
  expect_cells(in, file);
  expect_volumes(in, file);
  expect_viewpoints(in, file);
  if (testing::Test::HasFailure()) return;
  const read_sets sets = expect_sets_agree(in, file);
  expect_sets(in, file, sets, met);
  expect_parts_make_the_file(in, file, sets, bytes);
  expect_runtime(in, file, sets, bytes, met);
  count_kinds(in, file, met);
}

TEST(round_trip, contents_of_any_kind_come_back) {
  const std::uint32_t first = number_in_environment("SIGHTCELL_TEST_SEED", 1);
  const std::uint32_t rounds = number_in_environment("SIGHTCELL_TEST_ROUNDS", usual_rounds);
  const auto step = static_cast<std::uint32_t>(case_step());
  kinds_met met;
  for (std::uint32_t round = 0; round < rounds; round += step) {
    SCOPED_TRACE("SIGHTCELL_TEST_SEED=" + std::to_string(first + round) + " SIGHTCELL_TEST_ROUNDS=1");
    expect_round_trip(first + round, met);
    ASSERT_FALSE(HasFailure());
  }
  if (rounds < usual_rounds || step > 1) return;
  for (const std::uint32_t count : {met.merged,
                                    met.on_lattice,
                                    met.on_grid,
                                    met.shared_orders,
                                    met.source_orders,
                                    met.moving,
                                    met.no_polygons,
                                    met.own,
                                    met.first_differences,
                                    met.second_differences,
                                    met.shared_rows,
                                    met.empty_sets,
                                    met.full_sets,
                                    met.sets_of_one,
                                    met.widened_sets,
                                    met.overlapping,
                                    met.volumes,
                                    met.from_polygons_on,
                                    met.widened_with_volumes,
                                    met.small_chunks,
                                    met.in_clusters,
                                    met.widened_by_clusters}) {
    EXPECT_GT(count, 5u);
  }
  EXPECT_GT(met.chunks, 3u) << "with slack, not all are sampled";
}

}  // namespace
