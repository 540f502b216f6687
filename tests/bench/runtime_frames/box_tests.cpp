#include "bench/runtime_frames/box_tests.h"

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "sightcell/format/writer.h"
#include "sightcell/sightcell.h"

namespace sightcell::bench {
namespace {

void require(bool good, const char* what) {
  if (!good) throw std::runtime_error(what);
}

struct box {
  std::array<float, 3> min, max;
};

constexpr std::int32_t layers = 4;

// One cell, which sees a tenth of the volumes.
std::vector<std::byte> file_of(std::int32_t side) {
  const format::draw_record draw{.polygon_count = 1};
  const format::box cell{{0, 0, 0}, {1, 1, 1}};
  format::file_contents contents;
  contents.facts.polygon_count = 1;
  contents.draws = {&draw, 1};
  contents.cells = {&cell, 1};
  std::vector<format::lattice_place> places;
  std::vector<std::uint32_t> seen;
  std::mt19937 random(3);
  for (std::int32_t y = 0; y < layers; ++y) {
    for (std::int32_t z = -side / 2; z < side - side / 2; ++z) {
      for (std::int32_t x = -side / 2; x < side - side / 2; ++x) {
        if (random() % 10 == 0) seen.push_back(1 + static_cast<std::uint32_t>(places.size()));
        places.push_back({x, y, z, 0});
      }
    }
  }
  contents.volumes = {{2.0, 2.0}, places};
  contents.cell_sets = {1, [&](std::uint32_t, std::vector<std::uint32_t>& set) {
                          set = seen;
                          return format::status::ok;
                        }};
  std::vector<std::byte> bytes;
  require(format::encode(contents, bytes) == format::status::ok, "volumes cannot be encoded");
  return bytes;
}

box person_at(double x, double y, double z) {
  const auto fx = static_cast<float>(x);
  const auto fy = static_cast<float>(y);
  const auto fz = static_cast<float>(z);
  return {{fx, fy, fz}, {fx + 0.6f, fy + 1.8f, fz + 0.6f}};
}

std::vector<box> anywhere(std::int32_t side, std::size_t count) {
  std::mt19937 random(7);
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = (side - 2) * (2.0 * share() - 1.0);
    const double z = (side - 2) * (2.0 * share() - 1.0);
    boxes.push_back(person_at(x, 6.0 * share(), z));
  }
  return boxes;
}

// Frame by frame, 60 a second at 1.5 m/s, all of them in each frame.
std::vector<box> walking(std::int32_t side, std::size_t count) {
  constexpr std::size_t people = 1000;
  std::vector<box> first = anywhere(side, people);
  std::vector<box> boxes;
  for (std::size_t i = 0; boxes.size() < count; ++i) {
    const double way = 0.025 * static_cast<double>(i / people);
    const double heading = static_cast<double>(i % people);
    const auto& from = first[i % people].min;
    const auto moved = [&](float at, double by) {
      const double most = side - 2;
      return std::remainder(static_cast<double>(at) + by + most, 2.0 * most);  // in again on the other side
    };
    boxes.push_back(person_at(moved(from[0], way * std::cos(heading)), static_cast<double>(from[1]),
                              moved(from[2], way * std::sin(heading))));
  }
  return boxes;
}

struct asked {
  double ns = 0.0;
  double visible_share = 0.0;
};

asked ask(const sightcell_view* view, const std::vector<box>& boxes, unsigned repeat) {
  std::vector<double> passes;
  std::uint64_t visible = 0;
  for (unsigned pass = 0; pass < repeat; ++pass) {
    visible = 0;
    passes.push_back(cpu_time_of([&] {
                       for (const box& b : boxes) {
                         std::uint32_t one = 0;
                         sightcell_view_box_visible(view, b.min.data(), b.max.data(), &one);
                         visible += one;
                       }
                     }) /
                     static_cast<double>(boxes.size()));
  }
  return {median_of(passes), static_cast<double>(visible) / static_cast<double>(boxes.size())};
}

box_test_row measure(std::int32_t side, const frame_timing& how) {
  const std::vector<std::byte> bytes = file_of(side);
  sightcell_db* db = nullptr;
  sightcell_view* view = nullptr;
  require(sightcell_db_open(bytes.data(), bytes.size(), nullptr, &db) == SIGHTCELL_OK, "cannot be opened");
  require(sightcell_view_create(db, &view) == SIGHTCELL_OK, "no view");
  const float eye[3] = {0.5f, 0.5f, 0.5f};
  sightcell_frame frame;
  require(sightcell_view_move(view, eye, &frame) == SIGHTCELL_OK && frame.cell == 0, "not in the cell");
  const std::size_t count = how.lookups / 10;
  const unsigned repeat = std::max(3u, how.repeat);
  std::vector<box> boxes = anywhere(side, count);
  const asked random = ask(view, boxes, repeat);
  box_test_row row{.volumes = static_cast<std::uint32_t>(layers * side * side),
                   .visible_share = random.visible_share,
                   .random_ns = random.ns,
                   .walking_ns = ask(view, walking(side, count), repeat).ns};
  const double origin[3] = {1000.0, 0.0, -3000.0};
  require(sightcell_view_origin(view, origin) == SIGHTCELL_OK, "no origin");
  for (box& b : boxes) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      b.min[axis] -= static_cast<float>(origin[axis]);
      b.max[axis] -= static_cast<float>(origin[axis]);
    }
  }
  row.with_origin_ns = ask(view, boxes, repeat).ns;
  sightcell_view_destroy(view);
  sightcell_db_close(db);
  return row;
}

}  // namespace

std::vector<box_test_row> measure_box_tests(const frame_timing& how) {
  std::vector<box_test_row> rows;
  for (const std::int32_t side : {20, 200, 600}) {
    const auto volumes = static_cast<std::uint32_t>(layers * side * side);
    if (volumes <= 2 * how.most_cells) rows.push_back(measure(side, how));
  }
  return rows;
}

}  // namespace sightcell::bench
