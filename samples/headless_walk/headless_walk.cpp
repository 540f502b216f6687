// Walks through a baked scene and draws each frame with and without the cell set. See README.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "free_place.h"
#include "overview.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/picture.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"
#include "walk_path.h"

namespace {

using sightcell::error;
using sightcell::error_kind;
namespace picture = sightcell::picture;
namespace scene = sightcell::scene;

constexpr std::uint32_t width = 960, height = 600;

struct arguments {
  std::string scene_file, pvs_file, out;
  std::uint32_t frames = 32;
  int scene = -1;
};

struct frame_pictures {
  picture::image_rgba full, culled;
  picture::difference differs;
};

struct totals {
  std::uint64_t full = 0, drawn = 0, differing_pixels = 0;
  double full_milliseconds = 0.0, culled_milliseconds = 0.0, color_error = 0.0;
};

void require(sightcell_status status, const std::string& subject) {
  if (status == SIGHTCELL_OK) return;
  const bool bad_file = status >= SIGHTCELL_ERR_IO;
  throw error(bad_file ? error_kind::bad_input : error_kind::failed, "walk.runtime", subject,
              sightcell_status_text(status), bad_file ? "bake the scene again" : "report this");
}

sightcell::db open_baked(const std::string& file, const scene::scene& s) {
  auto db = sightcell::db::open_file(file.c_str());
  require(db.status(), file);
  const auto info = db->info();
  require(info.status(), file);
  if (!std::equal(s.fingerprint.begin(), s.fingerprint.end(), info->scene_fingerprint)) {
    throw error(error_kind::bad_input, "walk.other-scene", file, "was baked from another scene than " + s.name,
                "bake this scene or name the one it was baked from");
  }
  return std::move(*db);
}

std::vector<headless_walk::box> cell_boxes(const sightcell::db& db, const std::string& file) {
  std::vector<headless_walk::box> boxes;
  for (std::uint32_t cell = 0; cell < db.cell_count(); ++cell) {
    const auto b = db.cell_box(cell);
    require(b.status(), file);
    boxes.push_back({{b->min[0], b->min[1], b->min[2]}, {b->max[0], b->max[1], b->max[2]}});
    if (const auto eye = db.cell_eye(cell); eye) boxes.back().eye = {(*eye)[0], (*eye)[1], (*eye)[2]};
  }
  return boxes;
}

void write_pictures(const std::filesystem::path& folder, const std::string& prefix, const frame_pictures& p) {
  picture::write_png(folder / (prefix + "full.png"), p.full);
  picture::write_png(folder / (prefix + "culled.png"), p.culled);
  picture::write_png(folder / (prefix + "difference.png"), p.differs.marked);
}

// Half the width each, so that the pair is as wide as a frame.
void write_overview(const std::filesystem::path& folder, picture::renderer& renderer,
                    const scene::world_geometry& world, const glm::vec3& eye, std::span<const std::uint32_t> seen) {
  const picture::camera above = headless_walk::camera_above(world, eye);
  const picture::image_rgba whole = renderer.draw(above, width / 2, height);
  const picture::image_rgba kept = renderer.draw(above, width / 2, height, seen);
  picture::write_png(folder / "overview.png", headless_walk::side_by_side(whole, kept));
}

void print_summary(const totals& t, std::size_t frames, const std::string& out) {
  const double n = static_cast<double>(frames);
  fmt::print(
      "mean: {:.0f} polygons full, {:.0f} drawn ({:.2f} %), {:.1f} differing pixels of {} ({:.2e}), "
      "color error {:.1e}, CPU {:.1f} ms full, {:.1f} ms culled\n",
      static_cast<double>(t.full) / n, static_cast<double>(t.drawn) / n,
      100.0 * static_cast<double>(t.drawn) / static_cast<double>(std::max<std::uint64_t>(t.full, 1)),
      static_cast<double>(t.differing_pixels) / n, width * height,
      static_cast<double>(t.differing_pixels) / n / (width * height), t.color_error / n, t.full_milliseconds / n,
      t.culled_milliseconds / n);
  fmt::print("pictures of the first and the worst frame, and overview.png from above: {}\n", out);
}

void walk(const arguments& args) {
  const scene::scene s = scene::load_gltf(args.scene_file, args.scene);
  const scene::world_geometry world = scene::flatten(s);
  const sightcell::db db = open_baked(args.pvs_file, s);
  auto camera = sightcell::view::create(db);
  require(camera.status(), args.pvs_file);

  std::uint32_t skipped = 0;
  const auto path = headless_walk::make_path(world, cell_boxes(db, args.pvs_file), args.frames, skipped);
  if (path.empty()) {
    throw error(error_kind::failed, "walk.no-place", args.pvs_file, "no cell has a place to stand",
                "bake cells in the free space of the scene");
  }
  std::error_code failure;
  std::filesystem::create_directories(args.out, failure);
  if (failure) throw error(error_kind::failed, "walk.folder", args.out, failure.message(), "name another folder");

  const picture::gl_context context;
  picture::renderer renderer(context, s, world);
  fmt::print("{}: {} polygons, {} cells, {} ({})\n", s.name, s.polygon_count, db.cell_count(), context.renderer(),
             context.choice());
  if (skipped > 0) fmt::print("cells skipped because no place to stand was found in them: {}\n", skipped);
  fmt::print("{:>5} {:>8} {:>10} {:>10} {:>7} {:>10} {:>8} {:>8}\n", "frame", "cell", "full", "drawn", "%", "differing",
             "ms full", "ms cull");

  std::vector<std::uint32_t> seen(db.polygon_count());
  frame_pictures worst;
  totals sum;
  renderer.draw({path[0].eye, path[0].forward}, width, height);  // the driver compiles at the first draw
  for (std::size_t f = 0; f < path.size(); ++f) {
    sightcell_frame frame{};
    const std::array<float, 3> eye{path[f].eye.x, path[f].eye.y, path[f].eye.z};
    require(camera->move(eye, frame), args.pvs_file);
    const auto list = camera->polygons(seen);
    require(list.status, args.pvs_file);

    const picture::camera view{path[f].eye, path[f].forward};
    frame_pictures now;
    now.full = renderer.draw(view, width, height);
    const std::uint64_t full = renderer.polygons_of_last_draw();
    const double full_milliseconds = renderer.cpu_milliseconds_of_last_draw();
    now.culled = renderer.draw(view, width, height, std::span<const std::uint32_t>(seen).first(list.count));
    const std::uint64_t drawn = renderer.polygons_of_last_draw();
    const double culled_milliseconds = renderer.cpu_milliseconds_of_last_draw();
    now.differs = picture::compare(now.full, now.culled);

    fmt::print("{:>5} {:>8} {:>10} {:>10} {:>7.2f} {:>10} {:>8.1f} {:>8.1f}{}\n", f,
               frame.cell == SIGHTCELL_NO_CELL ? "outside" : std::to_string(frame.cell), full, drawn,
               100.0 * static_cast<double>(drawn) / static_cast<double>(std::max<std::uint64_t>(full, 1)),
               now.differs.differing_pixels, full_milliseconds, culled_milliseconds,
               (frame.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0 ? "  everything drawn" : "");
    sum.full += full;
    sum.drawn += drawn;
    sum.differing_pixels += now.differs.differing_pixels;
    sum.full_milliseconds += full_milliseconds;
    sum.culled_milliseconds += culled_milliseconds;
    sum.color_error += now.differs.color_error;
    if (f == 0) {
      write_pictures(args.out, "first_", now);
      write_overview(args.out, renderer, world, path[f].eye, std::span<const std::uint32_t>(seen).first(list.count));
    }
    if (f == 0 || now.differs.differing_pixels > worst.differs.differing_pixels) worst = std::move(now);
  }
  write_pictures(args.out, "", worst);
  print_summary(sum, path.size(), args.out);
}

}  // namespace

int main(int argc, char** argv) {
  arguments args;
  CLI::App app{"Draws a walk through a baked scene with and without its cell sets"};
  app.add_option("scene", args.scene_file, "the scene, .glb or .gltf")->required();
  app.add_option("pvs", args.pvs_file, "the baked file")->required();
  app.add_option("--out", args.out, "folder for the pictures")->required();
  app.add_option("--scene", args.scene, "which scene of the file; without: its default")
      ->check(CLI::Range(0, INT32_MAX));
  app.add_option("--frames", args.frames, "frames of the walk")->check(CLI::Range(1, 100000))->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    walk(args);
    return 0;
  } catch (const error& e) {
    fmt::print(stderr, "{}\n", e.what());
    return e.kind() == error_kind::wrong_use ? 2 : e.kind() == error_kind::bad_input ? 4 : 1;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
