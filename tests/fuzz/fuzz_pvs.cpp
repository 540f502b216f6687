// libFuzzer target: the runtime on hostile .pvs files. Any file is refused with a status or answers within its
// promises. Checksums are made right first, else nearly every change would end at them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "checksum.h"
#include "sightcell/format/importance_classes.h"
#include "sightcell/format/reader.h"
#include "sightcell/identity.h"
#include "sightcell/sightcell.h"
#include "sightcell/viewpoints.h"
#include "volume_index.h"

namespace {

constexpr std::uint32_t polygon_limit = 1u << 20;  // what a few bytes may promise, and a test has no time for
constexpr std::uint32_t cell_limit = 64;
constexpr std::uint32_t volume_limit = 1u << 16;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz_pvs: %s\n", what);
  std::abort();
}

std::uint64_t number_at(const std::vector<std::uint8_t>& bytes, std::size_t at, int width) {
  std::uint64_t value = 0;
  for (int i = 0; i < width; ++i) value |= std::uint64_t{bytes[at + static_cast<std::size_t>(i)]} << 8 * i;
  return value;
}

void put_u32(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> 8 * i);
}

std::uint32_t sum_of(const std::vector<std::uint8_t>& bytes, std::uint64_t at, std::uint64_t size) {
  if (at > bytes.size() || size > bytes.size() - at) return 0;
  return sightcell::format::crc32c(std::as_bytes(std::span(bytes)).subspan(at, size));
}

// Inside the importance section: its chunks, then what is before them.
void make_importance_right(std::vector<std::uint8_t>& bytes, std::uint64_t at, std::uint64_t size, std::size_t chunks) {
  if (at > bytes.size() || size > bytes.size() - at || chunks > size / 16 || 4 + 16 * chunks > size) return;
  const std::uint64_t end = at + size;
  std::uint64_t first = at + 4 + 16 * chunks;
  for (int table = 0; table < 17 && first < end; ++table) first += 1 + (bytes[first] + 1) / 2;
  if (first > end) return;
  for (std::size_t k = 0; k < chunks; ++k) {
    const std::uint64_t record = at + 4 + 16 * k, offset = number_at(bytes, record, 8);
    if (offset > end - first) continue;
    put_u32(bytes, record + 12, sum_of(bytes, first + offset, number_at(bytes, record + 8, 4)));
  }
  put_u32(bytes, at, sum_of(bytes, at + 4, first - at - 4));
}

// Numbers and places: format/SPEC.md. Total size, chunks, sections, section table, header, in this order.
void make_sums_right(std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < 96) return;
  put_u32(bytes, 16, static_cast<std::uint32_t>(bytes.size()));
  put_u32(bytes, 20, 0);
  const std::size_t sections = std::min<std::size_t>(number_at(bytes, 12, 4), (bytes.size() - 96) / 32);
  std::uint64_t rows = 0;
  std::size_t chunks = (number_at(bytes, 64, 4) + 63) / 64, records = 0;
  bool has_borders = false;
  for (std::size_t i = 0; i < sections; ++i) {
    const std::uint64_t id = number_at(bytes, 96 + 32 * i, 4);
    if (id == 3) rows = number_at(bytes, 96 + 32 * i + 8, 8);
    if (id == 4) records = std::min<std::size_t>(number_at(bytes, 96 + 32 * i + 16, 8), bytes.size()) / 16;
    if (id == 14) has_borders = true;
  }
  if (has_borders) chunks = records;
  for (std::size_t i = 0; i < sections; ++i) {
    const std::size_t record = 96 + 32 * i;
    const std::uint64_t at = number_at(bytes, record + 8, 8), size = number_at(bytes, record + 16, 8);
    for (std::size_t k = 0; number_at(bytes, record, 4) == 4 && k < chunks; ++k) {
      const std::uint64_t chunk = at + 16 * k;
      if (chunk > bytes.size() || bytes.size() - chunk < 16) break;
      put_u32(bytes, chunk + 12, sum_of(bytes, rows + number_at(bytes, chunk, 8), number_at(bytes, chunk + 8, 4)));
    }
    if (number_at(bytes, record, 4) == 9) make_importance_right(bytes, at, size, chunks);
    put_u32(bytes, record + 24, sum_of(bytes, at, size));
  }
  put_u32(bytes, 88, sum_of(bytes, 96, 32 * sections));
  put_u32(bytes, 92, sum_of(bytes, 0, 92));
}

