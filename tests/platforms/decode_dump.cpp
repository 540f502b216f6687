#include "decode_dump.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <vector>

namespace sightcell::test {
namespace {

template <class... Values>
void add(std::string& text, const char* format, Values... values) {
  char line[512];
  const int size = std::snprintf(line, sizeof(line), format, values...);
  text.append(line, static_cast<std::size_t>(size));
}

template <class Element, class Fill>
std::vector<Element> list_of(std::string& text, const Fill& fill) {
  std::size_t count = 0;
  sightcell_status s = fill(nullptr, 0, &count);
  std::vector<Element> list(s == SIGHTCELL_OK || s == SIGHTCELL_ERR_CAPACITY ? count : 0);
  s = fill(list.data(), list.size(), &count);
  if (s != SIGHTCELL_OK) add(text, "WRONG: %s\n", sightcell_status_text(s));
  return list;
}

sightcell_info add_facts(const sightcell_db* db, std::string& text) {
  sightcell_info info{};
  info.struct_size = sizeof(info);
  if (sightcell_db_info(db, &info) != SIGHTCELL_OK) text += "WRONG: no info\n";
  add(text, "version %" PRIu32 "\nfingerprint ", info.format_version);
  for (const unsigned byte : info.scene_fingerprint) add(text, "%02x", byte);
  add(text, "\npolygons %" PRIu32 "\nmargin %.9g\nmax_pixel_error %.9g\nconfidence %.9g\n", info.polygon_count,
      static_cast<double>(info.margin), static_cast<double>(info.max_pixel_error),
      static_cast<double>(info.confidence));
  add(text, "layout %" PRIu32 " cells %" PRIu32 " draws %" PRIu32 " range_bound %" PRIu32 "\n", info.layout,
      info.cell_count, info.draw_count, info.range_bound);
  return info;
}

void add_draws(const std::vector<sightcell_draw>& draws, std::string& text) {
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const sightcell_draw& d = draws[i];
    add(text, "draw %" PRIu64 ":", static_cast<std::uint64_t>(i));
    for (const std::uint32_t value : {d.node, d.mesh, d.primitive, d.instance, d.material, d.group, d.first_source,
                                      d.polygon_count, d.first_stored, d.base_vertex}) {
      add(text, " %" PRIu32, value);
    }
    add(text, " %" PRIu64 "\n", d.host_tag);
  }
}

void add_named_groups(const sightcell_db* db, std::string& text) {
  for (std::uint32_t group = 0; group < sightcell_db_named_group_count(db); ++group) {
    auto name = list_of<char>(text, [&](char* dst, std::size_t room, std::size_t* count) {
      return sightcell_db_named_group_name(db, group, dst, room, count);
    });
    name.push_back('\0');
    std::uint32_t found = 0;
    const sightcell_status s = sightcell_db_find_named_group(db, name.data(), &found);
    if (s != SIGHTCELL_OK || found != group) text += "WRONG: a name is not found\n";
    add(text, "named group %" PRIu32 ": %s\n", group, name.data());
  }
  const auto groups = list_of<std::uint32_t>(text, [&](std::uint32_t* dst, std::size_t room, std::size_t* count) {
    return sightcell_db_named_groups_of_draws(db, dst, room, count);
  });
  for (std::size_t draw = 0; draw < groups.size(); ++draw) {
    if (groups[draw] == SIGHTCELL_NO_NAMED_GROUP) continue;
    add(text, "named group of draw %" PRIu64 ": %" PRIu32 "\n", static_cast<std::uint64_t>(draw), groups[draw]);
  }
}

// What a host stores in addition to its views.
struct stored_polygons {
  std::vector<std::uint32_t> begins;  // first stored polygon of each draw, or of each draw group
  std::vector<std::uint32_t> order;   // source ids
  std::vector<std::uint32_t> indices;
};

// All outputs of the view for the current frame.
void add_answers(const sightcell_view* view, std::uint32_t cell, const stored_polygons& stored, std::string& text) {
  auto set = list_of<std::uint32_t>(text, [&](std::uint32_t* dst, std::size_t room, std::size_t* count) {
    return sightcell_view_polygons(view, dst, room, count);
  });
  const auto ranges = list_of<sightcell_range>(text, [&](sightcell_range* dst, std::size_t room, std::size_t* count) {
    return sightcell_view_ranges(view, dst, room, count);
  });
  const auto indices = list_of<std::uint32_t>(text, [&](std::uint32_t* dst, std::size_t room, std::size_t* count) {
    return sightcell_view_indices(view, stored.indices.data(), dst, room, count);
  });
  auto ascending = set;
  std::sort(ascending.begin(), ascending.end());
  for (const std::uint32_t polygon : ascending) add(text, " %" PRIu32, polygon);
  add(text, "\nranges %" PRIu32 ":", cell);
  std::vector<std::uint32_t> from_ranges;
  for (const sightcell_range& r : ranges) {
    add(text, " %" PRIu32 " %" PRIu32 " %" PRIu32, r.draw, r.first, r.count);
    for (std::uint32_t i = 0; i < r.count && r.draw < stored.begins.size(); ++i) {
      from_ranges.push_back(stored.order.at(stored.begins[r.draw] + r.first + i));
    }
  }
  fnv_hash hash;
  for (const std::uint32_t index : indices) hash.add(index);
  add(text, "\nindices %" PRIu32 ": %016" PRIx64 "\n", cell, hash.value());
  if (from_ranges != set) add(text, "WRONG: the ranges of cell %" PRIu32 " are not its set\n", cell);
}

// Nothing for a file without viewpoints.
void add_viewpoints(const sightcell_db* db, const sightcell_info& info, std::string& text) {
  if (!(info.player_radius > 0.0f)) return;
  add(text, "player_radius %.9g\n", static_cast<double>(info.player_radius));
  for (std::uint32_t cell = 0; cell < info.cell_count; ++cell) {
    float valid = 0.0f;
    float outside = 0.0f;
    if (sightcell_db_cell_viewpoints(db, cell, &valid, &outside) != SIGHTCELL_OK) text += "WRONG: no viewpoints\n";
    add(text, "viewpoints %" PRIu32 ": %.9g %.9g\n", cell, static_cast<double>(valid), static_cast<double>(outside));
  }
}

}  // namespace

