#include "scene_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "number_text.h"
#include "pvs_file.h"
#include "sightcell/bake/inspect.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/embed.h"

namespace sightcell::cli {

namespace {

using nlohmann::ordered_json;

ordered_json array_of(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

double percent_of(std::uint32_t part, std::uint32_t all) {
  return all > 0 ? 100.0 * part / all : 0.0;
}

// Of all that are not absent.
ordered_json kinds_json(const scene::world_geometry& world) {
  std::uint32_t by_alpha[3] = {}, alpha_tested = 0, double_sided = 0, always = 0, non_occluders = 0;
  for (const scene::polygon_kind kind : world.kinds) {
    if (kind.absent) continue;
    ++by_alpha[static_cast<int>(kind.alpha)];
    alpha_tested += kind.alpha_tested;
    double_sided += kind.double_sided;
    always += kind.always;
    non_occluders += kind.non_occluder;
  }
  return {{"opaque", by_alpha[static_cast<int>(scene::alpha_mode::opaque)]},
          {"mask", by_alpha[static_cast<int>(scene::alpha_mode::mask)]},
          {"alpha_tested", alpha_tested},
          {"blend", by_alpha[static_cast<int>(scene::alpha_mode::blend)]},
          {"double_sided", double_sided},
          {"in_every_set", always},
          {"never_hide_by_tag", non_occluders}};
}

ordered_json absent_json(const scene::absent_counts& absent) {
  return {{"not_finite", absent.not_finite},
          {"no_area", absent.no_area},
          {"cut_away", absent.cut_away},
          {"tagged", absent.tagged},
          {"coarser_level", absent.coarser_level}};
}

ordered_json coincident_json(const scene::world_geometry& world) {
  const bake::coincident_counts counts = bake::count_coincident(world);
  const auto all = static_cast<std::uint32_t>(world.kinds.size());
  return {{"duplicates", counts.duplicates},   {"duplicates_percent", percent_of(counts.duplicates, all)},
          {"any_winding", counts.any_winding}, {"any_winding_percent", percent_of(counts.any_winding, all)},
          {"opposite", counts.opposite},       {"opposite_percent", percent_of(counts.opposite, all)}};
}

// What the opacity maps of the polygons with an alpha test know. parts_known_percent: of the polygons that have parts,
// the mean share of them, which is the share of the area.
ordered_json opacity_json(const scene::opacity_maps& maps) {
  std::size_t passing = 0, failing = 0, divided = 0;
  std::vector<double> known_of(maps.maps.size(), 0.0);
  for (std::size_t i = 0; i < maps.maps.size(); ++i) {
    const scene::opacity_map& map = maps.maps[i];
    if (map.side == 0) continue;
    std::size_t known = 0;
    for (std::size_t part = 0; part < 2 * std::size_t{map.side} * map.side; ++part)
      known += maps.parts[map.first + part] != scene::opacity::unknown;
    known_of[i] = static_cast<double>(known) / (static_cast<double>(map.side) * map.side);
  }
  double known = 0.0;
  for (const std::uint32_t map : maps.map_of) {
    passing += maps.maps[map].whole == scene::opacity::passes;
    failing += maps.maps[map].whole == scene::opacity::fails;
    divided += maps.maps[map].side > 0;
    known += known_of[map];
  }
  return {{"maps", maps.maps.size()},
          {"pass_everywhere", passing},
          {"pass_nowhere", failing},
          {"divided", divided},
          {"parts_known_percent", divided == 0 ? 0.0 : 100.0 * known / static_cast<double>(divided)},
          {"bytes", maps.bytes()}};
}

// How many draws carry each tag.
ordered_json tags_json(const scene::scene& s) {
  std::uint32_t not_occluders = 0, dynamic = 0, always = 0, never = 0, animated = 0, grouped_draws = 0;
  for (const scene::draw& d : s.draws) {
    not_occluders += !d.tags.occluder;
    dynamic += d.tags.dynamic;
    always += d.tags.always;
    never += d.tags.never;
    animated += d.tags.animated;
    grouped_draws += d.tags.group != scene::no_index;
  }
  return {{"not_occluder", not_occluders}, {"dynamic", dynamic},       {"always", always}, {"never", never},
          {"animated", animated},          {"in_group", grouped_draws}};
}

ordered_json extensions_json(const scene::scene& s) {
  ordered_json list = ordered_json::array();
  for (const scene::extension_use& use : s.extensions)
    list.push_back({{"name", use.name}, {"required", use.required}, {"treated", use.is_read ? "read" : "ignored"}});
  return list;
}

// Mesh instances: each node counts once, however many primitives its mesh has.
std::size_t count_instances(const scene::scene& s) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> instances;
  for (const scene::draw& d : s.draws) instances.emplace(d.node, d.instance);
  return instances.size();
}

std::size_t count_meshes(const scene::scene& s) {
  std::set<std::uint32_t> meshes;
  for (const scene::draw& d : s.draws) meshes.insert(d.mesh);
  return meshes.size();
}

std::string place_text(const ordered_json& v) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}

std::string counts_text(const ordered_json& counts) {
  std::string text;
  for (const auto& [key, value] : counts.items()) {
    if (value == 0) continue;
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", grouped(value), name);
  }
  return text.empty() ? "none" : text;
}

std::string coincident_text(const ordered_json& coincident) {
  const auto one = [&](const char* key) {
    return fmt::format("{} ({:.2f} %)", grouped(coincident[key]),
                       coincident[std::string(key) + "_percent"].get<double>());
  };
  return fmt::format("{} exact duplicates, {} in one place in any winding, {} of them back to back", one("duplicates"),
                     one("any_winding"), one("opposite"));
}

std::string opacity_text(const ordered_json& opacity) {
  return fmt::format(
      "of the alpha tested {} pass everywhere, {} nowhere, {} in parts ({:.0f} % of these known); {} maps, {:.1f} MB",
      grouped(opacity["pass_everywhere"]), grouped(opacity["pass_nowhere"]), grouped(opacity["divided"]),
      opacity["parts_known_percent"].get<double>(), grouped(opacity["maps"]), opacity["bytes"].get<double>() / 1e6);
}

std::string extensions_text(const ordered_json& extensions) {
  std::string text;
  for (const ordered_json& e : extensions)
    text += fmt::format("{}{} ({}{})", text.empty() ? "" : ", ", e["name"].get<std::string>(),
                        e["required"].get<bool>() ? "required, " : "", e["treated"].get<std::string>());
  return text.empty() ? "none" : text;
}

std::string embedded_text(const ordered_json& embedded) {
  const std::string where = embedded["uri"].is_null()
                                ? fmt::format("buffer view {}", embedded["buffer_view"].get<std::uint32_t>())
                                : embedded["uri"].get<std::string>();
  return fmt::format("{}, {} bytes, {} cells, of {} scene", where, grouped(embedded["bytes"]),
                     grouped(embedded["cells"]), embedded["same_scene"].get<bool>() ? "this" : "another");
}

}  // namespace

