#include "cells/overrides.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_map>

#include "cells/cells_file.h"
#include "sightcell/bake/stored_overrides.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace sightcell::bake {
namespace {

using nlohmann::json;
using ranges = overrides::ranges;

// The settings text of a file has at most 16 MiB.
constexpr std::size_t range_limit = 500'000;
constexpr const char* shape = R"(write {"nodes":["name"],"polygons":[12,[100,199]]})";

ranges merged(ranges all) {
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  ranges out;
  for (const scene::polygon_range& r : all) {
    if (out.empty() || r.first > out.back().first + out.back().count)
      out.push_back(r);
    else
      out.back().count = std::max(out.back().count, r.first + r.count - out.back().first);
  }
  return out;
}

bool contains(const ranges& all, std::uint32_t polygon) {
  const auto after = std::upper_bound(all.begin(), all.end(), polygon,
                                      [](std::uint32_t id, const scene::polygon_range& r) { return id < r.first; });
  return after != all.begin() && polygon - std::prev(after)->first < std::prev(after)->count;
}

class override_reader {
 public:
  override_reader(const std::string& subject, const scene::scene& s) : subject_(subject), scene_(s) {}

  // Reads one "always", "never" or "add".
  // where: names it in messages.
  ranges read(const json& from, const std::string& where) {
    if (!from.is_object()) refuse("cells.bad-override", where + " is not an object");
    ranges found;
    for (const auto& [key, list] : from.items()) {
      if (key != "nodes" && key != "polygons")
        refuse("cells.bad-override", fmt::format("{} has an unknown key \"{}\"", where, key));
      if (!list.is_array()) refuse("cells.bad-override", fmt::format("{}: \"{}\" is not an array", where, key));
      for (const json& entry : list) {
        if (key == "nodes")
          add_node(entry, where, found);
        else
          found.push_back(polygons(entry, where));
      }
    }
    found = merged(std::move(found));
    if (found.size() > range_limit)
      refuse("cells.bad-override",
             fmt::format("{} has {} ranges of polygons, more than {}", where, found.size(), range_limit));
    return found;
  }

  [[noreturn]] void refuse(const char* id, const std::string& cause, const std::string& remedy = shape) const {
    throw error(error_kind::bad_input, id, subject_, cause, remedy);
  }

 private:
  void add_node(const json& entry, const std::string& where, ranges& found) {
    if (!entry.is_string()) refuse("cells.bad-override", where + ": \"nodes\" holds an entry that is not a string");
    const auto& name = entry.get_ref<const std::string&>();
    if (!by_name_) {
      by_name_.emplace();
      for (const scene::draw& d : scene_.draws)
        if (d.node < scene_.node_names.size())
          (*by_name_)[scene_.node_names[d.node]].push_back({d.first_source, d.polygon_count});
    }
    const auto known = by_name_->find(name);
    if (known != by_name_->end())
      found.insert(found.end(), known->second.begin(), known->second.end());
    else
      refuse("cells.no-such-node", fmt::format("{}: no node named \"{}\" has a triangle", where, name),
             "use the name of a node with a mesh");
  }

  scene::polygon_range polygons(const json& entry, const std::string& where) const {
    const bool is_range = entry.is_array() && entry.size() == 2;
    const std::uint32_t first = polygon(is_range ? entry[0] : entry, where);
    const std::uint32_t last = is_range ? polygon(entry[1], where) : first;
    if (first > last)
      refuse("cells.bad-override", fmt::format("{}: the range {} to {} runs backwards", where, first, last));
    return {first, last - first + 1};
  }

  std::uint32_t polygon(const json& number, const std::string& where) const {
    if (!number.is_number_unsigned())
      refuse("cells.bad-override",
             where + ": \"polygons\" holds an entry that is neither a source id nor a range of two");
    const auto id = number.get<std::uint64_t>();
    if (id >= scene_.polygon_count)
      refuse("cells.no-such-polygon",
             fmt::format("{}: polygon {} does not exist, the scene has {}", where, id, scene_.polygon_count),
             "use source ids of this scene");
    return static_cast<std::uint32_t>(id);
  }

  const std::string& subject_;
  const scene::scene& scene_;
  std::optional<std::unordered_map<std::string_view, ranges>> by_name_;  // built when the first name is read
};

// A malformed list of cells is ignored here; parse_cells() rejects it.
overrides overrides_of(const json& document, const std::string& subject, const scene::scene& s) {
  overrides given;
  if (!document.is_object()) return given;
  override_reader reader(subject, s);
  if (const auto found = document.find("always"); found != document.end())
    given.always = reader.read(*found, "\"always\"");
  if (const auto found = document.find("never"); found != document.end())
    given.never = reader.read(*found, "\"never\"");
  const auto cells = document.find("cells");
  if (cells == document.end() || !cells->is_array()) return given;
  for (std::size_t i = 0; i < cells->size(); ++i) {
    const json& cell = (*cells)[i];
    const auto found = cell.is_object() ? cell.find("add") : cell.end();
    if (!cell.is_object() || found == cell.end()) continue;
    given.add.resize(i + 1);
    given.add[i] = reader.read(*found, fmt::format("\"add\" of cell {}", i));
  }
  return given;
}

template <typename Action>
void for_each(const ranges& all, const Action& action) {
  for (const scene::polygon_range& r : all)
    for (std::uint32_t i = 0; i < r.count; ++i) action(r.first + i);
}

void find_bounds(scene::world_geometry& geometry) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  glm::vec3 low(infinity), high(-infinity);
  for (std::size_t p = 0; p < geometry.kinds.size(); ++p) {
    if (geometry.kinds[p].absent) continue;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const glm::vec3& at = geometry.positions[geometry.indices[3 * p + corner]];
      low = glm::min(low, at), high = glm::max(high, at);
    }
  }
  const bool any = low.x <= high.x;
  geometry.min = any ? low : glm::vec3(0.0f);
  geometry.max = any ? high : glm::vec3(0.0f);
}

