#include "bench/runtime_frames/lookups.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include "cell_locator.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"
#include "sightcell/sightcell.h"

namespace sightcell::bench {
namespace {

using runtime::point;

void require(bool good, const char* what) {
  if (!good) throw std::runtime_error(what);
}

// Cells that see nothing, so that a move costs what finding them costs.
struct empty_cells {
  std::vector<format::box> boxes;
  std::optional<format::lattice_shape> shape;
  std::vector<format::lattice_place> places;

  [[nodiscard]] std::vector<std::byte> encode() const {
    format::file_contents contents;
    const format::draw_record draw{.polygon_count = 1};
    contents.facts.polygon_count = 1;
    contents.facts.margin = 0.25f;
    contents.draws = {&draw, 1};
    if (shape) {
      contents.lattice = format::lattice_cells{*shape, places};
    } else {
      contents.cells = boxes;
    }
    const std::size_t count = shape ? places.size() : boxes.size();
    contents.cell_sets = {count, [](std::uint32_t, std::vector<std::uint32_t>&) { return format::status::ok; }};
    std::vector<std::byte> bytes;
    require(format::encode(contents, bytes) == format::status::ok, "cells cannot be encoded");
    return bytes;
  }
};

// Squares of 2 m; with two levels every fourth one is four of 1 m.
empty_cells lattice_of(std::uint32_t cells, bool two_levels) {
  empty_cells made;
  made.shape = format::lattice_shape{2.0, 2.0};
  const int side = static_cast<int>(std::lround(std::sqrt(two_levels ? cells / 1.75 : double{1} * cells)));
  for (int z = -side / 2; z < side - side / 2; ++z) {
    for (int x = -side / 2; x < side - side / 2; ++x) {
      if (!two_levels || (x + z) % 4 != 0) {
        made.places.push_back({x, 0, z, 0});
        continue;
      }
      for (int i = 0; i < 4; ++i) made.places.push_back({2 * x + i % 2, 0, 2 * z + i / 2, 1});
    }
  }
  std::sort(made.places.begin(), made.places.end(), format::lattice_comes_before);
  return made;
}

// About four of them hold any place.
empty_cells boxes_of(std::uint32_t cells) {
  empty_cells made;
  std::mt19937 random(5);
  const double side = std::sqrt(double{1} * cells) * 2.0;
  for (std::uint32_t i = 0; i < cells; ++i) {
    const auto some = [&](double most) {
      return static_cast<float>(most * static_cast<double>(random() % 65536) / 65536.0);
    };
    const float x = some(side) - static_cast<float>(side) / 2;
    const float z = some(side) - static_cast<float>(side) / 2;
    made.boxes.push_back({{x, 0, z}, {x + 1 + some(6), 2, z + 1 + some(6)}});
  }
  return made;
}

// Looks one eye up after the other.
double ns_per_find(const runtime::cell_locator& locator, const std::vector<point>& eyes, unsigned repeat) {
  std::vector<double> passes;
  std::uint64_t sum = 0;
  for (unsigned pass = 0; pass < std::max(3u, repeat / 10); ++pass) {
    passes.push_back(cpu_time_of([&] {
                       format::box bounds;
                       for (const point& eye : eyes)
                         sum += locator.find(runtime::rounded_down(eye), runtime::any_volume, bounds);
                     }) /
                     static_cast<double>(eyes.size()));
  }
  require(sum != 1, "no sum is one");  // so that nothing is left out
  return median_of(passes);
}

// A camera at walking pace, 1.5 m/s in 60 frames a second, that turns a little all the time.
std::vector<point> path(std::uint32_t steps, double half_side) {
  std::vector<point> eyes;
  double x = 0.3;
  double z = 0.4;
  double heading = 0.7;
  for (std::uint32_t i = 0; i < steps; ++i) {
    heading += 0.01 * std::sin(0.003 * i) + 0.002;
    x += 0.025 * std::cos(heading);
    z += 0.025 * std::sin(heading);
    if (std::abs(x) > half_side) x = -x;
    if (std::abs(z) > half_side) z = -z;
    eyes.push_back({double{static_cast<float>(x)}, 1.0, double{static_cast<float>(z)}});
  }
  return eyes;
}

// Frames that stay in their cell, many of them at a time: a stretch of the path is walked when it lies in one cell.
double ns_per_frame(const sightcell_db* db, const std::vector<point>& eyes, unsigned repeat) {
  sightcell_view* view = nullptr;
  require(sightcell_view_create(db, &view) == SIGHTCELL_OK, "no view");
  std::vector<double> passes;
  std::vector<std::array<float, 3>> still;
  for (const point& eye : eyes) {
    still.push_back({static_cast<float>(eye[0]), static_cast<float>(eye[1]), static_cast<float>(eye[2])});
  }
  constexpr std::size_t stretch = 16;
  for (std::size_t at = 0; at + stretch < still.size() && passes.size() < std::size_t{100} * repeat; at += stretch) {
    sightcell_frame frame;
    sightcell_view_move(view, still[at].data(), &frame);
    const std::uint32_t cell = frame.cell;
    // Again and again, so that the clock costs little.
    constexpr int rounds = 64;
    const double ns = time_of([&] {
      for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < stretch; ++i) sightcell_view_move(view, still[at + i].data(), &frame);
      }
    });
    if (frame.cell == cell) passes.push_back(ns / (rounds * stretch));
  }
  sightcell_view_destroy(view);
  return median_of(passes);
}