// sound: the whole file was checked, so no polygon is stored twice.
void check_outputs(const sightcell_view* view, const sightcell_frame& frame, std::uint32_t polygons,
                   std::uint32_t range_bound, bool sound) {
  std::size_t count = 0;
  std::vector<std::uint32_t> ids(frame.polygon_count);
  require(sightcell_view_polygons(view, ids.data(), ids.size(), &count) == SIGHTCELL_OK && count == ids.size(),
          "polygons fit what the frame says");
  std::sort(ids.begin(), ids.end());
  require(ids.empty() || ids.back() < polygons, "ids are inside the scene");
  require(!sound || std::adjacent_find(ids.begin(), ids.end()) == ids.end(), "each id once");
  std::vector<sightcell_range> ranges(range_bound);
  require(sightcell_view_ranges(view, ranges.data(), ranges.size(), &count) == SIGHTCELL_OK, "ranges fit their bound");
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += ranges[i].count;
  require(sum == frame.polygon_count, "ranges are the polygons");
  std::vector<sightcell_range> added(range_bound), removed(range_bound);
  std::size_t added_count = 0, removed_count = 0;
  sightcell_view_changes(view, frame.revision - 1, added.data(), added.size(), &added_count, removed.data(),
                         removed.size(), &removed_count);
}

// sound: the whole file was checked, so each cell has the classes that it is asked for.
void query_importance(std::span<const std::byte> bytes, std::uint32_t cell, std::uint32_t polygons, bool sound) {
  using namespace sightcell::format;
  reader file;
  importance_classes importance;
  if (reader::open(bytes, file) != status::ok || file.importance(importance) != status::ok) return;
  std::vector<std::uint8_t> classes(polygons);
  const status s = importance.decode(cell, classes);
  require(!sound || s == status::ok, "a sound file has a class for each polygon");
  for (const std::uint8_t one : classes)
    require(s != status::ok || one < importance_class_count, "classes are 0 .. 15");
}

// The volumes of a file, with the memory that asking takes.
class volume_queries {
 public:
  // Not ready: the file has no volumes, too many of them, or no rows that could be read.
  explicit volume_queries(std::span<const std::byte> bytes) {
    using namespace sightcell::format;
    if (reader::open(bytes, file_) != status::ok) return;
    const std::uint32_t count = file_.volumes().count();
    if (count == 0 || count > volume_limit || file_.run_bound() > polygon_limit) return;
    memory_.resize(file_.codes_size() / 8 + 1);
    if (file_.make_codes(std::as_writable_bytes(std::span(memory_)), codes_) != status::ok) return;
    row_.resize(file_.row_room());
    scratch_.resize(file_.scratch_size());
    index_.measure(file_.volumes());
    sightcell::runtime::carver counted(nullptr);
    index_.carve(counted);
    block_.resize(counted.used());
    sightcell::runtime::carver space(block_.data());
    index_.carve(space);
    require(index_.build(file_.volumes()), "volumes stay what they are");
    visible_.resize(index_.chunk_count());
    ready_ = true;
  }

  // A volume can be seen where the cell sees it. sound: and only there.
  void ask(std::uint32_t cell, bool sound) {
    using namespace sightcell::format;
    row_parts parts;
    if (!ready_ || file_.decode_row(cell, codes_, row_, scratch_, parts) != status::ok) return;
    const std::uint32_t count = file_.volumes().count();
    std::vector<bool> seen(count, false);
    std::uint64_t next = 0;
    for (const sightcell::format::run& r : parts.volumes) {
      require(r.first >= next && r.count > 0 && r.count <= count - r.first, "runs of volumes ascend and end with them");
      next = std::uint64_t{r.first} + r.count + 1;
      std::fill_n(seen.begin() + r.first, r.count, true);
    }
    index_.show(parts.volumes, visible_);
    for (std::uint32_t volume = 0; volume < count; ++volume) {
      box b;
      require(file_.volumes().volume_box(volume, b), "volumes have boxes");
      const bool whole = index_.box_visible(b.min.data(), b.max.data(), visible_);
      require(whole || !seen[volume], "what is seen is visible");
      float middle[3];
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k) {
        middle[k] = b.min[k] + (b.max[k] - b.min[k]) / 2;
        inside = inside && b.min[k] < middle[k] && middle[k] < b.max[k];
      }
      const bool visible = index_.box_visible(middle, middle, visible_);
      require(!sound || !inside || visible == seen[volume], "a place is visible where its volume is seen");
    }
  }

 private:
  sightcell::format::reader file_;
  sightcell::runtime::volume_index index_;
  const sightcell::format::row_codes* codes_ = nullptr;
  std::vector<std::uint64_t> memory_, visible_;
  std::vector<sightcell::format::run> row_;
  std::vector<std::byte> scratch_, block_;
  bool ready_ = false;
};

