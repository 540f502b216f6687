// OGRE as a host of Sightcell: draws a scene with and without its PVS, compares the pictures and counts. See README.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "cull_clusters.h"
#include "cull_list.h"
#include "cull_objects.h"
#include "host_error.h"
#include "importer.h"
#include "matched_scene.h"
#include "ogre_scene.h"
#include "stage.h"

namespace ogre_host {
namespace {

constexpr float default_radius = 0.05f;  // meters: the player radius of a file that does not state it

struct arguments {
  std::string scene_file, pvs_file, picture_file;
  std::vector<std::string> modes{"frustum", "objects", "list", "frustum-clusters", "clusters"};
  std::uint32_t eyes = 32, headings = 4, width = 640, height = 480;
  double max_wrong = 1e-4;
  bool json = false;
};

struct camera_position {
  Ogre::Vector3 eye;
  float yaw;
};

// Sums over all pictures of a mode.
struct totals {
  std::string mode;
  std::uint64_t batches = 0, triangles = 0, wrong = 0;
  double culling_seconds = 0.0, frame_seconds = 0.0;  // CPU time; a frame includes culling
};

// CPU time of all threads of this process, those of a software OpenGL included.
double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// A valid viewpoint of each of up to `eyes` cells spread over the file, and several headings at each.
std::vector<camera_position> find_cameras(const sightcell::db& db, const arguments& args) {
  std::vector<camera_position> out;
  const std::uint64_t cells = db.cell_count(), wanted = std::min<std::uint64_t>(args.eyes, cells);
  for (std::uint64_t i = 0; i < wanted; ++i) {
    const auto eye = db.cell_eye(static_cast<std::uint32_t>(i * cells / wanted));
    if (!eye) continue;
    for (std::uint32_t h = 0; h < args.headings; ++h) {
      const float turns = static_cast<float>(h) / static_cast<float>(args.headings) + 0.1f * static_cast<float>(i);
      out.push_back({Ogre::Vector3(eye->data()), turns * Ogre::Math::TWO_PI});
    }
  }
  if (out.empty()) {
    throw host_error("ogre.no-eye", args.pvs_file, "has no valid viewpoint of a cell", "bake the scene again");
  }
  return out;
}

// No corner of the near plane is farther from the eye than the player radius (docs/hosting.md).
float near_plane(const sightcell_info& info, const Ogre::Camera& camera) {
  const float radius = info.player_radius > 0.0f ? info.player_radius : default_radius;
  const float up = Ogre::Math::Tan(camera.getFOVy() * 0.5f), right = up * camera.getAspectRatio();
  return radius / std::sqrt(1.0f + up * up + right * right);
}

std::unique_ptr<culling> make_culling(const std::string& mode, const ogre_scene& scene, const matched_scene& matched,
                                      const imported_scene& host) {
  if (mode == "objects") return std::make_unique<cull_objects>(scene, matched);
  if (mode == "list") return std::make_unique<cull_list>(scene, matched, host);
  if (mode == "clusters") return std::make_unique<cull_clusters>(scene, matched, host, true);
  if (mode == "frustum-clusters") return std::make_unique<cull_clusters>(scene, matched, host, false);
  return nullptr;  // frustum: OGRE culls entities by itself
}

std::uint64_t differing_pixels(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < a.size(); i += 3) out += a[i] != b[i] || a[i + 1] != b[i + 1] || a[i + 2] != b[i + 2];
  return out;
}

using pictures = std::vector<std::vector<std::uint8_t>>;  // by camera

totals draw_all(stage& ogre, const std::vector<camera_position>& cameras, const pictures& expected, culling* cull) {
  totals out;
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    ogre.look(cameras[i].eye, cameras[i].yaw);
    const double begin = cpu_seconds();
    if (cull != nullptr) cull->update(ogre.camera());
    const double culled = cpu_seconds();
    const effort e = ogre.render(rgb);
    out.frame_seconds += cpu_seconds() - begin;
    out.culling_seconds += culled - begin;
    out.batches += e.batches;
    out.triangles += e.triangles;
    out.wrong += differing_pixels(rgb, expected[i]);
  }
  return out;
}

