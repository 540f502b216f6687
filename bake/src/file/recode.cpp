#include "sightcell/bake/recode.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <tuple>
#include <vector>

#include "file/caster_sets.h"
#include "file/importance_section.h"
#include "file/light_sets.h"
#include "file/readable_file.h"
#include "file/residency_section.h"
#include "file/stored_rules.h"
#include "file/use_all_threads.h"
#include "input/two_scenes.h"
#include "order/cluster_order.h"
#include "order/draw_identity.h"
#include "order/draw_table.h"
#include "order/file_order.h"
#include "sightcell/bake/stored_overrides.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {
namespace {

// Returns the slack that may be added to sets that contain some already.
double slack_left(const format::file_facts& facts, slack_profile profile, const std::string& name) {
  const double most = slack_of_profile[static_cast<std::size_t>(profile)];
  const auto has = static_cast<double>(facts.slack);
  if (has > most + 1e-6)  // the file has it as a float, rounded up
    throw error(error_kind::wrong_use, "recode.has-slack", name,
                fmt::format("has {:.1f} % slack, more than the profile {} allows", 100.0 * has,
                            slack_profile_names[static_cast<std::size_t>(profile)]),
                "recode a file with less slack: slack cannot be removed");
  return std::max((1.0 + most) / (1.0 + has) - 1.0, 0.0);
}

// Returns the settings text with the names of the new file settings, in the places where a bake writes them. A text
// that is no JSON object is not changed.
std::string with_names(const std::string& settings, const file_settings& how) {
  const auto text = scene::parse_ordered_json(settings, false);
  if (!text.is_object()) return settings;
  auto made = nlohmann::ordered_json::object();
  const auto put_names = [&] {
    made["profile"] = slack_profile_names[static_cast<std::size_t>(how.profile)];
    if (how.order != polygon_order_kind::per_mesh)
      made["order"] = polygon_order_names[static_cast<std::size_t>(how.order)];
    if (how.layout != host_layout::instanced) made["layout"] = host_layout_names[static_cast<std::size_t>(how.layout)];
    if (how.granularity != set_granularity::polygon)
      made["granularity"] = set_granularity_names[static_cast<std::size_t>(how.granularity)];
  };
  for (const auto& [key, value] : text.items()) {
    if (key == "profile")
      put_names();
    else if (key != "order" && key != "layout" && key != "granularity")
      made[key] = value;
  }
  if (!made.contains("profile")) put_names();
  return made.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

// Changes the table of draws to the other layout, not in order yet. Entries that the host added are kept.
void change_layout(format::file_parts& parts, const std::string& name, format::host_layout layout,
                   const scene::scene* s) {
  if (layout == format::host_layout::merged && s == nullptr)
    throw error(error_kind::wrong_use, "recode.no-scene", name, "does not contain the draw groups of the merged layout",
                "give the scene it was baked from: --scene SCENE");
  const auto place_of = [](const format::draw_record& d) {
    return std::tuple(d.first_source, d.node, d.mesh, d.primitive, d.instance);
  };
  std::map<decltype(place_of({})), format::draw_record> found;
  if (s != nullptr)
    for (const format::draw_record& d : draw_table(*s, layout)) found.emplace(place_of(d), d);
  for (format::draw_record& d : parts.draws) {
    d.group = 0;
    if (s != nullptr) d.named_group = format::no_named_group;  // names come from the scene
    if (const auto same = found.find(place_of(d)); same != found.end()) {
      d.group = same->second.group;
      d.flags = same->second.flags;  // which version 0 did not have
      d.named_group = same->second.named_group;
    }
  }
  if (s != nullptr) {
    parts.named_groups = s->groups;
    remove_closed_groups(stored_rules_of(parts.settings).closed, parts.named_groups, parts.draws);
  }
  parts.facts.layout = layout;
}

// Returns the clusters that the new file has; empty: none.
cluster_numbers clusters_for(const format::file_parts& parts, const std::string& name, const recode_settings& how) {
  const bool wanted = how.granularity == set_granularity::cluster;
  if (!parts.clusters.empty()) {
    if (how.granularity && !wanted)
      throw error(error_kind::wrong_use, "recode.has-clusters", name,
                  "has sets of clusters, which do not contain which of their polygons are visible",
                  "recode the file of polygons, or bake without --granularity cluster");
    return clusters_of_file(parts);
  }
  if (!wanted) return {};
  if (how.clusters_from == nullptr)
    throw error(error_kind::wrong_use, "recode.no-scene", name, "does not contain the triangles that form clusters",
                "name the scene that was baked: --scene SCENE");
  return clusters_of_scene(*how.clusters_from);
}

// Returns the bytes of the file in the current version with the requested settings.
std::vector<std::byte> encoded(const format::reader& opened, format::set_reader& sets, const std::string& name,
                               const recode_settings& how, const std::filesystem::path& output) {
  format::file_parts parts;
  require_readable(format::take_apart(opened, parts), name);
  const double slack = how.profile ? slack_left(parts.facts, *how.profile, name) : 0.0;

  const auto layout = how.layout ? static_cast<format::host_layout>(*how.layout) : parts.facts.layout;
  const bool other_layout = layout != parts.facts.layout;
  if (layout == format::host_layout::merged && how.order == polygon_order_kind::per_instance)
    throw error(error_kind::wrong_use, "recode.merged", name,
                "has the merged layout, in which instances share no polygon order", "leave out --order per-instance");
  const bool in_clusters = !parts.clusters.empty();
  const cluster_numbers clusters = clusters_for(parts, name, how);
  if (other_layout) change_layout(parts, name, layout, how.layout_from);

  if (how.names_from != nullptr) put_identity(identity_of(*how.names_from), parts);

  const bool old = opened.format_version() != format::layout::version;
  file_settings now = file_settings_of(parts.settings);
  now.profile = how.profile.value_or(now.profile);
  now.order = layout == format::host_layout::merged ? polygon_order_kind::per_mesh : how.order.value_or(now.order);
  now.layout = static_cast<host_layout>(layout);
  now.granularity = clusters.empty() ? set_granularity::polygon : set_granularity::cluster;
  parts.settings = with_names(parts.settings, now);
  // Per cell: its number in the file that is read.
  std::vector<std::uint32_t> before;
  if (old)
    before = order_cells(parts);
  else
    put_on_grid(parts);  // older files of this version have boxes instead
  const auto number_before = [&](std::uint32_t cell) { return before.empty() ? cell : before[cell]; };
  std::mutex one_at_a_time;  // uses the reader
  const auto set_of = [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
    const std::scoped_lock lock(one_at_a_time);
    require_readable(sets.source_ids(number_before(cell), set), name);
  };
  const bool reordered = old || how.order || other_layout;
  if (!clusters.empty() && (reordered || !in_clusters))
    order_clusters_of(parts, now.order, clusters, set_of);
  else if (reordered)
    order_polygons_of(parts, now.order, set_of);

  format::file_contents contents =
      parts.contents({parts.cells.size(), [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
                        return sets.item_ids(number_before(cell), set);
                      }});
  contents.slack = slack;
  use_all_threads(contents, SIZE_MAX);
  std::vector<std::byte> bytes;
  if (format::encode(contents, bytes) != format::status::ok)
    throw error(error_kind::failed, "output.encode", output.string(), "its content exceeds the limits of the format",
                "report this file");
  return bytes;
}

// Makes the sections that need the scene. Returns false if it was canceled.
bool make_sections(const format::reader& opened, const std::string& name, const recode_settings& how,
                   std::vector<std::byte>& bytes) {
  const scene::scene& s = how.importance_in != nullptr ? *how.importance_in : *how.residency_of;
  const stored_rules rules = stored_rules_of(opened.settings());
  bool done = false;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] {
    scene::world_geometry geometry = scene::flatten(s, rules.animated, rules.closed);
    apply_stored_overrides(opened.settings(), geometry);
    const ray_scene rays(geometry, rules.all_double_sided);
    done = (how.residency_of == nullptr ||
            add_residency(bytes, name, *how.residency_of, rays, how.anisotropy, how.on_progress)) &&
           (how.importance_in == nullptr || add_importance(bytes, name, rays, how.on_progress));
  });
  return done;
}

}  // namespace