void ask_names(const sightcell_db* db, std::size_t draws) {
  const std::uint32_t groups = sightcell_db_named_group_count(db);
  std::size_t count = 0;
  for (std::uint32_t group = 0; group < std::min(groups, cell_limit); ++group) {
    require(sightcell_db_named_group_name(db, group, nullptr, 0, &count) == SIGHTCELL_ERR_CAPACITY, "names have bytes");
    std::string name(count, ' ');
    require(sightcell_db_named_group_name(db, group, name.data(), count, &count) == SIGHTCELL_OK, "names fit");
    std::uint32_t found = 0;
    require(sightcell_db_find_named_group(db, name.c_str(), &found) == SIGHTCELL_OK, "names are looked for");
    const bool whole = name.find('\0') == std::string::npos;
    require(!whole || found <= group, "a name is found, or an earlier one like it");
  }
  std::vector<std::uint32_t> of_draws(draws);
  require(sightcell_db_named_groups_of_draws(db, of_draws.data(), draws, &count) == SIGHTCELL_OK, "draws have groups");
  for (const std::uint32_t group : of_draws)
    require(group < groups || group == SIGHTCELL_NO_NAMED_GROUP, "a group of a draw is one");
}

// A host with the hashes of the file has its draws. The section is checked when it is read, so each call finds a fault.
// sound: the whole file was checked, so no two draws begin at one polygon.
void ask_identity(const sightcell_db* db, std::uint32_t draws, bool sound) {
  std::vector<std::uint64_t> hashes;
  std::array<char, 255> name;
  std::size_t count = 0;
  for (std::uint32_t draw = 0; draw < std::min(draws, 20u); ++draw) {
    std::uint64_t hash = 0;
    if (sightcell_db_draw_hash(db, draw, &hash) != SIGHTCELL_OK) return;
    hashes.push_back(hash);
    for (const std::uint32_t kind : {SIGHTCELL_NAME_NODE, SIGHTCELL_NAME_MESH})
      require(sightcell_db_draw_name(db, draw, kind, name.data(), name.size(), &count) == SIGHTCELL_OK, "names fit");
  }
  std::vector<std::uint32_t> found(hashes.size());
  sightcell_draw_match match{};
  match.struct_size = sizeof match;
  const sightcell_status s = sightcell_db_match(db, hashes.data(), nullptr, hashes.size(), found.data(), &match);
  require(s == SIGHTCELL_OK || s == SIGHTCELL_ERR_OTHER_SCENE, "draws are matched");
  require(!sound || match.extra == 0, "a host with the hashes of the file has no other draws");
}

// Shares are shares; the boxes outside the region of a cell are inside its grown box. sound: the whole file was
// checked, so the regions are trees.
void ask_viewpoints(const sightcell_db* db, const sightcell_view* view, const sightcell_frame& frame, bool sound) {
  if (frame.cell == SIGHTCELL_NO_CELL) return;
  float valid = 0, outside = -1, low[3], high[3];
  require(sightcell_db_cell_viewpoints(db, frame.cell, &valid, &outside) == SIGHTCELL_OK, "cells have viewpoints");
  require(valid > 0 && valid <= 1 && outside >= 0 && outside <= 1, "shares are shares");
  require(sightcell_db_cell_box(db, frame.cell, low, high) == SIGHTCELL_OK, "cells have boxes");
  float eye[3];
  for (std::uint32_t number = 0; number < 3; ++number) {
    if (sightcell_db_cell_eye(db, frame.cell, number, eye) != SIGHTCELL_OK) continue;
    for (int k = 0; k < 3; ++k) require(eye[k] >= low[k] && eye[k] < high[k], "eyes are in their cells");
  }
  std::size_t count = 0;
  sightcell_status s = sightcell_view_debug_lines(view, SIGHTCELL_DEBUG_OUTSIDE_REGION, nullptr, 0, &count);
  require(!sound || s != SIGHTCELL_ERR_CORRUPT, "regions of a sound file are trees");
  if (s == SIGHTCELL_ERR_CORRUPT) return;
  std::vector<sightcell_debug_line> lines(count);
  s = sightcell_view_debug_lines(view, SIGHTCELL_DEBUG_OUTSIDE_REGION, lines.data(), lines.size(), &count);
  require(s == SIGHTCELL_OK && count == lines.size() && count % 12 == 0, "lines fit");
  sightcell_info info{};
  info.struct_size = sizeof info;
  require(sightcell_db_info(db, &info) == SIGHTCELL_OK, "an open file has facts");
  for (const sightcell_debug_line& line : lines)
    for (int k = 0; k < 3; ++k)
      require(line.from[k] >= low[k] - info.margin && line.to[k] <= high[k] + info.margin,
              "parts are in the grown box");
}