void print(const arguments& args, const matched_scene& matched, std::size_t picture_count,
           const std::vector<totals>& rows) {
  const double n = static_cast<double>(picture_count), pixels = n * args.width * args.height;
  if (!args.json) {
    fmt::print("{} triangles in {} entities, {} pictures of {} x {}; means per picture\n", matched.info.polygon_count,
               matched.draw_of_entity.size(), picture_count, args.width, args.height);
    fmt::print("{:<18}{:>10}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "mode", "draws", "triangles", "frame ms", "culling ms",
               "wrong", "of pixels");
  }
  std::string list;
  for (const totals& t : rows) {
    const double draws = static_cast<double>(t.batches) / n, triangles = static_cast<double>(t.triangles) / n;
    const double frame = 1e3 * t.frame_seconds / n, cull = 1e3 * t.culling_seconds / n;
    const double share = static_cast<double>(t.wrong) / pixels;
    if (!args.json) {
      fmt::print("{:<18}{:>10.1f}{:>12.1f}{:>12.2f}{:>12.3f}{:>12}{:>12.2e}\n", t.mode, draws, triangles, frame, cull,
                 t.wrong, share);
    }
    list += fmt::format(
        "{}{{\"mode\":\"{}\",\"draws\":{},\"triangles\":{},\"cpu_ms\":{},\"culling_cpu_ms\":{},"
        "\"wrong_pixels\":{},\"wrong_share\":{}}}",
        list.empty() ? "" : ",", t.mode, draws, triangles, frame, cull, t.wrong, share);
  }
  if (args.json) {
    fmt::print("{{\"triangles\":{},\"entities\":{},\"pictures\":{},\"width\":{},\"height\":{},\"modes\":[{}]}}\n",
               matched.info.polygon_count, matched.draw_of_entity.size(), picture_count, args.width, args.height, list);
  }
}

int run(const arguments& args) {
  const imported_scene host = import_for_drawing(args.scene_file);
  const matched_scene matched = match_scene(args.pvs_file, args.scene_file, host);
  stage ogre(args.width, args.height);
  ogre.set_near_plane(near_plane(matched.info, ogre.camera()));
  const ogre_scene scene(ogre.scene(), host);
  const std::vector<camera_position> cameras = find_cameras(matched.db, args);

  // What OGRE shows without Sightcell. These frames also load what OGRE and the driver load on first use.
  pictures expected(cameras.size());
  std::size_t richest = 0, most_triangles = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    ogre.look(cameras[i].eye, cameras[i].yaw);
    const effort e = ogre.render(expected[i]);
    if (e.triangles <= most_triangles) continue;
    richest = i;
    most_triangles = e.triangles;
  }
  std::vector<totals> rows;
  bool good = true;
  const double pixels = static_cast<double>(cameras.size()) * args.width * args.height;
  for (const std::string& mode : args.modes) {
    scene.draw_everything();
    const std::unique_ptr<culling> cull = make_culling(mode, scene, matched, host);
    rows.push_back(draw_all(ogre, cameras, expected, cull.get()));
    rows.back().mode = mode;
    good = good && static_cast<double>(rows.back().wrong) <= args.max_wrong * pixels;
    if (args.picture_file.empty() || &mode != &args.modes.back()) continue;
    draw_all(ogre, {cameras[richest]}, {expected[richest]}, cull.get());
    ogre.save(args.picture_file);
  }
  print(args, matched, cameras.size(), rows);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace ogre_host

int main(int argc, char** argv) {
  ogre_host::arguments args;
  CLI::App app("Draws a glTF scene in OGRE with its PVS, in several ways, and compares the pictures.");
  app.add_option("scene", args.scene_file, "The .glb or .gltf file")->required();
  app.add_option("pvs", args.pvs_file, "Its PVS, baked with --names")->required();
  app.add_option("--mode", args.modes, "Ways of culling, with commas between them")
      ->check(CLI::IsMember({"frustum", "objects", "list", "frustum-clusters", "clusters"}))
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--eyes", args.eyes, "Cells that pictures are drawn from")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--headings", args.headings, "Pictures in each of them")
      ->check(CLI::Range(1, 360))
      ->capture_default_str();
  app.add_option("--width", args.width, "Of a picture, in pixels")->check(CLI::Range(16, 4096))->capture_default_str();
  app.add_option("--height", args.height, "Of a picture, in pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app.add_option("--max-wrong", args.max_wrong, "Exit with 1 where a mode has a larger share of wrong pixels")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--screenshot", args.picture_file,
                 "Write the picture with the most triangles to this .png file, as the last mode draws it");
  app.add_flag("--json", args.json, "Print JSON instead of a table");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    return ogre_host::run(args);
  } catch (const ogre_host::host_error& e) {
    fmt::print(stderr, "sightcell-ogre: {}\n", e.what());
    return 4;
  } catch (const std::exception& e) {
    fmt::print(stderr, "sightcell-ogre: {}; report this [ogre.failed]\n", e.what());
    return 1;
  }
}
