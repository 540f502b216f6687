#include "bench/gpu_counters/pace.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>

#include "cells/cells_file.h"
#include "sightcell/base/process_time.h"

namespace sightcell::bench {
namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void render(bake::hemicube_source& source, const std::vector<bake::pose>& poses, std::size_t at_once,
            std::vector<bake::hemicube_view>& views) {
  views.resize(poses.size());
  for (std::size_t first = 0; first < poses.size(); first += at_once) {
    const std::size_t count = std::min(at_once, poses.size() - first);
    source.render(std::span(poses).subspan(first, count), std::span(views).subspan(first, count));
  }
}

// Renders one by one, because the stages of hemicubes in flight would overlap.
std::vector<bake::gpu_timeline::stage> stages_of(bake::hemicube_source& source, bake::gpu_timeline& timeline,
                                                 const std::vector<bake::pose>& poses) {
  std::vector<bake::hemicube_view> views;
  timeline.enable();
  render(source, poses, 1, views);
  std::vector<bake::gpu_timeline::stage> stages = timeline.stages();
  for (bake::gpu_timeline::stage& s : stages) s.seconds /= static_cast<double>(poses.size());
  return stages;
}

pace measure(bake::hemicube_source& source, const std::vector<bake::pose>& poses, std::uint32_t at_once) {
  pace measured;
  measured.at_once = at_once;
  std::vector<bake::hemicube_view> views;
  render(source, poses, at_once, views);  // the first row pays for compiling and uploading
  GLuint query = 0;
  glCreateQueries(GL_PRIMITIVES_GENERATED, 1, &query);
  glBeginQuery(GL_PRIMITIVES_GENERATED, query);
  render(source, poses, at_once, views);
  glEndQuery(GL_PRIMITIVES_GENERATED);
  GLuint64 triangles = 0;
  glGetQueryObjectui64v(query, GL_QUERY_RESULT, &triangles);
  glDeleteQueries(1, &query);
  const auto count = static_cast<double>(poses.size());
  measured.triangles_per_sample = static_cast<double>(triangles) / count;
  for (const bake::hemicube_view& view : views) measured.polygons_seen += static_cast<double>(view.seen.size()) / count;
  for (int i = 0; i < 3; ++i) {
    const double start = seconds_now(), cpu_start = bake::process_cpu_seconds();
    render(source, poses, at_once, views);
    const double cpu_ms = 1e3 * (bake::process_cpu_seconds() - cpu_start) / count;
    measured.cpu_ms_per_sample = i == 0 ? cpu_ms : std::min(measured.cpu_ms_per_sample, cpu_ms);
    measured.samples_per_second = std::max(measured.samples_per_second, count / std::max(seconds_now() - start, 1e-9));
  }
  return measured;
}

}  // namespace

std::vector<bake::pose> poses_in(const std::filesystem::path& cells, std::size_t count) {
  const std::vector<bake::view_cell> found = bake::read_cells_file(cells);
  std::vector<bake::pose> poses;
  for (std::size_t i = 0; i < count && !found.empty(); ++i) {
    // Cells evenly spread over the list, headings a golden angle apart.
    const std::size_t cells_used = std::min((count + 7) / 8, found.size());
    const std::size_t cell = i / 8 % cells_used * found.size() / cells_used;
    const glm::vec3 low = found[cell].min, high = found[cell].max;
    const float step = static_cast<float>(i % 8) / 8.0f - 0.44f, angle = 2.39996f * static_cast<float>(i / 8);
    bake::pose p;
    p.eye = 0.5f * (low + high) + step * 0.5f * glm::vec3(high.x - low.x, 0.0f, high.z - low.z);
    p.forward = {std::cos(angle), 0.0f, std::sin(angle)};
    p.right = glm::cross(p.forward, p.up);
    poses.push_back(p);
  }
  return poses;
}

std::vector<pace> measure_paces(const picture::gl_context& context, const scene::world_geometry& world,
                                const std::vector<bake::pose>& poses, std::uint32_t resolution,
                                const std::string& gather, const std::string& culling) {
  std::vector<pace> all;
  const float far_plane = glm::distance(world.min, world.max);
  for (const auto& [how, gather_name] :
       {std::pair{bake::gather::compute, "compute"}, std::pair{bake::gather::read_back, "read_back"}}) {
    if (gather != "all" && gather != gather_name) continue;
    for (const auto& [hide, hide_name] :
         {std::pair{bake::culling::none, "none"}, std::pair{bake::culling::frustum, "frustum"},
          std::pair{bake::culling::occlusion, "occlusion"}}) {
      if (culling != "all" && culling != hide_name) continue;
      if (hide == bake::culling::occlusion && !bake::can_cull_on_device()) continue;
      bake::gpu_timeline timeline;
      const auto source = bake::make_gpu_source(
          context, world,
          {.resolution = resolution, .far_plane = far_plane, .how = how, .hide = hide, .timeline = &timeline});
      for (const std::uint32_t at_once : {1u, 16u}) {
        if (at_once > 1 && how == bake::gather::read_back) continue;
        pace measured = measure(*source, poses, at_once);
        measured.culling = hide_name;
        measured.gather = gather_name;
        all.push_back(measured);
      }
      if (how == bake::gather::compute) all.back().stages = stages_of(*source, timeline, poses);
    }
  }
  return all;
}

}  // namespace sightcell::bench