recode_result recode(std::span<const std::byte> file, const std::string& name, const recode_settings& how,
                     const std::filesystem::path& output) {
  format::reader opened;
  format::set_reader sets;
  require_readable(format::reader::open(file, opened), name);
  const scene::scene* s = how.importance_in;
  for (const scene::scene* given : {s, how.residency_of, how.layout_from, how.names_from, how.clusters_from})
    if (given != nullptr) require_scene(opened, *given, name);
  if (s != nullptr && stored_cells_from(opened.settings()))
    throw error(error_kind::wrong_use, "recode.two-scenes", name,
                "has cells of another scene, which occludes parts of this one",
                "bake with --importance, which uses both scenes");
  require_readable(sets.open(opened), name);
  require_readable(sets.check(), name);
  const bool makes_sections = s != nullptr || how.residency_of != nullptr;
  // With such sections alone the other bytes stay the same. Encoding sets with slack again could change them.
  const bool stays = makes_sections && !how.profile && !how.order && !how.layout && !how.granularity &&
                     how.names_from == nullptr && opened.format_version() == format::layout::version;
  std::vector<std::byte> bytes =
      stays ? std::vector<std::byte>(file.begin(), file.end()) : encoded(opened, sets, name, how, output);
  format::reader made;
  recode_result result{opened.format_version(), file.size()};
  if (!stays && s == nullptr) carry_importance(opened, bytes, output.string());
  if (!stays && how.residency_of == nullptr) carry_residency(opened, bytes, output.string(), {});
  if (makes_sections) result.cancelled = !make_sections(opened, output.string(), how, bytes);
  if (!stays) {
    carry_casters(opened, bytes, output.string());
    carry_lights(opened, bytes, output.string());
  }
  if (result.cancelled) return result;
  require_readable(format::reader::open(bytes, made), output.string());
  if (format::write_file(output.string().c_str(), bytes) != format::status::ok)
    throw error(error_kind::failed, "recode.not-written", output.string(), "cannot be written",
                "free space or choose another -o; the file is unchanged");
  result.bytes = bytes.size();
  result.slack = static_cast<double>(made.facts().slack);
  return result;
}

}  // namespace sightcell::bake