std::string dump(const sightcell_db* db) {
  std::string text;
  const sightcell_info info = add_facts(db, text);
  stored_polygons stored;
  const auto draws = list_of<sightcell_draw>(text, [&](sightcell_draw* dst, std::size_t room, std::size_t* count) {
    return sightcell_db_draws(db, dst, room, count);
  });
  stored.order = list_of<std::uint32_t>(text, [&](std::uint32_t* dst, std::size_t room, std::size_t* count) {
    return sightcell_db_order(db, dst, room, count);
  });
  for (const sightcell_draw& d : draws) {
    if (info.layout == 0 || d.group == stored.begins.size()) stored.begins.push_back(d.first_stored);
  }
  add_draws(draws, text);
  add_named_groups(db, text);
  fnv_hash hash;
  for (const std::uint32_t source : stored.order) hash.add(source);
  add(text, "order %016" PRIx64 "\n", hash.value());
  stored.indices.resize(std::size_t{3} * sightcell_db_polygon_count(db));
  for (std::size_t i = 0; i < stored.indices.size(); ++i) {
    stored.indices[i] = static_cast<std::uint32_t>(i) * 2654435761u;
  }
  sightcell_view* view = nullptr;
  if (sightcell_view_create(db, &view) != SIGHTCELL_OK) return text + "WRONG: no view\n";
  for (std::uint32_t cell = 0; cell < sightcell_db_cell_count(db); ++cell) {
    float min[3] = {};
    float max[3] = {};
    float eye[3] = {};
    if (sightcell_db_cell_box(db, cell, min, max) != SIGHTCELL_OK) text += "WRONG: no box\n";
    add(text, "cell %" PRIu32 ": %.9g %.9g %.9g  %.9g %.9g %.9g  sees", cell, static_cast<double>(min[0]),
        static_cast<double>(min[1]), static_cast<double>(min[2]), static_cast<double>(max[0]),
        static_cast<double>(max[1]), static_cast<double>(max[2]));
    for (std::size_t axis = 0; axis < 3; ++axis) eye[axis] = 0.5f * min[axis] + 0.5f * max[axis];
    sightcell_frame frame{};
    // First outside all cells, so that the view does not keep the previous cell.
    static_cast<void>(sightcell_view_move(view, nullptr, &frame));
    const sightcell_status s = sightcell_view_move(view, eye, &frame);
    if (s != SIGHTCELL_OK || frame.cell != cell || (frame.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0) {
      add(text, " from cell %" PRIu32 " flags %" PRIu32 " status %d", frame.cell, frame.flags, static_cast<int>(s));
    }
    add_answers(view, cell, stored, text);
  }
  sightcell_view_destroy(view);
  add_viewpoints(db, info, text);
  return text;
}

}  // namespace sightcell::test
