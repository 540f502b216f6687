#include "matched_scene.h"

#include <array>
#include <map>
#include <utility>

#include "host_error.h"

namespace ogre_host {
namespace {

using sightcell::hosts::match_triangles;

void require(sightcell_status status, const std::string& pvs_file) {
  if (status == SIGHTCELL_OK) return;
  throw host_error("ogre.runtime", pvs_file, sightcell_status_text(status), "bake the scene again");
}

// The draw of the file for each draw of a scene: by its geometry, then by the name of its node.
std::vector<std::uint32_t> match_draws(const sightcell::db& db, const std::string& pvs_file,
                                       const imported_scene& scene) {
  std::vector<std::uint64_t> hashes;
  std::vector<const char*> names;
  for (const imported_draw& d : scene.draws) {
    hashes.push_back(scene.hashes[d.mesh]);
    names.push_back(d.node->mName.C_Str());
  }
  std::vector<std::uint32_t> draw_of_scene(scene.draws.size());
  sightcell_draw_match counts{};
  const sightcell_status status = db.match(hashes, names, draw_of_scene, counts);
  if (status == SIGHTCELL_ERR_ABSENT) {
    throw host_error("ogre.no-names", pvs_file, "has no names and hashes of draws",
                     "bake it with --names, or add them with sightcell recode --names");
  }
  if (status == SIGHTCELL_ERR_OTHER_SCENE) {
    std::array<char, 256> name{};
    if (counts.missing > 0) static_cast<void>(db.draw_name(counts.first_missing, SIGHTCELL_NAME_NODE, name));
    throw host_error("ogre.other-scene", pvs_file,
                     "is of another scene: it has " + std::to_string(counts.missing) + " draws that the scene lacks" +
                         (name[0] != '\0' ? " (the first: " + std::string(name.data()) + ")" : "") + " and lacks " +
                         std::to_string(counts.extra) + " of " + std::to_string(hashes.size()) + " that it has",
                     "name the scene that it was baked from");
  }
  require(status, pvs_file);
  return draw_of_scene;
}

std::vector<std::uint32_t> inverse(const std::vector<std::uint32_t>& draw_of, std::size_t draws) {
  std::vector<std::uint32_t> out(draws, SIGHTCELL_NO_DRAW);
  for (std::uint32_t i = 0; i < draw_of.size(); ++i) {
    if (draw_of[i] != SIGHTCELL_NO_DRAW) out[draw_of[i]] = i;
  }
  return out;
}

}  // namespace

sightcell::view matched_scene::make_view() const {
  auto made = sightcell::view::create(db);
  require(made.status(), file);
  return std::move(*made);
}

matched_scene match_scene(const std::string& pvs_file, const std::string& scene_file, const imported_scene& host) {
  auto opened = sightcell::db::open_file(pvs_file.c_str());
  require(opened.status(), pvs_file);
  matched_scene out;
  out.file = pvs_file;
  out.db = std::move(*opened);
  const auto info = out.db.info();
  require(info.status(), pvs_file);
  out.info = *info;
  if (out.info.layout != 0) {
    throw host_error("ogre.layout", pvs_file, "is for a host that has merged its scene",
                     "bake it with --layout instanced");
  }
  out.draws.resize(out.info.draw_count);
  require(out.db.draws(out.draws).status, pvs_file);

  const imported_scene stored = import_as_stored(scene_file);
  const std::vector<std::uint32_t> stored_of_draw = inverse(match_draws(out.db, pvs_file, stored), out.draws.size());
  out.draw_of_entity = match_draws(out.db, pvs_file, host);
  out.entity_of_draw = inverse(out.draw_of_entity, out.draws.size());

  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> number_of;  // by mesh of the file and of the host
  for (std::uint32_t e = 0; e < host.draws.size(); ++e) {
    const std::uint32_t mesh = host.draws[e].mesh;
    const std::uint32_t of_file = stored.draws[stored_of_draw[out.draw_of_entity[e]]].mesh;
    const auto [found, is_new] = number_of.try_emplace({of_file, mesh}, out.triangles.size());
    out.triangles_of_entity.push_back(found->second);
    if (!is_new) continue;
    const std::array parts{host.triangles(mesh)};
    out.triangles.push_back(match_triangles(stored.triangles(of_file), parts));
  }
  return out;
}

}  // namespace ogre_host