lookup_row measure(const std::string& kind, const empty_cells& cells, const frame_timing& how) {
  const std::vector<std::byte> bytes = cells.encode();
  format::reader file;
  require(format::reader::open(bytes, file) == format::status::ok, "not what was encoded");
  std::vector<runtime::lattice_slot> slots;
  std::vector<runtime::located_cell> located;
  std::vector<runtime::tree_node> nodes;
  if (file.lattice() != nullptr) {
    slots.resize(runtime::lattice_index::slot_count(file.lattice()->chunk_count()));
  } else {
    located.resize(file.cell_count());
    nodes.resize(runtime::box_tree::node_count(file.cell_count()));
  }
  runtime::cell_locator locator;
  require(locator.build(file, {slots, located, nodes}), "no locator");

  lookup_row row;
  row.kind = kind;
  row.cells = file.cell_count();
  row.bytes_per_cell = static_cast<double>(slots.size() * sizeof(slots[0]) + located.size() * sizeof(located[0]) +
                                           nodes.size() * sizeof(nodes[0])) /
                       row.cells;
  std::mt19937 random(7);
  const double half_side = std::sqrt(double{1} * row.cells) * (cells.places.size() > cells.boxes.size() ? 0.7 : 0.9);
  std::vector<point> eyes(how.lookups);
  for (point& eye : eyes) {
    const auto some = [&] {
      return double{static_cast<float>(half_side * (static_cast<double>(random()) / 2147483648.0 - 1.0))};
    };
    eye = {some(), 1.0, some()};
  }
  row.random_ns = ns_per_find(locator, eyes, how.repeat);
  const std::vector<point> walk = path(how.lookups, half_side);
  row.coherent_ns = ns_per_find(locator, walk, how.repeat);
  sightcell_db* db = nullptr;
  require(sightcell_db_open(bytes.data(), bytes.size(), nullptr, &db) == SIGHTCELL_OK, "cannot be opened");
  row.frame_ns = ns_per_frame(db, walk, how.repeat);
  sightcell_db_close(db);
  return row;
}

}  // namespace

std::vector<lookup_row> measure_lookups(const frame_timing& how) {
  std::vector<lookup_row> rows;
  for (std::uint32_t cells = 1'000; cells <= how.most_cells; cells *= 10) {
    rows.push_back(measure("lattice", lattice_of(cells, false), how));
    rows.push_back(measure("lattice of two levels", lattice_of(cells, true), how));
    rows.push_back(measure("boxes", boxes_of(cells), how));
  }
  return rows;
}

}  // namespace sightcell::bench
