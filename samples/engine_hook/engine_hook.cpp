// An engine that draws with Sightcell, in all the ways there are, and compares each with drawing everything. See
// README.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "difference.h"
#include "engine_scene.h"
#include "renderer.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"
#include "visible_set.h"

namespace engine_hook {
namespace {

using sightcell::error;
using sightcell::error_kind;
namespace scene = sightcell::scene;

constexpr float eye_clearance = 0.05f;  // meters: as close to surfaces as the bake goes by default
constexpr double most_backs = 0.1;      // of all that is seen: beyond, the bake calls a place solid
constexpr double few_backs = 1.0 / 64;  // of all pixels: it looks in so many directions
constexpr unsigned tries_per_cell = 16;

struct arguments {
  std::string scene_file, pvs_file, packed_file, merged_file, reload_file;
  std::uint32_t eyes = 8, size = 256, min_gap = 0;
  double max_differing = 1e-3;
  int scene = -1;
};

// One way of drawing, over all pictures so far.
struct way {
  const char* name;
  std::uint64_t pictures = 0, differing = 0, ties = 0, polygons = 0, calls = 0;

  void add(const effort& e) {
    ++pictures;
    polygons += e.polygons;
    calls += e.calls;
  }
  void add(const effort& e, const difference& d) {
    add(e);
    differing += d.differing;
    ties += d.ties;
  }
};

std::array<camera, 6> six_directions(const glm::vec3& eye) {
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  return {camera{eye, x, y, -z}, {eye, -x, y, z}, {eye, z, y, x}, {eye, -z, y, -x}, {eye, x, z, y}, {eye, x, -z, -y}};
}

sightcell::db open_baked(const std::string& file, const scene::scene& s, std::uint32_t layout) {
  auto db = sightcell::db::open_file(file.c_str());
  if (!db) throw error(error_kind::bad_input, "hook.runtime", file, db.text(), "bake the scene again");
  const auto info = db->info();
  if (!info) throw error(error_kind::bad_input, "hook.runtime", file, info.text(), "bake the scene again");
  if (!std::equal(s.fingerprint.begin(), s.fingerprint.end(), info->scene_fingerprint)) {
    throw error(error_kind::bad_input, "hook.other-scene", file, "was baked from another scene than " + s.name,
                "name the scene and the files of one bake");
  }
  if (info->layout != layout) {
    throw error(error_kind::bad_input, "hook.layout", file,
                layout == 0 ? "is for a host that has merged its scene" : "is for a host that keeps its meshes",
                layout == 0 ? "name it with --merged" : "bake it with --layout merged");
  }
  return std::move(*db);
}

// ---- where from ----

// Halton's sequence: spreads the tries evenly.
float radical_inverse(unsigned i, unsigned base) {
  float result = 0.0f, digit = 1.0f / static_cast<float>(base);
  for (; i > 0; i /= base, digit /= static_cast<float>(base)) result += digit * static_cast<float>(i % base);
  return result;
}

// An eye can be there: not in something solid, nor with its nose on it. A cell set promises nothing elsewhere.
bool is_free(renderer& device, const engine_scene& engine, const draw_list& all, const glm::vec3& eye) {
  std::uint64_t pixels = 0, seen = 0, backs = 0;
  for (const camera& view : six_directions(eye)) {
    device.draw_with_backs(engine, view, all);
    const picture p = device.read();
    pixels += p.surfaces.size();
    for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
      if (p.depths[i] > near_plane / eye_clearance) return false;
      seen += p.surfaces[i] != 0 ? 1 : 0;
      backs += p.surfaces[i] == 0xFFFFFFFFu ? 1 : 0;
    }
  }
  return static_cast<double>(backs) <=
         std::max(most_backs * static_cast<double>(seen), few_backs * static_cast<double>(pixels));
}

// Valid viewpoints of cells spread over the file. In a file of an older bake, which has none: the middles of the cells,
// or places nearby where a middle is in something solid.
std::vector<glm::vec3> find_eyes(renderer& device, const engine_scene& engine, const sightcell::db& db,
                                 const arguments& args) {
  const draw_list all = everything(engine);
  const std::uint32_t cells = db.cell_count(), wanted = std::min(args.eyes, cells);
  std::vector<glm::vec3> eyes;
  for (std::uint64_t i = 0; i < wanted; ++i) {
    const auto box = db.cell_box(static_cast<std::uint32_t>(i * cells / wanted));
    if (!box) continue;
    if (const auto eye = db.cell_eye(static_cast<std::uint32_t>(i * cells / wanted)); eye) {
      eyes.emplace_back((*eye)[0], (*eye)[1], (*eye)[2]);
      continue;
    }
    for (unsigned t = 0; t < tries_per_cell; ++t) {
      const float part[3] = {t == 0 ? 0.5f : radical_inverse(t, 2), t == 0 ? 0.5f : radical_inverse(t, 3),
                             t == 0 ? 0.5f : radical_inverse(t, 5)};
      glm::vec3 eye;
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        eye[axis] = box->min[a] + part[a] * (box->max[a] - box->min[a]);
      }
      if (!is_free(device, engine, all, eye)) continue;
      eyes.push_back(eye);
      break;
    }
  }
  if (eyes.size() < wanted)
    fmt::print("cells skipped because no place to stand was found in them: {}\n", wanted - eyes.size());
  if (eyes.empty()) {
    throw error(error_kind::failed, "hook.no-place", args.pvs_file, "no cell has a place to stand",
                "bake cells in the free space of the scene");
  }
  return eyes;
}

