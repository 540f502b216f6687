// stream_truth SCENE FILE.pvs OUT [--poses N] [--seed N] [--resolution N]: what is visible from random poses in the
// cells of a file, for bench_streaming.py. A pose is a valid viewpoint of a random cell, with a random heading. All
// cells are equally likely, and so are all valid viewpoints of a cell.
//
// OUT: a file of poses (pose_file.h). Two hemicubes back to back show all directions.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <iostream>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hemicube/cpu/cpu_source.h"
#include "hemicube/hemicube_faces.h"
#include "pose_file.h"
#include "sightcell/base/error.h"
#include "sightcell/base/random.h"
#include "sightcell/scene/scene.h"
#include "trace/viewpoints.h"
#include "verify/verified_file.h"

static_assert(std::endian::native == std::endian::little);

namespace {

using namespace sightcell;

constexpr std::size_t views = bench::views_of_pose, tiles_across = bench::tiles_across, tiles_up = bench::tiles_up;
constexpr std::uint64_t tries_of_a_cell = 1u << 14;
// A use of random numbers that is none of a bake.
constexpr std::uint64_t place_of_cells = 0x53545245414Dull;

struct options {
  std::string scene, file, out;
  std::uint32_t poses = 200, resolution = 512;
  std::uint64_t seed = 1;
};

using angles = std::array<double, 1 + views>;
// The largest depth of each tile of each view.
using tile_depths = std::array<std::array<float, tiles_across * tiles_up>, views>;

// Where a direction is in a view.
struct place_in_view {
  std::uint16_t tile = 0;
  float depth = 0.0f;  // along the axis of the view, of the point at the distance 1 along the axis of the face
};

// What the pixels of a pair of hemicubes count for. A heading only turns the hemicubes, so it is the same for all
// poses.
class pixel_angles {
 public:
  explicit pixel_angles(std::uint32_t resolution) : resolution_(resolution) {
    for (const float side : {1.0f, -1.0f}) {
      const bake::pose level = looking(glm::vec3(0.0f), 0.0f, side);
      for (std::uint32_t pixel = 0; pixel < 3 * resolution * resolution; ++pixel) {
        const glm::dvec3 way(bake::pixel_direction(level, resolution, pixel));
        // A pixel of size a at the distance 1 / c of its face has the angle a^2 c^3. c is the largest coordinate,
        // because the faces are those of a cube.
        const double c = std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
        const double size = 2.0 / resolution;
        whole_.push_back(size * size * c * c * c);
        views_.push_back(views_of(way / c));
      }
    }
  }

  // side: 1 along the heading, -1 the other way.
  static bake::pose looking(const glm::vec3& eye, float heading, float side) {
    const glm::vec3 up{0.0f, 1.0f, 0.0f};
    const glm::vec3 forward{side * std::sin(heading), 0.0f, -side * std::cos(heading)};
    return {eye, forward, glm::cross(forward, up), up};
  }

  // Adds what an image shows. half: 0 along the heading, 1 the other way.
  void add(const bake::hemicube_image& image, std::size_t half, std::map<std::uint32_t, angles>& sums,
           tile_depths& depths) const {
    const std::size_t pixels = 3 * std::size_t{resolution_} * resolution_;
    std::uint32_t last = scene::no_index;
    angles* known = nullptr;
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      const std::size_t at = half * pixels + pixel;
      for (std::size_t view = 0; view < views; ++view) {
        const auto& where = views_[at][view];
        if (!where) continue;
        float& depth = depths[view][where->tile];
        depth = std::max(depth, where->depth / image.inverse_depths[pixel]);  // x / 0 is infinite
      }
      if (image.ids[pixel] == scene::no_index) continue;
      // Neighbors mostly show the same polygon.
      if (image.ids[pixel] != last) {
        last = image.ids[pixel];
        known = &sums[last];
      }
      angles& sum = *known;
      sum[0] += whole_[at];
      for (std::size_t view = 0; view < views; ++view)
        if (views_[at][view]) sum[1 + view] += whole_[at];
    }
  }

 private:
  using places = std::array<std::optional<place_in_view>, views>;

