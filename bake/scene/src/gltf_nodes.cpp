#include "gltf_nodes.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <unordered_map>

namespace sightcell::scene {
namespace {

constexpr double farthest_level = 1e7;  // meters

class node_reader {
 public:
  node_reader(const json_object& root, std::vector<std::string>& warnings)
      : root_(root), nodes_(root.objects("nodes")), warnings_(warnings) {}

  node_list read() {
    out_.nodes.resize(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      read_extras(nodes_[i], out_.nodes[i].marks);
      const auto extensions = nodes_[i].object("extensions");
      const auto lod = extensions ? extensions->object("MSFT_lod") : std::nullopt;
      const auto visibility = extensions ? extensions->object("KHR_node_visibility") : std::nullopt;
      if (visibility) out_.nodes[i].marks.invisible = !visibility->boolean("visible").value_or(true);
      if (lod) read_levels(nodes_[i], lod->indices("ids", "nodes", nodes_.size()), out_.nodes[i]);
    }
    add_named_levels();
    for (const json_object& animation : root_.objects("animations")) {
      for (const json_object& channel : animation.objects("channels")) read_channel(channel);
    }
    for (std::size_t i = 0; i < nodes_.size() && !morphing_meshes_.empty(); ++i) {
      const nlohmann::json* mesh = nodes_[i].raw("mesh");
      if (mesh != nullptr && mesh->is_number() && morphing_meshes_.contains(mesh->get<double>()))
        out_.nodes[i].morphs = true;
    }
    return std::move(out_);
  }

 private:
  void warn_once(const std::string& cause, const std::string& line) {
    if (warned_.insert(cause).second) warnings_.push_back(line);
  }

  void ignore(const json_object& node, const std::string& key, const std::string& why) {
    warn_once("key " + key,
              "extras.sightcell of " + node.where() + " " + why + "; it is ignored there and in all other nodes");
  }

  void read_extras(const json_object& node, node_marks& marks) {
    const nlohmann::json* extras = node.raw("extras");
    if (extras == nullptr || !extras->is_object()) return;  // extras may be of any type
    const auto found = extras->find("sightcell");
    if (found == extras->end()) return;
    if (!found->is_object()) {
      ignore(node, "", "is not a JSON object");
      return;
    }
    for (auto it = found->begin(); it != found->end(); ++it) read_mark(node, it.key(), it.value(), marks);
  }

  void read_mark(const json_object& node, const std::string& key, const nlohmann::json& value, node_marks& marks) {
    if (key == "group") {
      if (value.is_string())
        marks.group = group_of(value.get<std::string>());
      else
        ignore(node, key, "has a \"group\" that is not a name");
      return;
    }
    if (key == "level_of") {
      if (value.is_string())
        marks.level_of = value.get<std::string>();
      else
        ignore(node, key, "has a \"level_of\" that is not the name of a node");
      return;
    }
    if (key == "from_distance") {
      const double meters = value.is_number() ? value.get<double>() : 0.0;
      if (meters > 0.0 && meters <= farthest_level)
        marks.from_distance = static_cast<float>(meters);
      else
        ignore(node, key, "has a \"from_distance\" that is not a number of meters above 0");
      return;
    }
    if (key == "start" || key == "cell") {
      if (value.is_boolean())
        (key == "start" ? marks.start : marks.cell) = value.get<bool>();
      else
        ignore(node, key, "has a \"" + key + "\" that is not true or false");
      return;
    }
    std::optional<bool>* const mark = key == "static"     ? &marks.is_static
                                      : key == "occluder" ? &marks.occluder
                                      : key == "dynamic"  ? &marks.dynamic
                                      : key == "always"   ? &marks.always
                                      : key == "never"    ? &marks.never
                                                          : nullptr;
    if (mark == nullptr)
      ignore(node, key, "has the unknown key \"" + printable(key) + "\"");
    else if (!value.is_boolean())
      ignore(node, key, "has a \"" + key + "\" that is not true or false");
    else
      *mark = value.get<bool>();
  }

  // MSFT_lod. Coverages are hints, so a level without a valid one is a level all the same.
  void read_levels(const json_object& node, const std::vector<std::uint32_t>& ids, node_notes& notes) {
    for (const std::uint32_t id : ids) notes.coarser.push_back({id, {}});
    const nlohmann::json* extras = node.raw("extras");
    if (ids.empty() || extras == nullptr || !extras->is_object()) return;
    const auto found = extras->find("MSFT_screencoverage");
    if (found == extras->end()) return;
    std::vector<float> coverages;
    if (found->is_array())
      for (const nlohmann::json& value : *found) {
        const double coverage = value.is_number() ? value.get<double>() : -1.0;
        if (!(coverage >= 0.0 && coverage <= std::numeric_limits<float>::max())) break;
        coverages.push_back(static_cast<float>(coverage));
      }
    if (coverages.size() != found->size() || coverages.size() < ids.size()) {
      warn_once("coverage", "MSFT_screencoverage of " + node.where() + " is not a list of " +
                                std::to_string(ids.size() + 1) +
                                " numbers of 0 or more: it is ignored there and in all other nodes like it");
      return;
    }
    for (std::size_t i = 0; i < ids.size(); ++i) notes.coarser[i].begins.below_coverage = coverages[i];
    if (coverages.size() > ids.size()) notes.least_coverage = coverages[ids.size()];
  }

  // Nodes by name; no_index for a name that several have.
  std::unordered_map<std::string, std::uint32_t> nodes_by_name() const {
    std::unordered_map<std::string, std::uint32_t> out;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
      const nlohmann::json* name = nodes_[i].raw("name");
      if (name == nullptr || !name->is_string()) continue;
      const auto [entry, added] = out.emplace(name->get<std::string>(), i);
      if (!added) entry->second = no_index;
    }
    return out;
  }

