// bench_agreement: do the hemicube sources see what rays see? Pixels whose polygon is another one than that of the
// rays, by scene and source: how many lie in the same place (rule 2 of seeing), how many have an edge through their
// center, and what is left. It judges nothing: it prints.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <iostream>
#include <map>

#include "agreement/agreement.h"
#include "bench/hemicube/poses.h"
#include "bench/hemicube/scenes.h"
#include "bench/hemicube/world.h"
#include "hemicube/rays/rays_source.h"
#include "sightcell/base/error.h"

namespace {

using namespace sightcell::bench;
namespace bake = sightcell::bake;
using sightcell::test::agreement;
using sightcell::test::odd_pixel;

struct options {
  std::vector<std::string> scenes{"city100k", "vienna800k", "intel_castle", "candela_city", "oacmpctf3", "denhaag_01"};
  std::vector<std::string> sources;
  std::size_t poses = 34, odd = 5;
  std::uint32_t resolution = 1024;
  std::uint64_t seed = 1;
  bool quick = false;
  std::string json_file;
};

// Every second pose turned about all axes: edges of houses are parallel to rows and columns in the others.
std::vector<bake::pose> poses_of(const bench_scene& scene, const options& how, std::string& cells) {
  const json made = make_poses(
      {{"scene", scene.file.string()}, {"cells", scene.cells.string()}, {"poses", how.poses}, {"seed", how.seed}});
  cells = made.at("cells").get<std::string>();
  std::vector<bake::pose> poses = read_poses(made.at("heights").at("street"));
  for (std::size_t i = 1; i < poses.size(); i += 2) {
    bake::pose& p = poses[i];
    const float pitch = 0.21f, roll = 0.13f;
    const glm::vec3 forward = std::cos(pitch) * p.forward + std::sin(pitch) * p.up;
    const glm::vec3 up = glm::normalize(glm::cross(p.right, forward));
    p.right = glm::normalize(std::cos(roll) * p.right + std::sin(roll) * up);
    p.forward = glm::normalize(forward);
    p.up = glm::cross(p.right, p.forward);
  }
  return poses;
}

// Pixels of polygons that hide nothing: the image does not show them, the view counts them.
struct see_through {
  std::uint64_t pixels = 0, different = 0;
};

see_through compare_see_through(const world& w, const bake::hemicube_view& rays, const bake::hemicube_view& tested) {
  std::map<std::uint32_t, std::int64_t> more;
  see_through found;
  for (const bake::seen_polygon& p : rays.seen) {
    if (w.geometry.kinds[p.id].occludes()) continue;
    found.pixels += p.pixels;
    more[p.id] += p.pixels;
  }
  for (const bake::seen_polygon& p : tested.seen)
    if (!w.geometry.kinds[p.id].occludes()) more[p.id] -= p.pixels;
  for (const auto& [id, pixels] : more) found.different += static_cast<std::uint64_t>(std::abs(pixels));
  return found;
}

struct result {
  std::string scene, source, device, cells;
  std::uint32_t polygons = 0;
  std::size_t poses = 0;
  agreement found;
  see_through glass;
  std::vector<odd_pixel> odd;
};

std::string name_of(std::uint32_t polygon) {
  return polygon == bake::no_polygon ? "nothing" : std::to_string(polygon);
}

void measure(const bench_scene& scene, const options& how, std::vector<result>& results) {
  const world w(scene.file.string());
  const bake::ray_scene rays(w.geometry, false);
  std::string cells;
  const std::vector<bake::pose> poses = poses_of(scene, how, cells);
  const auto truth = bake::make_rays_source(rays, {.resolution = how.resolution, .far_plane = w.far_plane});
  std::vector<named_source> sources;
  const std::size_t first = results.size();
  for (const std::string& name : how.sources) {
    try {
      sources.push_back(make_source(name, w, how.resolution));
    } catch (const sightcell::error& e) {
      say(name + " is skipped: " + e.what());
      continue;
    }
    results.push_back(
        {scene.name, name, sources.back().source->device(), cells, w.polygons(), poses.size(), {}, {}, {}});
  }
  say(fmt::format("{}: {} poses, {}", scene.name, poses.size(), cells));
  bake::hemicube_view rays_view, source_view;
  for (const bake::pose& from : poses) {
    truth->render(from, rays_view);
    for (std::size_t i = 0; i < sources.size(); ++i) {
      sources[i].source->render(from, source_view);
      const see_through glass = compare_see_through(w, rays_view, source_view);
      results[first + i].glass.pixels += glass.pixels;
      results[first + i].glass.different += glass.different;
    }
  }
  bake::hemicube_image of_rays, of_source;
  for (const bake::pose& from : poses) {
    truth->render_image(from, of_rays);
    for (std::size_t i = 0; i < sources.size(); ++i) {
      result& r = results[first + i];
      sources[i].source->render_image(from, of_source);
      r.found.add(sightcell::test::compare(rays, from, of_rays, of_source, r.odd));
    }
  }
}

void print(const std::vector<result>& results, const options& how) {
  fmt::print("Pixels whose polygon is not that of rays, {}^2.\n\n", how.resolution);
  fmt::print(
      "| scene | polygons | poses | source | pixels | differ | same place | rest | share of all | at an edge | "
      "elsewhere | "
      "other depth | see-through pixels | of these differ "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::map<std::string, agreement> all;
  for (const result& r : results) {
    const agreement& a = r.found;
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {:.1e} | {} | {} | {} | {} | {} |\n", r.scene, r.polygons,
               r.poses, r.source, a.pixels, a.different, a.coincident, a.wrong(), a.share(), a.at_edge, a.elsewhere(),
               a.depths, r.glass.pixels, r.glass.different);
    all[r.source].add(a);
  }
  for (const auto& [source, a] : all)
    fmt::print("\n{}: {} of {} pixels, {:.2e}; not at an edge: {}", source, a.wrong(), a.pixels, a.share(),
               a.elsewhere());
  fmt::print("\n");
  for (const result& r : results) {
    for (std::size_t i = 0; i < r.odd.size() && i < how.odd; ++i) {
      const odd_pixel& o = r.odd[i];
      const glm::vec3 &e = o.from.eye, &f = o.from.forward, &u = o.from.up;
      fmt::print(
          "\n{}, {}: pixel {} from ({:.9g} {:.9g} {:.9g}), forward ({:.9g} {:.9g} {:.9g}), up ({:.9g} {:.9g} {:.9g}): "
          "rays see {} in {:.7g} m, {} sees {} in {:.7g} m, as rays do {} pixels beside; outlines {:.4f} and {:.4f} "
          "pixels away",
          r.scene, r.source, o.pixel, e.x, e.y, e.z, f.x, f.y, f.z, u.x, u.y, u.z, name_of(o.of_rays), o.depth_of_rays,
          r.source, name_of(o.of_source), o.depth_of_source, o.beside, o.outline_of_rays, o.outline_of_source);
    }
  }
  fmt::print("\n");
}

json facts_of(const std::vector<result>& results, const options& how) {
  json list = json::array();
  for (const result& r : results) {
    const agreement& a = r.found;
    list.push_back({{"scene", r.scene},
                    {"polygons", r.polygons},
                    {"cells", r.cells},
                    {"poses", r.poses},
                    {"source", r.source},
                    {"device", r.device},
                    {"pixels", a.pixels},
                    {"different", a.different},
                    {"coincident", a.coincident},
                    {"rest", a.wrong()},
                    {"share", a.share()},
                    {"at_edge", a.at_edge},
                    {"elsewhere", a.elsewhere()},
                    {"depths", a.depths},
                    {"see_through_pixels", r.glass.pixels},
                    {"see_through_different", r.glass.different}});
  }
  return {{"resolution", how.resolution}, {"seed", how.seed}, {"results", list}};
}

int run(const options& how) {
  std::vector<result> results;
  for (const std::string& name : how.scenes)
    if (const auto scene = find_scene(name)) measure(*scene, how, results);
  print(results, how);
  if (!how.json_file.empty()) {
    std::ofstream out(how.json_file);
    out << facts_of(results, how).dump(1) << '\n';
    if (!out.flush()) {
      say(how.json_file + ": cannot be written; choose another --json-file");
      return 1;
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  options how;
  for (const std::string& name : source_names())
    if (name != "rays") how.sources.push_back(name);
  CLI::App app("Compares the pixels of hemicube sources with rays", "bench_agreement");
  app.add_option("--scenes,--scene", how.scenes, "names or files");
  app.add_option("--sources", how.sources, "of those compiled in")->check(CLI::IsMember(source_names()));
  app.add_option("--poses", how.poses, "per scene")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--resolution", how.resolution, "pixels along a face, even")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app.add_option("--seed", how.seed, "of the poses")->capture_default_str();
  app.add_option("--odd", how.odd, "print so many pixels that nothing explains")->capture_default_str();
  app.add_flag("--quick", how.quick, "a small town, 3 poses, 256 pixels, if not said otherwise");
  app.add_option("--json-file", how.json_file, "write the figures there");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  if (how.quick) {
    if (app.count("--scenes") == 0) how.scenes = {small_town};
    if (app.count("--poses") == 0) how.poses = 3;
    if (app.count("--resolution") == 0) how.resolution = 256;
  }
  try {
    return run(how);
  } catch (const std::exception& e) {
    say(e.what());
    return 1;
  }
}
