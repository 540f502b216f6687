#include "file_walk.h"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "decode_dump.h"

namespace sightcell::test {
namespace {

constexpr std::uint32_t steps = 600;

using ends = std::array<float, 3>;

struct bounds {
  ends min{}, max{};
};

void add_status(fnv_hash& hash, sightcell_status s) {
  hash.add(static_cast<std::uint32_t>(s));
}
void add_wide(fnv_hash& hash, std::uint64_t number) {
  hash.add(static_cast<std::uint32_t>(number));
  hash.add(static_cast<std::uint32_t>(number >> 32));
}
void add_place(fnv_hash& hash, const float place[3]) {
  for (std::size_t axis = 0; axis < 3; ++axis) hash.add(std::bit_cast<std::uint32_t>(place[axis]));
}
void add_ranges(fnv_hash& hash, const std::vector<sightcell_range>& ranges, std::size_t count) {
  for (std::size_t i = 0; i < std::min(count, ranges.size()); ++i) {
    for (const std::uint32_t value : {ranges[i].draw, ranges[i].first, ranges[i].count}) hash.add(value);
  }
}

// The bounding box of all cells. Hashes the box of each cell and of each volume.
bounds add_boxes(fnv_hash& hash, const sightcell_db* db) {
  bounds all;
  for (std::uint32_t cell = 0; cell < sightcell_db_cell_count(db); ++cell) {
    bounds b;
    add_status(hash, sightcell_db_cell_box(db, cell, b.min.data(), b.max.data()));
    add_place(hash, b.min.data());
    add_place(hash, b.max.data());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      all.min[axis] = cell == 0 ? b.min[axis] : std::min(all.min[axis], b.min[axis]);
      all.max[axis] = cell == 0 ? b.max[axis] : std::max(all.max[axis], b.max[axis]);
    }
  }
  hash.add(sightcell_db_volume_count(db));
  for (std::uint32_t volume = 0; volume < sightcell_db_volume_count(db); ++volume) {
    bounds b;
    add_status(hash, sightcell_db_volume_box(db, volume, b.min.data(), b.max.data()));
    add_place(hash, b.min.data());
    add_place(hash, b.max.data());
  }
  return all;
}

void add_changes(fnv_hash& hash, const sightcell_view* view, std::uint32_t since, std::size_t room) {
  std::vector<sightcell_range> added(room);
  std::vector<sightcell_range> removed(room);
  std::size_t added_count = 0;
  std::size_t removed_count = 0;
  add_status(hash, sightcell_view_changes(view, since, added.data(), room, &added_count, removed.data(), room,
                                          &removed_count));
  add_ranges(hash, added, added_count);
  add_ranges(hash, removed, removed_count);
}

void add_lists(fnv_hash& hash, const sightcell_view* view, std::uint32_t min_gap, std::size_t room, std::size_t words) {
  std::vector<sightcell_command> commands(room);
  std::size_t count = 0;
  add_status(hash, sightcell_view_commands(view, min_gap, commands.data(), sizeof(sightcell_command), room, &count));
  for (std::size_t i = 0; i < std::min(count, room); ++i) {
    const sightcell_command& c = commands[i];
    for (const std::uint32_t value : {c.index_count, c.instance_count, c.first_index, c.base_vertex, c.first_instance})
      hash.add(value);
  }
  std::vector<std::uint64_t> bits(words);
  add_status(hash, sightcell_view_objects(view, bits.data(), words));
  for (const std::uint64_t word : bits) add_wide(hash, word);
  static_cast<void>(sightcell_view_debug_lines(view, 31, nullptr, 0, &count));
  std::vector<sightcell_debug_line> lines(count);
  add_status(hash, sightcell_view_debug_lines(view, 31, lines.data(), lines.size(), &count));
  for (const sightcell_debug_line& line : lines) {
    add_place(hash, line.from);
    add_place(hash, line.to);
    hash.add(line.kind);
    hash.add(line.number);
  }
}

void add_end(fnv_hash& hash, const sightcell_db* db, const sightcell_view* view, const ends& eye) {
  sightcell_view_stats stats{};
  stats.struct_size = sizeof(stats);
  add_status(hash, sightcell_view_statistics(view, &stats));
  for (const std::uint64_t value : {stats.moves, stats.rows_decoded, stats.changes, stats.moves_outside,
                                    stats.moves_pending, stats.moves_draw_all, stats.polygons}) {
    add_wide(hash, value);
  }
  sightcell_miss miss{};
  for (std::size_t axis = 0; axis < 3; ++axis) miss.eye[axis] = static_cast<double>(eye[axis]);
  std::array<char, 512> text{};
  std::size_t size = 0;
  add_status(hash, sightcell_db_misses_text(db, &miss, 1, text.data(), text.size(), &size));
  hash.add(std::string_view(text.data(), std::min(size, text.size())));
}

}  // namespace

std::uint64_t hash_of_walk(const sightcell_db* db) {
  fnv_hash hash;
  const bounds all = add_boxes(hash, db);
  sightcell_info info{};
  info.struct_size = sizeof(info);
  add_status(hash, sightcell_db_info(db, &info));
  sightcell_view* view = nullptr;
  add_status(hash, sightcell_view_create(db, &view));
  std::uint32_t state = 1;
  ends eye{};
  for (std::uint32_t step = 0; step < steps; ++step) {
    if (step % 100 == 0) {
      add_status(hash, sightcell_view_policy(view, step / 100 % 3, 1.5f));
      const double origin[3] = {step / 100 % 2 == 0 ? 0.0 : 0.25, 0.0, 0.0};
      add_status(hash, sightcell_view_origin(view, origin));
    }
    // Starts an eighth of the way before the cells and ends as far behind them, in steps that reach many borders of
    // cells.
    ends far{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      state = state * 1664525u + 1013904223u;
      const float part = static_cast<float>((state >> 16) % 21) * 0.0625f - 0.125f;
      const float way = all.max[axis] - all.min[axis];
      const float more = way * part;
      eye[axis] = all.min[axis] + more;
      far[axis] = eye[axis] + 0.375f;
    }
    sightcell_frame frame{};
    const sightcell_status moved = step % 7 == 0 ? sightcell_view_move_box(view, eye.data(), far.data(), &frame)
                                                 : sightcell_view_move(view, eye.data(), &frame);
    add_status(hash, moved);
    for (const std::uint32_t value : {frame.cell, frame.flags, frame.polygon_count, frame.revision}) hash.add(value);
    std::uint32_t visible = 2;
    add_status(hash, sightcell_view_box_visible(view, eye.data(), far.data(), &visible));
    hash.add(visible);
    add_changes(hash, view, frame.revision - 1, info.polygon_count);
    add_lists(hash, view, step % 5, info.range_bound, (info.draw_count + 63) / 64);
  }
  add_end(hash, db, view, eye);
  sightcell_view_destroy(view);
  return hash.value();
}

}  // namespace sightcell::test
