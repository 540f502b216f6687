#include "sightcell/bake/recode.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "file_order.h"
#include "importance_section.h"
#include "rays/ray_scene.h"
#include "sightcell/bake/bake.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"
#include "sightcell/scene/error.h"
#include "sightcell/scene/json_text.h"
#include "sightcell/scene/scene.h"
#include "stored_rules.h"

namespace sightcell::bake {
namespace {

void require_ok(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::bad_input, "pvs.broken", name, format::status_text(outcome), "bake it again");
}

// What may be added to sets that hold some slack already.
double slack_left(const format::file_facts& facts, slack_profile profile, const std::string& name) {
  const double most = slack_of_profile[static_cast<std::size_t>(profile)];
  const auto has = static_cast<double>(facts.slack);
  if (has > most + 1e-6)  // the file says it as a float, rounded up
    throw error(error_kind::wrong_use, "recode.has-slack", name,
                fmt::format("holds {:.1f} % of polygons that nobody sees, more than {} allows", 100.0 * has,
                            slack_profile_names[static_cast<std::size_t>(profile)]),
                "recode a file of less slack: what was added once cannot be told from what is seen");
  return std::max((1.0 + most) / (1.0 + has) - 1.0, 0.0);
}

// The settings text of the file with other names in it. A text that is no JSON object stays what it is.
std::string with_names(const std::string& settings, const file_settings& how) {
  auto text = scene::parse_ordered_json(settings, false);
  if (!text.is_object()) return settings;
  text["profile"] = slack_profile_names[static_cast<std::size_t>(how.profile)];
  if (how.order != polygon_order_kind::per_mesh || text.contains("order"))
    text["order"] = polygon_order_names[static_cast<std::size_t>(how.order)];
  return text.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

// The file's bytes in this version, with the profile and the order that are asked for.
std::vector<std::byte> encoded(const format::reader& opened, format::set_reader& sets, const std::string& name,
                               const recode_settings& how, const std::filesystem::path& output) {
  format::file_parts parts;
  require_ok(format::take_apart(opened, parts), name);
  const double slack = how.profile ? slack_left(parts.facts, *how.profile, name) : 0.0;

  if (parts.facts.layout == format::host_layout::merged && how.order == polygon_order_kind::per_instance)
    throw error(error_kind::wrong_use, "recode.merged", name, "is of the merged layout, where instances share nothing",
                "leave out --order per-instance");

  const bool old = opened.format_version() != format::layout::version;
  file_settings now = file_settings_of(parts.settings);
  now.profile = how.profile.value_or(now.profile);
  now.order = how.order.value_or(now.order);
  parts.settings = with_names(parts.settings, now);
  // Of each cell its number in the file that is read.
  std::vector<std::uint32_t> before = old ? order_cells(parts) : std::vector<std::uint32_t>();
  const auto set_of = [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
    return sets.source_ids(before.empty() ? cell : before[cell], set);
  };
  if (old || how.order)
    order_polygons_of(parts, now.order, [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
      require_ok(set_of(cell, set), name);
    });

  format::file_contents contents = parts.contents({parts.cells.size(), set_of});
  contents.slack = slack;
  std::vector<std::byte> bytes;
  if (format::encode(contents, bytes) != format::status::ok)
    throw error(error_kind::failed, "output.encode", output.string(), "the file does not fit into this format",
                "report this file");
  return bytes;
}

// False when the user has had enough.
bool measure_importance(const format::reader& opened, const std::string& name, const recode_settings& how,
                        std::vector<std::byte>& bytes) {
  const scene::scene& s = *how.importance_in;
  const stored_rules rules = stored_rules_of(opened.settings());
  bool done = false;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] {
    scene::world_geometry geometry = scene::flatten(s, rules.animated);
    apply_stored_overrides(opened.settings(), geometry);
    const ray_scene rays(geometry, rules.all_double_sided);
    done = add_importance(bytes, name, rays, how.on_progress);
  });
  return done;
}

}  // namespace

recode_result recode(std::span<const std::byte> file, const std::string& name, const recode_settings& how,
                     const std::filesystem::path& output) {
  format::reader opened;
  format::set_reader sets;
  require_ok(format::reader::open(file, opened), name);
  const scene::scene* s = how.importance_in;
  if (s != nullptr &&
      (opened.polygon_count() != s->polygon_count || opened.facts().scene_fingerprint != s->fingerprint))
    throw error(error_kind::bad_input, "pvs.other-scene", name, "was baked from another scene than " + s->name,
                "give the scene it was baked from, or bake again");
  require_ok(sets.open(opened), name);
  require_ok(sets.check(), name);
  // With importance alone all else stays, also what encoding sets with their slack anew would do otherwise.
  const bool stays = s != nullptr && !how.profile && !how.order && opened.format_version() == format::layout::version;
  std::vector<std::byte> bytes =
      stays ? std::vector<std::byte>(file.begin(), file.end()) : encoded(opened, sets, name, how, output);
  format::reader made;
  recode_result result{opened.format_version(), file.size()};
  if (s != nullptr)
    result.cancelled = !measure_importance(opened, output.string(), how, bytes);
  else
    carry_importance(opened, bytes, output.string());
  if (result.cancelled) return result;
  require_ok(format::reader::open(bytes, made), output.string());
  if (format::write_file(output.string().c_str(), bytes) != format::status::ok)
    throw error(error_kind::failed, "recode.not-written", output.string(), "cannot be written",
                "free space or choose another -o; the file is what it was");
  result.bytes = bytes.size();
  result.slack = static_cast<double>(made.facts().slack);
  return result;
}

}  // namespace sightcell::bake
