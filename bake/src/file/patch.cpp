// Adds reported misses to the sets of a file, without a scene and without rays.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "file/caster_sets.h"
#include "file/importance_section.h"
#include "file/light_sets.h"
#include "file/readable_file.h"
#include "file/residency_section.h"
#include "sightcell/bake/patch.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"

namespace sightcell::bake {
namespace {

// The sets of a file, decoded one at a time, and those that were changed.
class set_list {
 public:
  // Checks the whole file.
  set_list(const format::reader& file, const std::string& name) {
    require_readable(stored_.open(file), name);
    require_readable(stored_.check(), name);
  }

  // Reads source ids, followed by volumes.
  format::status get(std::uint32_t cell, std::vector<std::uint32_t>& set) {
    const auto found = changed_.find(cell);
    if (found == changed_.end()) return stored_.item_ids(cell, set);
    set = found->second;
    return format::status::ok;
  }
  // Returns a set that may be changed in place.
  std::vector<std::uint32_t>& to_change(std::uint32_t cell, const std::string& name) {
    if (const auto found = changed_.find(cell); found != changed_.end()) return found->second;
    std::vector<std::uint32_t> set;
    require_readable(get(cell, set), name);
    return changed_.emplace(cell, std::move(set)).first->second;
  }

 private:
  format::set_reader stored_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> changed_;
};

void check_range(const added_polygons& wanted, const format::reader& file, const std::string& name) {
  if (wanted.cell >= file.cell_count())
    throw error(error_kind::wrong_use, "patch.no-such-cell", name,
                fmt::format("has no cell {}, only {}", wanted.cell, file.cell_count()),
                "give the number of a cell of this file");
  const std::uint64_t end = std::uint64_t{wanted.first} + wanted.count;
  if (end > file.polygon_count())
    throw error(error_kind::wrong_use, "patch.no-such-polygon", name,
                fmt::format("has no polygon {}, only {}", end - 1, file.polygon_count()),
                "give source ids of the scene that was baked");
}

// Adds polygons to a set. Returns those that it did not contain, as (cell, first, count).
std::vector<added_polygons> add(const added_polygons& wanted, std::vector<std::uint32_t>& set) {
  std::vector<added_polygons> newly_added;
  const auto from = std::lower_bound(set.begin(), set.end(), wanted.first);
  auto known = from;
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    const std::uint32_t polygon = wanted.first + i;
    if (known != set.end() && *known == polygon) {
      ++known;
    } else if (!newly_added.empty() && newly_added.back().first + newly_added.back().count == polygon) {
      ++newly_added.back().count;
    } else {
      newly_added.push_back({wanted.cell, polygon, 1});
    }
  }
  if (newly_added.empty()) return newly_added;
  std::vector<std::uint32_t> all(set.begin(), from);
  for (std::uint32_t i = 0; i < wanted.count; ++i) all.push_back(wanted.first + i);
  all.insert(all.end(), known, set.end());
  set = std::move(all);
  return newly_added;
}

// Returns the settings text with the added polygons after those of earlier patches. A text that is no JSON object is
// kept inside one.
std::string with_added(std::string_view settings, const std::vector<added_polygons>& newly_added) {
  auto text = scene::parse_ordered_json(settings, false);
  if (!text.is_object())
    text = settings.empty() ? nlohmann::ordered_json::object()
                            : nlohmann::ordered_json{{"settings", std::string(settings)}};
  auto& list = text["added"];
  if (!list.is_array()) list = nlohmann::ordered_json::array();
  for (const added_polygons& a : newly_added) list.push_back({a.cell, a.first, a.count});
  return text.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

patch_result patch(std::span<const std::byte> file, const std::string& name, std::span<const added_polygons> additions,
                   const std::filesystem::path& output) {
  format::reader opened;
  require_readable(format::reader::open(file, opened), name);
  for (const added_polygons& wanted : additions) check_range(wanted, opened, name);
  set_list sets(opened, name);
  format::file_parts parts;
  require_readable(format::take_apart(opened, parts), name);
  patch_result result;
  std::vector<added_polygons> newly_added;
  for (const added_polygons& wanted : additions) {
    const auto more = add(wanted, sets.to_change(wanted.cell, name));
    std::uint64_t added = 0;
    for (const added_polygons& a : more) added += a.count;
    result.added += added;
    result.already_there += wanted.count - added;
    newly_added.insert(newly_added.end(), more.begin(), more.end());
  }
  if (!newly_added.empty()) parts.settings = with_added(opened.settings(), newly_added);
  const format::file_contents changed = parts.contents(
      {parts.cells.size(), [&](std::uint32_t cell, std::vector<std::uint32_t>& set) { return sets.get(cell, set); }});
  std::vector<std::byte> bytes;
  if (format::encode(changed, bytes) != format::status::ok)
    throw error(error_kind::failed, "output.encode", output.string(),
                "with the added polygons it exceeds the limits of the format",
                "bake again with these polygons in the cells file");
  carry_importance(opened, bytes, output.string());
  carry_casters(opened, bytes, output.string());
  carry_lights(opened, bytes, output.string());
  std::vector<std::uint32_t> grown;
  for (const added_polygons& a : newly_added) grown.push_back(a.cell);
  carry_residency(opened, bytes, output.string(), grown);
  if (format::write_file(output.string().c_str(), bytes) != format::status::ok)
    throw error(error_kind::failed, "patch.not-written", output.string(), "cannot be written",
                "free space or choose another -o; the file is unchanged");
  result.bytes = bytes.size();
  return result;
}

}  // namespace sightcell::bake
