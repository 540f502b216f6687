// libFuzzer target: the import of hostile scenes, and what stands on it. Nothing but sightcell::error may come out, in
// one line; what is let in keeps its promises.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "gltf_mutation.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace {

using namespace sightcell;

// Instances multiply; flattening them all is a matter of memory, not of faults.
constexpr std::uint32_t flatten_limit = 1u << 18;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz_load_gltf: %s\n", what);
  std::abort();
}

void check_one_line(const error& e) {
  const std::string line = e.what();
  require(line.find('\n') == std::string::npos && line.size() < 1000, "an error is one short line");
  require(line.starts_with("fuzz: ") && line.ends_with("[" + e.id() + "]"), "an error names file and id");
}

void check_draws(const scene::scene& s) {
  std::uint64_t polygons = 0;
  for (const scene::draw& d : s.draws) {
    require(d.first_source == polygons && d.polygon_count > 0, "draws follow each other");
    require(
        scene::draw_of(s, d.first_source) == static_cast<std::uint32_t>(&d - s.draws.data()) &&
            scene::draw_of(s, d.first_source + d.polygon_count - 1) == static_cast<std::uint32_t>(&d - s.draws.data()),
        "draw_of finds the draw");
    polygons += d.polygon_count;
  }
  require(polygons == s.polygon_count, "draws are all polygons");
}

void check_world(const scene::scene& s, const scene::world_geometry& w) {
  require(w.kinds.size() == s.polygon_count && w.indices.size() == 3 * w.kinds.size(), "every polygon is flattened");
  for (const std::uint32_t index : w.indices) require(index < w.positions.size(), "corners exist");
  for (const glm::vec3& p : w.positions) {
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "positions are finite");
  }
  for (const scene::masked_polygon& m : w.masked) {
    require(m.id < w.kinds.size() && w.kinds[m.id].alpha_tested && m.mask < w.masks.size(), "masked polygons exist");
    for (const glm::vec2& uv : m.uvs) require(std::isfinite(w.masks[m.mask].alpha(uv)), "alpha can be asked for");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const scene::scene s = scene::load_gltf(std::as_bytes(std::span(data, size)), "fuzz");
    check_draws(s);
    if (s.polygon_count > flatten_limit || s.draws.size() > flatten_limit) return 0;
    for (const scene::animated_as how :
         {scene::animated_as::always, scene::animated_as::rest, scene::animated_as::dynamic})
      check_world(s, scene::flatten(s, how));
  } catch (const error& e) {
    check_one_line(e);
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  return fuzz::mutate_gltf(data, size, max_size, seed, LLVMFuzzerMutate);
}
