#include "benchmark.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sightcell/base/error.h"

namespace viewer {
namespace {

// Of all threads.
double cpu_milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double cost_of_scene(session& s, bool pvs, const options& chosen) {
  const double begin = cpu_milliseconds();
  s.draw_scene(pvs, chosen.width, chosen.height);
  glFinish();
  return cpu_milliseconds() - begin;
}

}  // namespace

void run_benchmark(session& s, const std::vector<path_pose>& path, const options& chosen) {
  std::ofstream out(chosen.benchmark, std::ios::binary | std::ios::trunc);
  out << "pose,x,y,z,yaw,pitch,cell,polygons,ranges,calls,move_us,culled_cpu_ms,all_polygons,all_cpu_ms,wrong_pixels\n";
  std::uint64_t polygons = 0, all_polygons = 0, wrong_pixels = 0, changes = 0;
  double culled_ms = 0.0, all_ms = 0.0;
  std::uint32_t last_cell = SIGHTCELL_NO_CELL;
  s.go_to(path.front().camera);
  for (const bool pvs : {true, false}) (void)cost_of_scene(s, pvs, chosen);  // shaders and textures get ready
  for (std::size_t i = 0; i < path.size(); ++i) {
    s.go_to(path[i].camera);
    const double culled = cost_of_scene(s, true, chosen);
    const frame_facts drawn = s.facts();
    const sightcell_frame frame = s.here();
    const double move = s.move_milliseconds();
    const double all = cost_of_scene(s, false, chosen);
    const std::uint64_t everything = s.facts().polygons_drawn;
    const std::uint64_t wrong = s.count_wrong_pixels(chosen.width, chosen.height);
    const fly_camera& c = path[i].camera;
    const std::string cell = frame.cell == SIGHTCELL_NO_CELL ? "" : std::to_string(frame.cell);
    out << fmt::format("{},{},{},{},{},{},{},{},{},{},{:.2f},{:.3f},{},{:.3f},{}\n", i, c.eye.x, c.eye.y, c.eye.z,
                       c.yaw, c.pitch, cell, drawn.polygons_drawn, drawn.ranges_drawn, drawn.calls, 1e3 * move, culled,
                       everything, all, wrong);
    if (i > 0 && frame.cell != last_cell) ++changes;
    last_cell = frame.cell;
    polygons += drawn.polygons_drawn;
    all_polygons += everything;
    wrong_pixels += wrong;
    culled_ms += culled;
    all_ms += all;
  }
  out.flush();
  if (!out) {
    throw sightcell::error(sightcell::error_kind::failed, "viewer.path-not-written", chosen.benchmark,
                           "cannot be written", "name a file in a folder that can be written to");
  }
  const auto poses = static_cast<double>(path.size());
  const nlohmann::json sums{{"poses", path.size()},         {"cell_changes", changes},
                            {"polygons", polygons},         {"all_polygons", all_polygons},
                            {"wrong_pixels", wrong_pixels}, {"culled_cpu_ms", culled_ms / poses},
                            {"all_cpu_ms", all_ms / poses}};
  fmt::print("{}\n", sums.dump());
}

}  // namespace viewer