// ---- the engine ----

// What belongs to one .pvs file. The view is closed before its db.
struct hook {
  sightcell::db db;
  engine_scene engine;
  draw_list all = everything(engine);
  std::unique_ptr<visible_set> visible;

  hook(const scene::scene& s, const arguments& args)
      : db(open_baked(args.pvs_file, s, 0)), engine(s, db, args.pvs_file) {
    see(args.pvs_file, args.min_gap);
  }
  hook(const scene::scene& s, const scene::scene& packed, const arguments& args)
      : db(open_baked(args.merged_file, s, 1)), engine(packed, db, args.packed_file, args.merged_file) {
    see(args.merged_file, args.min_gap);
  }

  // A new bake has come while the game runs: open it, put the index buffers into its order, make a view, swap; then
  // the old ones are closed. Where it cannot be opened they stay.
  void reload(const scene::scene& s, const std::string& file, std::uint32_t min_gap) {
    sightcell::db fresh = open_baked(file, s, 0);
    engine.follow(fresh, file);
    all = everything(engine);
    visible = nullptr;
    db = std::move(fresh);
    see(file, min_gap);
  }

 private:
  void see(const std::string& file, std::uint32_t min_gap) {
    visible = std::make_unique<visible_set>(engine, db, file, min_gap);
  }
};

struct totals {
  way everything{"everything"}, index_list{"index list"}, commands{"indirect commands"}, objects{"objects"},
      packed_everything{"packed, everything"}, packed_index_list{"packed, index list"},
      packed_commands{"packed, indirect commands"};
  std::uint64_t frames = 0, changes = 0;
};

// One frame. An engine has one of the blocks.
void draw_frame(renderer& device, const camera& view, hook& own, hook* packed, totals& t) {
  const std::array<float, 3> eye{view.eye.x, view.eye.y, view.eye.z};
  own.visible->move(eye);
  ++t.frames;
  t.changes += own.visible->changed() ? 1 : 0;

  t.everything.add(device.draw(own.engine, view, own.all));
  const picture reference = device.read();
  const auto compared = [&](const picture& to, const effort& e, way& w) { w.add(e, compare(to, device.read())); };
  compared(reference, device.draw(own.engine, view, own.visible->index_list()), t.index_list);
  compared(reference, device.draw(own.engine, view, own.visible->commands()), t.commands);
  compared(reference, device.draw(own.engine, view, own.visible->objects()), t.objects);
  if (packed == nullptr) return;

  // The packed mesh has its vertices rounded in world space, so a pixel on a border may show its neighbor: its ways are
  // compared with its own full picture, and that one with the engine's.
  packed->visible->move(eye);
  const effort full = device.draw(packed->engine, view, packed->all);
  const picture packed_reference = device.read();
  difference rounding = compare(reference, packed_reference);
  rounding.ties = 0;  // units are draw groups here
  t.packed_everything.add(full, rounding);
  compared(packed_reference, device.draw(packed->engine, view, packed->visible->index_list()), t.packed_index_list);
  compared(packed_reference, device.draw(packed->engine, view, packed->visible->commands()), t.packed_commands);
}

// ---- what is printed ----

// False when more pixels differ than may.
bool print_way(const way& w, const arguments& args) {
  if (w.pictures == 0) return true;
  const auto n = static_cast<double>(w.pictures);
  const double share = static_cast<double>(w.differing) / (n * args.size * args.size);
  fmt::print("{:<26} {:>8} {:>10} {:>10.2e} {:>8} {:>12.1f} {:>10.1f}\n", w.name, w.pictures, w.differing, share,
             w.ties, static_cast<double>(w.polygons) / n, static_cast<double>(w.calls) / n);
  return share <= args.max_differing;
}