  // Nothing where a view does not contain the direction. A view that is turned by 90 degrees looks to the right of the
  // last.
  static places views_of(const glm::dvec3& way) {
    const double high = std::tan(std::numbers::pi / 6.0), wide = high * 16.0 / 9.0;
    const std::array<glm::dvec3, views> ahead{{{0, 0, -1}, {1, 0, 0}, {0, 0, 1}, {-1, 0, 0}}};
    places found;
    for (std::size_t view = 0; view < views; ++view) {
      const double depth = glm::dot(way, ahead[view]), right = glm::dot(way, ahead[(view + 1) % views]);
      if (!(depth > 0.0 && std::abs(right) < wide * depth && std::abs(way.y) < high * depth)) continue;
      const auto x = static_cast<std::size_t>((right / (wide * depth) + 1.0) / 2.0 * tiles_across);
      const auto y = static_cast<std::size_t>((way.y / (high * depth) + 1.0) / 2.0 * tiles_up);
      const std::size_t tile = std::min(y, tiles_up - 1) * tiles_across + std::min(x, tiles_across - 1);
      found[view] = {static_cast<std::uint16_t>(tile), static_cast<float>(depth)};
    }
    return found;
  }

  std::uint32_t resolution_;
  std::vector<double> whole_;
  std::vector<places> views_;
};

struct place {
  glm::vec3 eye;
  float heading;
  std::uint32_t cell;
};

bool contains(const bake::box& b, const glm::vec3& p) {
  return glm::all(glm::lessThanEqual(b.min, p)) && glm::all(glm::lessThan(p, b.max));
}

// A pose of the file; nothing where the chosen cell has hardly any valid viewpoint of its own.
std::optional<place> choose(const bake::verified_file& opened, bake::random_stream& random) {
  const auto cell = static_cast<std::uint32_t>(random.bits() % opened.file().cell_count());
  const bake::viewpoint_region region = opened.region(cell);
  const bake::box own = opened.cell_box(cell);
  for (std::uint64_t tries = 0; tries < tries_of_a_cell;) {
    const std::vector<glm::vec3> found =
        bake::draw_viewpoints(opened.rays(), region, opened.rules().player_radius, 1, tries_of_a_cell, random, tries);
    // The region has a margin around the cell, where a client is in another cell.
    if (!found.empty() && contains(own, found.front()))
      return place{found.front(), 2.0f * std::numbers::pi_v<float> * random.uniform(), cell};
  }
  return std::nullopt;
}

template <typename T>
void put(std::ofstream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void write_pose(std::ofstream& out, const place& at, const std::map<std::uint32_t, angles>& sums,
                const tile_depths& depths) {
  put(out, at.eye);
  put(out, at.heading);
  put(out, at.cell);
  put(out, static_cast<std::uint32_t>(sums.size()));
  for (const auto& [id, sum] : sums) put(out, id);
  for (const auto& [id, sum] : sums)
    for (const double angle : sum) put(out, static_cast<float>(angle));
  put(out, depths);
}

void run(const options& how) {
  const scene::scene loaded = scene::load_gltf(how.scene);
  std::ifstream in(how.file, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  bake::verified_file opened(loaded, nullptr, std::as_bytes(std::span(bytes)), how.file);
  opened.build_rays();
  const scene::world_geometry& geometry = opened.rays().geometry();
  const auto source = bake::make_cpu_source(
      geometry, {.resolution = how.resolution, .far_plane = glm::distance(geometry.min, geometry.max)});
  const pixel_angles pixels(how.resolution);
  std::ofstream out(how.out, std::ios::binary);
  out.write("SIGHTPOS", 8);
  put(out, bench::pose_file_version);
  put(out, how.poses);
  bake::hemicube_image image;
  std::uint32_t written = 0;
  for (std::uint64_t number = 0; written < how.poses; ++number) {
    // Numbers of a pose depend on its number alone, so that more poses begin with the same ones.
    bake::random_stream random(how.seed, place_of_cells, bake::purpose::viewpoints, 0, number);
    const std::optional<place> at = choose(opened, random);
    if (!at) continue;
    std::map<std::uint32_t, angles> sums;
    tile_depths depths{};
    for (const std::size_t half : {0u, 1u}) {
      source->render_image(pixel_angles::looking(at->eye, at->heading, half == 0 ? 1.0f : -1.0f), image);
      pixels.add(image, half, sums, depths);
    }
    write_pose(out, *at, sums, depths);
    ++written;
  }
  out.close();
  if (!out) throw error(error_kind::failed, "bench.nothing", how.out, "cannot be written", "choose another file");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What is visible from random poses in the cells of a file.");
  options how;
  app.add_option("SCENE", how.scene)->required();
  app.add_option("FILE", how.file)->required();
  app.add_option("OUT", how.out)->required();
  app.add_option("--poses", how.poses)->check(CLI::Range(1, 100000));
  app.add_option("--seed", how.seed);
  app.add_option("--resolution", how.resolution)->check(CLI::Range(16, 4096));
  CLI11_PARSE(app, argc, argv);
  try {
    run(how);
  } catch (const std::exception& e) {
    std::cerr << "stream_truth: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
