// What each sampler finds, and with how much: every sampler has to find what is hidden within the effort that
// tests/bench/results/gap_scenes.csv tells, and must not be able to with far less, or the scene would show nothing of
// the method.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <ostream>
#include <string>

#include "hemicube/choice/choose_source.h"
#include "hemicube/surface_colors.h"
#include "sampler/cell_sampler.h"
#include "search/near_polygons.h"
#include "trace/ray_scene.h"
#include "unit/bake/search/gap_scenes.h"
#include "unit/case_step.h"

namespace sightcell::bake {
namespace {

// Scenes of each kind: 20 in a complete run.
int variants() {
  return test::case_step() == 1 ? 20 : 6;
}

struct finding {
  const char* sampler;
  const char* name;  // of the scene
  test::gap_scene (*scene)(std::uint64_t variant);
  std::uint64_t effort;  // hemicubes, or rays
  int few;               // with a sixteenth of it, at most; half of the scenes where they are few
};

std::ostream& operator<<(std::ostream& out, const finding& f) {
  return out << f.sampler << " in " << f.name;
}

bool finds(const finding& f, std::uint64_t effort, std::uint64_t variant) {
  const test::gap_scene where = f.scene(variant);
  settings how;
  how.sampler = f.sampler;
  how.source = "cpu";
  how.resolution = 96;
  how.seed = variant + 1;
  how.samples = static_cast<std::uint32_t>(effort);
  how.sampling_rays = effort;
  how.rays_per_round = 128;
  const scene::world_geometry geometry = scene::flatten(where.scene, scene::animated_as::always);
  const ray_scene rays(geometry, false);
  const chosen_source chosen = choose_source(how, geometry, rays);
  const surface_colors colors(where.scene, geometry);
  how.margin = 0.0f;  // the cell is as it is
  how.max_pixel_error = 0.0;
  const near_polygons neighbors(rays);
  std::vector<box> boxes = where.beside;
  boxes.push_back(where.cell);
  std::vector<view_cell> cells(boxes.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    cells[i].min = boxes[i].min, cells[i].max = boxes[i].max, cells[i].place = 1000 * i + variant;
  const auto sampler = make_cell_sampler(how, {rays, *chosen.source, &colors, cells, &neighbors});
  sampler->prepare([](double) { return true; });
  return std::all_of(cells.begin(), cells.end(), [&](const view_cell& cell) {
    cell_set set(static_cast<std::uint32_t>(geometry.kinds.size()));
    const std::vector<glm::vec3> free{0.5f * (cell.min + cell.max)};
    (void)sampler->sample({{cell.min, cell.max}, cell.place, false, free}, set);
    return std::any_of(where.hidden.begin(), where.hidden.end(), [&](std::uint32_t p) { return set.contains(p); });
  });
}

int found(const finding& f, std::uint64_t effort) {
  int count = 0;
  for (int variant = 0; variant < variants(); ++variant)
    count += finds(f, effort, static_cast<std::uint64_t>(variant)) ? 1 : 0;
  return count;
}

class gap_scenes_of : public testing::TestWithParam<finding> {};

TEST_P(gap_scenes_of, are_found_with_the_documented_effort_and_not_with_far_less) {
  const finding& f = GetParam();
  const int enough = found(f, f.effort), little = found(f, f.effort / 16);
  // In what --gtest_output writes: for tests/bench/results/gap_scenes.csv.
  RecordProperty("with_effort", enough);
  RecordProperty("with_a_sixteenth", little);
  EXPECT_GE(enough, variants() - 1) << f.effort << " find it";
  EXPECT_LE(little, std::min(f.few, variants() / 2)) << f.effort / 16 << " do not";
}

// A sampler joins by rows here and in tests/bench/results/gap_scenes.csv.
constexpr finding findings[] = {
    {"importance-depth", "slit", test::slit, 192, 3},
    {"importance-depth", "window", test::window, 192, 3},
    {"importance-depth", "crack", test::crack, 192, 3},
    {"importance-depth-color", "slit", test::slit, 192, 3},
    {"importance-depth-color", "window", test::window, 192, 3},
    {"importance-depth-color", "crack", test::crack, 192, 3},
    {"nir04", "window", test::window, 384, 3},
    {"nir04", "crack", test::crack, 192, 3},
    {"uniform", "slit", test::slit, 384, 6},
    {"uniform", "window", test::window, 768, 6},
    {"guided", "slit", test::slit, 192, 6},
    {"guided", "window", test::window, 768, 6},
    {"halton", "slit", test::slit, 192, 6},
    {"halton", "window", test::window, 768, 6},
    {"gvs", "tile_behind_window", test::tile_behind_window, 2048, 3},
    {"gvs", "tile_behind_plate", test::tile_behind_plate, 2048, 3},
    {"gvs++", "tile_behind_window", test::tile_behind_window, 2048, 3},
    {"gvs++", "tile_behind_plate", test::tile_behind_plate, 2048, 3},
    {"agvs", "corridor", test::corridor, 32, 6},
};

INSTANTIATE_TEST_SUITE_P(samplers, gap_scenes_of, testing::ValuesIn(findings), [](const auto& row) {
  std::string name = std::string(row.param.sampler) + "_" + row.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  std::replace(name.begin(), name.end(), '+', 'p');
  return name;
});

}  // namespace
}  // namespace sightcell::bake