  // Levels of extras.sightcell.level_of follow those of MSFT_lod, nearer ones first. A level of an unknown node
  // occludes nothing: the host may never draw it.
  void add_named_levels() {
    std::optional<std::unordered_map<std::string, std::uint32_t>> by_name;
    std::map<std::uint32_t, std::vector<coarser_node>> levels;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
      node_marks& marks = out_.nodes[i].marks;
      if (marks.level_of.empty()) {
        if (marks.from_distance) ignore(nodes_[i], "from_distance", "has a \"from_distance\" without a \"level_of\"");
        continue;
      }
      if (!by_name) by_name = nodes_by_name();
      const auto found = by_name->find(marks.level_of);
      if (found != by_name->end() && found->second != no_index) {
        levels[found->second].push_back({i, {marks.from_distance, std::nullopt}});
        continue;
      }
      marks.occluder = false;
      warn_once("level_of", "extras.sightcell of " + nodes_[i].where() + " has a \"level_of\" that is the name of " +
                                (found == by_name->end() ? "no node" : "several nodes") + ", \"" +
                                printable(marks.level_of) + "\": such nodes are visible and occlude nothing");
    }
    const auto begin_of = [](const coarser_node& level) {
      return level.begins.from_distance.value_or(std::numeric_limits<float>::infinity());
    };
    for (auto& [object, named] : levels) {
      std::stable_sort(named.begin(), named.end(),
                       [&](const coarser_node& a, const coarser_node& b) { return begin_of(a) < begin_of(b); });
      std::vector<coarser_node>& all = out_.nodes[object].coarser;
      all.insert(all.end(), named.begin(), named.end());
    }
  }

  std::uint32_t group_of(const std::string& name) {
    if (name.empty()) return no_group;
    const auto [entry, added] = group_numbers_.emplace(name, static_cast<std::uint32_t>(out_.groups.size()));
    if (added) out_.groups.push_back(name);
    return entry->second;
  }

  // Samplers and keyframes are not read: a channel without effect counts as motion, which makes non-occluders.
  void read_channel(const json_object& channel) {
    const auto target = channel.object("target");
    if (!target) return;
    const auto node = target->index("node", "nodes", nodes_.size());
    const std::string path = target->text("path").value_or("");
    if (path == "pointer") {
      const auto extensions = target->object("extensions");
      const auto pointer = extensions ? extensions->object("KHR_animation_pointer") : std::nullopt;
      if (pointer) read_pointer(pointer->text("pointer").value_or(""));
    } else if (node && path == "weights") {
      out_.nodes[*node].morphs = true;
    } else if (node && (path == "translation" || path == "rotation" || path == "scale")) {
      out_.nodes[*node].moves = true;
    }
  }

  // KHR_animation_pointer: "/nodes/3/translation", "/meshes/0/weights/1", "/materials/2/alphaCutoff".
  void read_pointer(const std::string& pointer) {
    auto part = [&pointer, at = std::size_t{1}]() mutable {
      const std::size_t from = std::min(at, pointer.size()), to = std::min(pointer.find('/', from), pointer.size());
      at = to + 1;
      return std::string_view(pointer).substr(from, to - from);
    };
    const std::string_view section = part(), number = part(), property = part();
    std::size_t index = 0;
    const auto [end, problem] = std::from_chars(number.data(), number.data() + number.size(), index);
    if (problem != std::errc() || end != number.data() + number.size()) return;
    if (section == "nodes" && index < nodes_.size()) {
      // Any other property, such as an extension's, may change all descendants of the node in any way.
      (property == "weights" ? out_.nodes[index].morphs : out_.nodes[index].moves) = true;
    } else if (section == "meshes") {
      morphing_meshes_.insert(static_cast<double>(index));
    } else if (section == "materials") {
      warn_once("materials", "animations change materials: they are read without animation");
    }
  }

  const json_object& root_;
  std::vector<json_object> nodes_;
  std::vector<std::string>& warnings_;
  std::set<std::string> warned_;
  std::set<double> morphing_meshes_;
  std::unordered_map<std::string, std::uint32_t> group_numbers_;
  node_list out_;
};

}  // namespace

node_list read_nodes(const json_object& root, std::vector<std::string>& warnings) {
  return node_reader(root, warnings).read();
}

node_marks inherited(const node_marks& parent, const node_marks& own) {
  node_marks out = own;
  const auto inherit = [](std::optional<bool>& mark, const std::optional<bool>& from) {
    if (!mark) mark = from;
  };
  inherit(out.is_static, parent.is_static);
  inherit(out.occluder, parent.occluder);
  inherit(out.dynamic, parent.dynamic);
  inherit(out.always, parent.always);
  inherit(out.never, parent.never);
  if (out.group == no_index) out.group = parent.group;
  out.invisible = own.invisible || parent.invisible;
  return out;
}

draw_tags tags_of(const node_marks& marks, bool moving) {
  draw_tags tags;
  tags.occluder = marks.occluder.value_or(true);
  tags.dynamic = marks.dynamic.value_or(false);
  tags.always = marks.always.value_or(false);
  tags.never = marks.never.value_or(false);
  if (marks.group != no_group) tags.group = marks.group;
  if (moving && !marks.is_static.value_or(false)) {
    // A thing that moves and is marked as in every set leaves its rest pose, so it does not occlude there.
    if (tags.always && !marks.occluder) tags.occluder = false;
    tags.animated = tags == draw_tags{};
  }
  // The host decides whether it is shown, so it does not occlude.
  if (marks.invisible) tags.occluder = false;
  return tags;
}

}  // namespace sightcell::scene
