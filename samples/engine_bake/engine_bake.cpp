// Bakes a scene that exists only in memory, as an editor or a build server of an engine would: see README.md.
#include <csignal>
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "level.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/verify.h"
#include "sightcell/base/error.h"
#include "sightcell/sightcell.hpp"

namespace {

namespace bake = sightcell::bake;

volatile std::sig_atomic_t stop_asked = 0;

// 1. The engine's arrays, described. Nothing is copied here; all of it has to live until bake() returns.
struct description {
  std::vector<bake::host_mesh> meshes;
  std::vector<bake::host_material> materials;
  std::vector<bake::host_draw> draws;
  bake::host_scene scene;

  explicit description(const museum::level& level) {
    for (const museum::mesh& m : level.meshes) {
      bake::host_mesh& to = meshes.emplace_back();
      to.positions = m.vertices[0].position;
      to.position_stride = sizeof(museum::vertex);
      to.uvs = m.vertices[0].uv;
      to.uv_stride = sizeof(museum::vertex);
      to.vertex_count = m.vertices.size();
      to.indices = m.indices.data();
      to.index_count = m.indices.size();
      to.index_type = bake::index_format::u16;
    }
    materials.resize(2);
    materials[0].name = "stone";
    materials[1].name = "lattice";
    materials[1].alpha = sightcell::scene::alpha_mode::mask;
    materials[1].double_sided = true;
    materials[1].alpha_function = museum::lattice_alpha;  // or .texture, where there is an image
    for (const museum::entity& e : level.entities)
      draws.push_back({.mesh = e.mesh,
                       .material = e.what == museum::kind::lattice ? 1u : 0u,
                       .to_world = e.to_world,
                       .tag = e.id(),
                       .name = e.name});
    scene = {"museum", meshes, materials, draws};
  }
  description(const description&) = delete;
  description& operator=(const description&) = delete;
};

// 2. The bake itself, with progress, a way to stop it, and its log.
bake::summary run(const museum::level& level, const bake::host_scene& scene, const std::string& output) {
  bake::settings how;
  how.max_pixel_error = 1e-4;  // of each room: the share of view rays that may be wrong
  for (const museum::room& r : level.rooms) how.cells.push_back({r.name, r.min, r.max});
  bake::callbacks events;
  events.on_progress = [](const bake::progress& now) {
    if (now.cells_total > 0)
      std::fprintf(stderr, "%u of %u rooms, %.0f s left\n", now.cells_done, now.cells_total, now.seconds_left);
    return stop_asked == 0;  // finished rooms are kept: the same call goes on from there
  };
  events.on_message = [](bake::severity how_bad, const std::string& text) {
    std::fprintf(stderr, "%s%s\n", how_bad == bake::severity::warning ? "warning: " : "", text.c_str());
  };
  return bake::bake(scene, how, output, false, events);
}

int fail(const std::string& path, const char* what) {
  std::fprintf(stderr, "%s: %s\n", path.c_str(), what);
  return 1;
}

// 3. A proof for the build log: fresh rays that know nothing of the bake.
void prove(const museum::level& level, const bake::host_scene& scene, const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const bake::verification v = bake::verify(scene, std::as_bytes(std::span(bytes)), path, {.rays = 300'000}, nullptr);
  std::printf("verified: %llu wrong of %llu rays, pixel error at most %.1e\n",
              static_cast<unsigned long long>(v.misses), static_cast<unsigned long long>(v.rays), v.upper_bound);
  for (const bake::missing_polygon& m : v.missing) {
    if (&m - v.missing.data() == 3) break;  // the three that most rays saw
    std::size_t draw = 0;                   // source ids are numbered draw by draw
    for (std::uint32_t first = 0;; ++draw) {
      first += static_cast<std::uint32_t>(scene.meshes[scene.draws[draw].mesh].index_count / 3);
      if (m.polygon < first) break;
    }
    std::printf("  missing in room %s: a polygon of %s, seen by %llu rays\n", level.rooms[m.cell].name.c_str(),
                level.entities[draw].name.c_str(), static_cast<unsigned long long>(m.rays));
  }
}

// 4. What the game does with the file: which of its entities does a visitor of each room see?
int list_entities(const museum::level& level, const std::string& path) {
  const auto db = sightcell::db::open_file(path.c_str());
  if (!db) return fail(path, sightcell_status_text(db.status()));
  const auto info = db->info();
  auto view = sightcell::view::create(*db);
  if (!info || !view) return fail(path, "cannot be used");
  std::vector<sightcell_draw> draws(info->draw_count);
  std::vector<sightcell_range> ranges(info->range_bound);
  if (!db->draws(draws)) return fail(path, "has no draw table");

  std::map<std::uint64_t, std::string> name_of;
  for (const museum::entity& e : level.entities) name_of[e.id()] = e.name;
  for (const museum::room& r : level.rooms) {
    const float eye[3] = {0.5f * (r.min[0] + r.max[0]), 0.5f * (r.min[1] + r.max[1]), 0.5f * (r.min[2] + r.max[2])};
    sightcell_frame frame;
    if (view->move(eye, frame) != SIGHTCELL_OK) return fail(path, "the view does not move");
    const auto got = view->ranges(ranges);
    if (!got) return fail(path, sightcell_status_text(got.status));
    std::set<std::string> seen;
    for (std::size_t i = 0; i < got.count; ++i) {
      const auto entity = name_of.find(draws[ranges[i].draw].host_tag);  // the engine's own number comes back
      if (entity == name_of.end()) return fail(path, "holds a tag that was never given");
      seen.insert(entity->second);
    }
    std::printf("room %s: %u of %u polygons;", r.name.c_str(), frame.polygon_count, info->polygon_count);
    for (const std::string& name : seen)
      if (name.starts_with("statue") || name.starts_with("lattice")) std::printf(" %s;", name.c_str());
    std::printf("\n");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: sightcell-engine-bake OUT.pvs\n");
    return 2;
  }
  std::signal(SIGINT, [](int) { stop_asked = 1; });
  try {
    const museum::level level = museum::make_level();
    const description described(level);
    const bake::summary sum = run(level, described.scene, argv[1]);
    if (sum.result == bake::outcome::cancelled) return std::fprintf(stderr, "stopped; run it again to go on\n"), 130;
    std::printf("%s: %u rooms, %llu bytes, pixel error at most %.1e\n", argv[1], sum.cells,
                static_cast<unsigned long long>(sum.bytes), sum.max_upper_bound);
    prove(level, described.scene, argv[1]);
    return list_entities(level, argv[1]);
  } catch (const sightcell::error& e) {
    std::fprintf(stderr, "%s\n", e.what());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sightcell-engine-bake: %s\n", e.what());
  }
  return 1;
}
