#include "generated_city.h"

namespace sightcell::test {
namespace {

constexpr std::uint32_t side = 20;            // houses and cells per side of the city
constexpr std::uint32_t storeys = 2;          // layers of cells
constexpr std::uint32_t house_polygons = 96;  // of a house: walls, then a roof, then small parts
constexpr std::uint32_t wall_end = 40;
constexpr std::uint32_t roof_end = 60;

// Pseudo-random numbers with integer arithmetic only (the finalizer of splitmix64).
std::uint32_t mix(std::uint64_t number) {
  number += 0x9E3779B97F4A7C15u;
  number = (number ^ number >> 30) * 0xBF58476D1CE4E5B9u;
  number = (number ^ number >> 27) * 0x94D049BB133111EBu;
  return static_cast<std::uint32_t>((number ^ number >> 31) >> 16);
}

std::uint32_t distance(std::uint32_t a, std::uint32_t b) {
  return a > b ? a - b : b - a;
}

bool sees(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t house, std::uint32_t polygon) {
  const std::uint32_t dx = distance(x, house % side);
  const std::uint32_t dz = distance(z, house / side);
  const std::uint32_t far = dx + dz;
  const std::uint32_t chance = mix(std::uint64_t{polygon} << 32 | (x / 2) << 20 | (z / 2) << 8 | y) % 100;
  if (far <= 1) return polygon % house_polygons < wall_end || chance < 70;
  if (dx <= 1 || dz <= 1) return polygon % house_polygons < wall_end && chance < 40 / far + 2;  // along a street
  return y > 0 && polygon % house_polygons >= wall_end && polygon % house_polygons < roof_end && chance < 4;
}

void add_houses(sample_contents& contents) {
  std::uint32_t next = 0;
  for (std::uint32_t house = 0; house < side * side; ++house) {
    const std::uint32_t parts = 1 + mix(house) % 3;
    for (std::uint32_t part = 0; part < parts; ++part) {
      format::draw_record d;
      d.node = house;
      d.mesh = mix(house) % 17;
      d.primitive = part;
      d.instance = house % 4;
      d.material = part == 2 ? 0xFFFFFFFFu : part;
      d.first_source = d.first_stored = next;
      d.polygon_count = part + 1 == parts ? house_polygons - part * 30 : 30;
      d.base_vertex = 2 * next;
      d.host_tag = std::uint64_t{house} << 40 | part;
      next += d.polygon_count;
      contents.draws.push_back(d);
    }
  }
  contents.facts.polygon_count = next;
}

}  // namespace

sample_contents generated_city() {
  sample_contents contents;
  add_houses(contents);
  contents.facts.margin = 0.1f;
  contents.facts.max_pixel_error = 0.003f;
  for (std::uint32_t i = 0; i < 16; ++i) contents.facts.scene_fingerprint[i] = static_cast<std::uint8_t>(mix(i));
  contents.settings = "{\"scene\":\"generated\"}";
  for (std::uint32_t cell = 0; cell < side * side * storeys; ++cell) {
    const std::uint32_t x = cell % side;
    const std::uint32_t z = cell / side % side;
    const std::uint32_t y = cell / (side * side);
    // Borders that are not exact as floats. Adjacent cells share the rounded number.
    const auto border = [](std::uint32_t step) { return 0.7f * static_cast<float>(step) - 5.3f; };
    contents.cells.push_back({{border(x), border(y), border(z)}, {border(x + 1), border(y + 1), border(z + 1)}});
    std::vector<std::uint32_t> set;
    for (std::uint32_t polygon = 0; polygon < contents.facts.polygon_count; ++polygon) {
      if (sees(x, y, z, polygon / house_polygons, polygon)) set.push_back(polygon);
    }
    contents.sets.push_back(std::move(set));
    const std::uint64_t rays = 1000 + mix(cell) % 100000;
    contents.certificate.push_back({cell, rays, cell % 3, 3.0 / static_cast<double>(rays), 0.95, mix(cell + 7)});
  }
  put_in_order(contents, 3);
  return contents;
}

}  // namespace sightcell::test