ordered_json scene_info(const scene::scene& s) {
  const scene::world_geometry world = scene::flatten(s);
  std::vector<std::string> warnings = s.warnings;
  warnings.insert(warnings.end(), world.warnings.begin(), world.warnings.end());
  return {{"polygons", s.polygon_count},
          {"draws", s.draws.size()},
          {"instances", count_instances(s)},
          {"meshes", count_meshes(s)},
          {"geometries", s.geometries.size()},
          {"materials", s.materials.size()},
          {"images", s.images.size()},
          {"bounds", {{"min", array_of(world.min)}, {"max", array_of(world.max)}}},
          {"kinds", kinds_json(world)},
          {"absent", absent_json(world.absent)},
          {"coincident", coincident_json(world)},
          {"opacity", opacity_json(world.opacity)},
          {"tagged_draws", tags_json(s)},
          {"groups", s.groups},
          {"lod_objects", world.lods.size()},
          {"extensions", extensions_json(s)},
          {"fingerprint", hex(s.fingerprint)},
          {"warnings", warnings}};
}

void add_embedded(const std::filesystem::path& path, const scene::scene& s, ordered_json& info) {
  info["embedded"] = nullptr;
  try {
    std::optional<scene::embedded_pvs> found = scene::read_embedded(path);
    if (!found) return;
    const pvs_file file = pvs_file::of_bytes(path, std::move(found->bytes));
    const bool in_view = found->buffer_view != scene::no_index;
    info["embedded"] = {{"buffer_view", in_view ? ordered_json(found->buffer_view) : ordered_json()},
                        {"uri", in_view ? ordered_json() : ordered_json(found->uri)},
                        {"bytes", file.size()},
                        {"cells", file.content().cell_count()},
                        {"same_scene", file.content().facts().scene_fingerprint == s.fingerprint}};
  } catch (const error& e) {
    info["warnings"].push_back(e.what());
  }
}

void print_scene_info(const std::filesystem::path& path, const ordered_json& info) {
  fmt::print("{}: {} polygons, {} draws, {} instances\n", path.string(), grouped(info["polygons"]),
             grouped(info["draws"]), grouped(info["instances"]));
  fmt::print("  made of            {} meshes, {} geometries, {} materials, {} images\n", grouped(info["meshes"]),
             grouped(info["geometries"]), grouped(info["materials"]), grouped(info["images"]));
  const ordered_json& bounds = info["bounds"];
  fmt::print("  bounds             {} to {} m\n", place_text(bounds["min"]), place_text(bounds["max"]));
  fmt::print("  polygons           {}\n", counts_text(info["kinds"]));
  fmt::print("  absent             {}\n", counts_text(info["absent"]));
  fmt::print("  coincident         {}\n", coincident_text(info["coincident"]));
  if (info["kinds"]["alpha_tested"] != 0) fmt::print("  opacity maps       {}\n", opacity_text(info["opacity"]));
  fmt::print("  tagged draws       {}\n", counts_text(info["tagged_draws"]));
  if (info["lod_objects"] != 0) fmt::print("  levels of detail   {} objects\n", grouped(info["lod_objects"]));
  fmt::print("  extensions         {}\n", extensions_text(info["extensions"]));
  fmt::print("  fingerprint        {}\n", info["fingerprint"].get<std::string>());
  if (info["embedded"].is_object()) fmt::print("  .pvs file          {}\n", embedded_text(info["embedded"]));
  for (const ordered_json& warning : info["warnings"])
    fmt::print("  warning            {}\n", warning.get<std::string>());
}

}  // namespace sightcell::cli
