// sightcell-test-polygon-shares SCENE FILE.pvs CELL RAYS: which polygons the rays of a cell see, one line each: polygon
// and share of all rays, largest first. Together with sightcell-test-drop-polygon it breaks a file by a known amount.
// Other random numbers than verify's, so that what verify finds is found anew.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "bound/verification_rays.h"
#include "sightcell/bake/settings.h"
#include "sightcell/format/reader.h"
#include "unit/bake/file_bytes.h"

namespace {

using namespace sightcell;

bake::box grown_cell(const std::filesystem::path& path, std::uint32_t cell) {
  const std::vector<std::byte> bytes = test::file_bytes(path);
  format::reader file;
  format::box corners;
  if (format::reader::open(bytes, file) != format::status::ok || file.cell_box(cell, corners) != format::status::ok)
    throw std::runtime_error(path.string() + ": no .pvs file with that cell");
  const bake::box own{{corners.min[0], corners.min[1], corners.min[2]},
                      {corners.max[0], corners.max[1], corners.max[2]}};
  return own.grown(file.facts().margin);
}

void print_shares(const char* scene_path, const char* file, std::uint32_t cell, std::uint64_t count) {
  const scene::scene s = scene::load_gltf(scene_path);
  const scene::world_geometry geometry = scene::flatten(s);
  const bake::ray_scene rays(geometry, false);
  const bake::verification_batch batch = bake::cast_verification_rays(rays, grown_cell(file, cell), {}, count,
                                                        {.seed = 777, .place = cell, .use = bake::purpose::estimate},
                                                        [](std::uint32_t) { return false; });
  std::map<std::uint32_t, std::uint64_t> hits;
  for (const bake::missed_polygon& seen : batch.missed) ++hits[seen.polygon];
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (const auto& [polygon, times] : hits) order.emplace_back(times, polygon);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [times, polygon] : order)
    std::printf("%u %.3e\n", polygon, static_cast<double>(times) / static_cast<double>(batch.rays));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: sightcell-test-polygon-shares SCENE FILE.pvs CELL RAYS\n");
    return 2;
  }
  try {
    print_shares(argv[1], argv[2], static_cast<std::uint32_t>(std::stoul(argv[3])), std::stoull(argv[4]));
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