// Hidden, a group takes nothing but its own away; shown again, all is as it was.
void hide_and_show(sightcell_view* view, const float eye[3], std::uint32_t group, const sightcell_info& info,
                   const sightcell_frame& shown, bool sound) {
  sightcell_frame frame;
  require(sightcell_view_show_named_group(view, group, 0) == SIGHTCELL_OK, "a group can be hidden");
  require(sightcell_view_move(view, eye, &frame) == SIGHTCELL_OK && frame.polygon_count <= shown.polygon_count,
          "hiding adds nothing");
  check_outputs(view, frame, info.polygon_count, info.range_bound, sound);
  require(sightcell_view_show_named_group(view, group, 1) == SIGHTCELL_OK, "a group can be shown");
  require(sightcell_view_move(view, eye, &frame) == SIGHTCELL_OK && frame.polygon_count == shown.polygon_count &&
              frame.cell == shown.cell,
          "and all is there again");
}

void walk(std::span<const std::byte> file, const sightcell_db* db, sightcell_view* view, const sightcell_info& info,
          bool sound) {
  volume_queries volumes(file);
  const std::uint32_t groups = sightcell_db_named_group_count(db);
  for (std::uint32_t cell = 0; cell < std::min(info.cell_count, cell_limit); ++cell) {
    volumes.ask(cell, sound);
    float low[3], high[3], eye[3];
    if (sightcell_db_cell_box(db, cell, low, high) != SIGHTCELL_OK) continue;
    for (int k = 0; k < 3; ++k) eye[k] = low[k] + (high[k] - low[k]) / 2;
    sightcell_frame frame;
    if (sightcell_view_move(view, eye, &frame) != SIGHTCELL_OK) continue;
    check_outputs(view, frame, info.polygon_count, info.range_bound, sound);
    ask_viewpoints(db, view, frame, sound);
    if (groups > 0) hide_and_show(view, eye, cell % groups, info, frame, sound);
    if (frame.cell < info.cell_count && (frame.flags & SIGHTCELL_FRAME_DRAW_ALL) == 0)
      query_importance(file, frame.cell, frame.polygon_count, sound);
  }
}

void run(const std::uint8_t* data, std::size_t size) {
  sightcell_db* db = nullptr;
  if (sightcell_db_open(data, size, nullptr, &db) != SIGHTCELL_OK) {
    require(db == nullptr, "nothing comes out of a refused file");
    return;
  }
  sightcell_info info{};
  info.struct_size = sizeof info;
  require(sightcell_db_info(db, &info) == SIGHTCELL_OK, "an open file has facts");
  if (info.polygon_count <= polygon_limit && info.draw_count <= polygon_limit) {
    const bool sound = sightcell_db_check(db) == SIGHTCELL_OK;
    std::size_t count = 0;
    std::vector<sightcell_draw> draws(info.draw_count);
    sightcell_db_draws(db, draws.data(), draws.size(), &count);
    std::vector<std::uint32_t> order(info.polygon_count);
    sightcell_db_order(db, order.data(), order.size(), &count);
    ask_names(db, info.draw_count);
    ask_identity(db, info.draw_count, sound);
    sightcell_view* view = nullptr;
    if (sightcell_view_create(db, &view) == SIGHTCELL_OK)
      walk(std::as_bytes(std::span(data, size)), db, view, info, sound);
    sightcell_view_destroy(view);
  }
  sightcell_db_close(db);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  run(data, size);
  return 0;
}

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  std::vector<std::uint8_t> bytes(data, data + size);
  bytes.resize(max_size);
  bytes.resize(LLVMFuzzerMutate(bytes.data(), size, max_size));
  if (seed % 16 != 0) make_sums_right(bytes);
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}