// Returns the parts of `from` that are not in `without`.
ranges difference(const ranges& from, const ranges& without) {
  ranges left;
  for (const scene::polygon_range& r : from) {
    std::uint32_t at = r.first;
    const std::uint32_t end = r.first + r.count;
    for (const scene::polygon_range& gap : without) {
      if (gap.first + gap.count <= at) continue;
      if (gap.first >= end) break;
      if (gap.first > at) left.push_back({at, gap.first - at});
      at = gap.first + gap.count;
      if (at >= end) break;
    }
    if (at < end) left.push_back({at, end - at});
  }
  return left;
}

json json_of(const ranges& all) {
  json list = json::array();
  for (const scene::polygon_range& r : all) list.push_back({r.first, r.first + r.count - 1});
  return list;
}

ranges ranges_of(const json& list, std::uint32_t polygon_count) {
  ranges all;
  if (!list.is_array()) return all;
  for (const json& entry : list) {
    if (!entry.is_array() || entry.size() != 2 || !entry[0].is_number_unsigned() || !entry[1].is_number_unsigned())
      continue;
    const auto first = entry[0].get<std::uint64_t>(), last = entry[1].get<std::uint64_t>();
    if (first > last || last >= polygon_count) continue;
    all.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first + 1)});
  }
  return merged(std::move(all));
}

}  // namespace

overrides parse_overrides(std::string_view text, const std::string& subject, const scene::scene& s) {
  return overrides_of(parse_cells_json(text, subject), subject, s);
}

overrides read_overrides(const std::filesystem::path& path, const scene::scene& s) {
  return parse_overrides(read_cells_text(path), path.string(), s);
}

void apply(const overrides& given, scene::world_geometry& geometry) {
  for_each(given.always, [&](std::uint32_t p) { geometry.kinds[p].always = !geometry.kinds[p].absent; });
  if (given.never.empty()) return;
  for_each(given.never, [&](std::uint32_t p) {
    scene::polygon_kind& kind = geometry.kinds[p];
    if (!kind.absent) ++geometry.absent.tagged;
    kind.absent = true;
    kind.always = kind.alpha_tested = false;
  });
  const auto left_out = [&](const scene::masked_polygon& m) { return contains(given.never, m.id); };
  if (std::erase_if(geometry.masked, left_out) > 0)
    geometry.opacity = scene::make_opacity_maps(geometry.masked, geometry.masks);
  for (scene::lod_object& object : geometry.lods) object.coarser = difference(object.coarser, given.never);
  find_bounds(geometry);
}

void add_polygons(const overrides& given, std::uint32_t cell, std::vector<std::uint32_t>& set) {
  if (cell >= given.add.size() || given.add[cell].empty()) return;
  for_each(difference(given.add[cell], given.never), [&](std::uint32_t p) { set.push_back(p); });
  std::sort(set.begin(), set.end());
  set.erase(std::unique(set.begin(), set.end()), set.end());
}

std::uint64_t hash_of(const overrides& given) {
  if (given.empty()) return 0;
  std::vector<std::uint32_t> numbers;
  const auto append = [&](const ranges& all) {
    numbers.push_back(static_cast<std::uint32_t>(all.size()));
    for (const scene::polygon_range& r : all) numbers.insert(numbers.end(), {r.first, r.count});
  };
  append(given.always);
  append(given.never);
  for (const ranges& all : given.add) append(all);
  return XXH3_64bits(numbers.data(), numbers.size() * sizeof numbers[0]);
}

std::string with_overrides(const std::string& settings, const overrides& given) {
  if (given.always.empty() && given.never.empty()) return settings;
  auto text = scene::parse_ordered_json(settings);
  text["overrides"] = {{"always", json_of(given.always)}, {"never", json_of(given.never)}};
  return text.dump();
}

overrides stored_overrides(std::string_view settings, std::uint32_t polygon_count) {
  overrides given;
  const json text = scene::parse_json(settings, false);
  const auto found = text.is_object() ? text.find("overrides") : text.end();
  if (!text.is_object() || found == text.end() || !found->is_object()) return given;
  given.always = ranges_of(found->value("always", json()), polygon_count);
  given.never = ranges_of(found->value("never", json()), polygon_count);
  return given;
}

void apply_stored_overrides(std::string_view settings, scene::world_geometry& geometry) {
  apply(stored_overrides(settings, static_cast<std::uint32_t>(geometry.kinds.size())), geometry);
}

}  // namespace sightcell::bake