bool print_totals(const totals& t, const arguments& args) {
  fmt::print("{:<26} {:>8} {:>10} {:>10} {:>8} {:>12} {:>10}\n", "way", "pictures", "differing", "of pixels", "ties",
             "polygons", "calls");
  bool fine = true;
  for (const way* w : {&t.everything, &t.index_list, &t.commands, &t.objects, &t.packed_everything,
                       &t.packed_index_list, &t.packed_commands}) {
    fine = print_way(*w, args) && fine;
  }
  return fine;
}

// Above everything, where no cell is: the runtime says DRAW_ALL, and all ways draw everything without asking for it.
bool draws_all_outside(renderer& device, const scene::world_geometry& world, hook& own, hook* packed) {
  const glm::vec3 middle = 0.5f * (world.min + world.max), size = world.max - world.min;
  const glm::vec3 above(middle.x, world.max.y + glm::length(size) + 100.0f, middle.z);
  totals outside;
  draw_frame(device, six_directions(above)[5], own, packed, outside);
  fmt::print("outside all cells: {}, {} of {} polygons drawn, {} pixels differ\n",
             own.visible->draws_all() ? "DRAW_ALL" : "not DRAW_ALL", outside.index_list.polygons,
             outside.everything.polygons,
             outside.index_list.differing + outside.commands.differing + outside.objects.differing +
                 outside.packed_index_list.differing + outside.packed_commands.differing);
  return own.visible->draws_all() && outside.index_list.polygons == outside.everything.polygons &&
         outside.commands.polygons == outside.everything.polygons &&
         outside.objects.polygons == outside.everything.polygons;
}

bool run(const arguments& args) {
  const scene::scene s = scene::load_gltf(args.scene_file, args.scene);
  const sightcell::picture::gl_context context;
  renderer device(args.size);
  hook own(s, args);
  std::optional<scene::scene> packed_scene;
  std::optional<hook> packed;
  if (!args.packed_file.empty()) {
    packed_scene = scene::load_gltf(args.packed_file);
    packed.emplace(s, *packed_scene, args);
  }
  context.check("engine_hook setup");
  hook* const merged = packed ? &*packed : nullptr;

  fmt::print("{}: {} polygons in {} draws of {} primitives, {} cells, {}\n", s.name, s.polygon_count,
             own.engine.units().size(), own.engine.batches().size(), own.db.cell_count(), context.renderer());
  const std::vector<glm::vec3> eyes = find_eyes(device, own.engine, own.db, args);
  totals t;
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    if (i == (eyes.size() + 1) / 2 && !args.reload_file.empty()) own.reload(s, args.reload_file, args.min_gap);
    for (const camera& view : six_directions(eyes[i])) draw_frame(device, view, own, merged, t);
    context.check("engine_hook");
  }
  const bool fine = print_totals(t, args);
  fmt::print("{} frames, what is drawn changed in {}{}\n", t.frames, t.changes,
             args.reload_file.empty() ? "" : "; reloaded halfway");
  const bool open = draws_all_outside(device, scene::flatten(s), own, merged);
  return fine && open;
}

}  // namespace
}  // namespace engine_hook

int main(int argc, char** argv) {
  engine_hook::arguments args;
  CLI::App app{"Draws a baked scene in every way that engines draw, and compares each with drawing everything"};
  app.add_option("scene", args.scene_file, "the scene, .glb or .gltf")->required();
  app.add_option("pvs", args.pvs_file, "the file baked from it")->required();
  auto* const packed =
      app.add_option("--packed", args.packed_file, "what sightcell pack wrote of the scene and --merged");
  auto* const merged = app.add_option("--merged", args.merged_file, "the file baked from it with --layout merged");
  packed->needs(merged);
  merged->needs(packed);
  app.add_option("--reload", args.reload_file, "another bake of the scene, which is taken halfway");
  app.add_option("--scene", args.scene, "which scene of the file; without: its default")
      ->check(CLI::Range(0, INT32_MAX));
  app.add_option("--eyes", args.eyes, "places to look from, six pictures each")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--size", args.size, "pixels along the side of a picture")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app.add_option("--min-gap", args.min_gap, "commands draw what lies in gaps of fewer polygons")->capture_default_str();
  app.add_option("--max-differing", args.max_differing, "share of the pixels that may differ, of each way")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    return engine_hook::run(args) ? 0 : 1;
  } catch (const sightcell::error& e) {
    fmt::print(stderr, "{}\n", e.what());
    return e.kind() == sightcell::error_kind::wrong_use ? 2 : e.kind() == sightcell::error_kind::bad_input ? 4 : 1;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
