#include "stripped_meshes.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>

#include "accessor.h"
#include "draco_decode.h"
#include "gltf_attributes.h"
#include "triangle_modes.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

constexpr int component_float = 5126;

struct group_member {
  std::uint32_t mesh = 0, primitive = 0;
  std::vector<std::uint32_t> corners;  // of what stays
  bool loses = false;                  // some of its triangles, or their order
};

// Primitives with the same vertices.
struct vertex_group {
  std::vector<group_member> members;
  bool changes = false;
  bool compressed = false;  // has only members that lose triangles then
};

// The vertices of a group after some have gone.
struct vertex_selection {
  std::vector<std::uint32_t> kept;        // by new number
  std::vector<std::uint32_t> new_number;  // by old number; of those that are kept
};

vertex_selection select_vertices(const std::vector<bool>& used) {
  vertex_selection out;
  out.new_number.resize(used.size(), 0);
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    out.new_number[i] = static_cast<std::uint32_t>(out.kept.size());
    out.kept.push_back(i);
  }
  return out;
}

// Returns 0 for matrices, which Draco has none of.
std::uint32_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  return type.size() == 4 && type.starts_with("VEC") ? static_cast<std::uint32_t>(type[3] - '0') : 0;
}

// Writes min and max of an accessor. Integers are those of the file, even if normalized. Numbers that are not finite,
// which JSON has none of, do not count.
void write_bounds(json& accessor, const accessor_view& elements) {
  std::vector<double> values;
  accessor_view plain = elements;
  plain.normalized = false;
  (void)read_numbers(plain, values);  // not sparse, so it succeeds
  json low = json::array(), high = json::array();
  for (std::size_t k = 0; k < plain.width; ++k) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = k; i < values.size(); i += plain.width)
      if (std::isfinite(values[i])) least = std::min(least, values[i]), most = std::max(most, values[i]);
    if (least > most) least = most = 0.0;
    const auto number = [&](double v) {
      return plain.component_type == component_float ? json(v) : json(static_cast<std::int64_t>(v));
    };
    low.push_back(number(least)), high.push_back(number(most));
  }
  accessor["min"] = std::move(low), accessor["max"] = std::move(high);
}

class mesh_stripper {
 public:
  mesh_stripper(json& document, const json_object& root, accessor_table& table, const kept_triangles& kept)
      : document_(document), table_(table), kept_(kept) {
    for (const json_object& mesh : root.objects("meshes")) primitives_.push_back(mesh.objects("primitives"));
  }

  added_accessors run() {
    group_primitives();
    for (auto& [key, group] : groups_) {
      if (!group.changes) continue;
      if (group.compressed)
        strip_compressed(group);
      else
        strip_plain(group);
    }
    remove_empty_meshes();
    return std::move(added_);
  }

 private:
  const json_object& source_of_member(const group_member& m) const { return primitives_[m.mesh][m.primitive]; }
  json& target_of_member(const group_member& m) { return document_["meshes"][m.mesh]["primitives"][m.primitive]; }

  void group_primitives() {
    for (std::uint32_t mesh = 0; mesh < primitives_.size(); ++mesh) {
      for (std::uint32_t primitive = 0; primitive < primitives_[mesh].size(); ++primitive) {
        const json_object& source = primitives_[mesh][primitive];
        const auto attributes = source.object("attributes");
        if (!attributes || !attributes->has("POSITION")) continue;
        const bool loses = kept_.contains({mesh, primitive});
        const bool compressed = draco_of(source, *attributes, table_).has_value();
        if (compressed && !loses) continue;
        std::string key = source.raw("attributes")->dump();
        if (compressed) key += source.raw("extensions")->at("KHR_draco_mesh_compression").dump();
        vertex_group& group = groups_[key];
        group.members.push_back({mesh, primitive, {}, loses});
        group.changes = group.changes || loses;
        group.compressed = compressed;
      }
    }
  }

  // corners: of the primitive in the file.
  void take_corners(group_member& m, std::vector<std::uint32_t> corners, int mode) const {
    const auto found = kept_.find({m.mesh, m.primitive});
    if (found == kept_.end()) {
      m.corners = std::move(corners);
      return;
    }
    const std::vector<std::uint32_t> triangles = to_triangles(std::move(corners), mode);
    if (triangles.size() != 3 * std::size_t{found->second.count})
      source_of_member(m).fail("scene.bad-field", "has changed since it was loaded",
                               "run the command again while no other program writes the file");
    for (const std::size_t t : found->second.order)
      m.corners.insert(m.corners.end(), &triangles[3 * t], &triangles[3 * t] + 3);
  }

  std::vector<std::uint32_t> corners_in_file(const group_member& m, std::size_t vertex_count) {
    const json_object& source = source_of_member(m);
    std::vector<std::uint32_t> corners;
    const auto indices = source.index("indices", "accessors", table_.size());
    if (!indices) {
      corners.resize(vertex_count);
      std::iota(corners.begin(), corners.end(), 0u);
      return corners;
    }
    table_.require(source, *indices, "indices", {"SCALAR"}, {5121, 5123, 5125});
    const bool fine = read_indices(table_.elements(*indices), corners);
    if (!fine || std::any_of(corners.begin(), corners.end(), [&](std::uint32_t c) { return c >= vertex_count; }))
      source.fail("scene.index-out-of-range", "has an index beyond its vertices", "export the file again");
    return corners;
  }

  void strip_plain(vertex_group& group) {
    const json_object attributes = source_of_member(group.members.front()).required_object("attributes");
    const std::size_t count = require_vertices(attributes, "POSITION").count;
    std::vector<bool> used(count, false);
    bool all_stay = false;
    for (group_member& m : group.members) {
      const json_object& source = source_of_member(m);
      take_corners(m, corners_in_file(m, count), static_cast<int>(source.number("mode", 6).value_or(mode_triangles)));
      for (const std::uint32_t corner : m.corners) used[corner] = true;
      all_stay = all_stay || source.has("targets");
    }
    if (all_stay) used.assign(count, true);
    const vertex_selection vertices = select_vertices(used);
    const bool fewer = vertices.kept.size() < count;
    json new_attributes = *source_of_member(group.members.front()).raw("attributes");
    if (fewer && !vertices.kept.empty()) {
      std::map<std::uint32_t, std::size_t> made;  // several attributes may be one accessor
      for (const std::string& name : attributes.keys()) {
        const accessor_view elements = require_vertices(attributes, name);
        if (elements.count != count)
          attributes.fail("scene.bad-field", "has attributes of different counts", "export the file again");
        const std::uint32_t accessor = attributes.required_index(name.c_str(), "accessors", table_.size());
        const auto [known, added] = made.try_emplace(accessor, 0);
        if (added) known->second = add_selection(accessor, elements, vertices.kept, name == "POSITION");
        new_attributes[name] = known->second;
      }
    }
    write_members(group, vertices, new_attributes, fewer);
  }

  accessor_view require_vertices(const json_object& attributes, const std::string& name) {
    const std::uint32_t accessor = attributes.required_index(name.c_str(), "accessors", table_.size());
    table_.require(attributes, accessor, "attributes", {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT4"},
                   {5120, 5121, 5122, 5123, 5125, component_float});
    return table_.elements(accessor);
  }

  void strip_compressed(vertex_group& group) {
    const json_object& source = source_of_member(group.members.front());
    const json_object attributes = source.required_object("attributes");
    const json_object draco = *draco_of(source, attributes, table_), ids = draco.required_object("attributes");
    std::vector<draco_wish> wishes;
    for (const std::string& name : ids.keys()) {
      const std::uint32_t accessor = attributes.required_index(name.c_str(), "accessors", table_.size());
      wishes.push_back({static_cast<std::uint32_t>(ids.required_number(name.c_str(), UINT32_MAX)),
                        components_of(table_.source(accessor).required_text("type"))});
    }
    const auto stream = table_.bytes_of_view(draco.required_index("bufferView", "bufferViews", table_.view_count()));
    table_.count_compressed(draco, stream.size());
    std::string why_not;
    const auto mesh = decode_draco(stream, wishes, why_not);
    if (!mesh) draco.fail("scene.draco", "cannot be decoded: " + printable(why_not), "export the file again");
    std::vector<bool> used(mesh->vertex_count, false);
    for (group_member& m : group.members) {
      take_corners(m, mesh->indices, mode_triangles);
      for (const std::uint32_t corner : m.corners) used[corner] = true;
    }
    const vertex_selection vertices = select_vertices(used);
    json new_attributes = json::object();
    const std::vector<std::string> names = ids.keys();
    for (std::size_t i = 0; i < names.size() && !vertices.kept.empty(); ++i) {
      const std::vector<float>& values = mesh->attributes[i];
      const std::uint32_t accessor = attributes.required_index(names[i].c_str(), "accessors", table_.size());
      const accessor_view elements{
          .bytes = {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(float)},
          .count = mesh->vertex_count,
          .stride = wishes[i].width * sizeof(float),
          .width = wishes[i].width,
          .component_type = component_float,
          .sparse_indices = {},
          .sparse_values = {}};
      new_attributes[names[i]] = add_selection(accessor, elements, vertices.kept, names[i] == "POSITION");
    }
    write_members(group, vertices, new_attributes, true);
  }

  // Adds an accessor with some elements of another one. Returns its number.
  // like: the accessor of the file that it replaces.
  std::size_t add_selection(std::uint32_t like, const accessor_view& elements, const std::vector<std::uint32_t>& kept,
                            bool needs_bounds) {
    const std::size_t element = elements.width * component_size(elements.component_type);
    std::vector<std::uint8_t> all;
    if (!read_bytes(elements, element, all))
      table_.source(like).fail("scene.index-out-of-range", "has a sparse index beyond its count",
                               "export the file again");
    std::vector<std::uint8_t> bytes(kept.size() * element);
    for (std::size_t i = 0; i < kept.size(); ++i) std::memcpy(&bytes[i * element], &all[kept[i] * element], element);
    json accessor = document_["accessors"][like];
    needs_bounds = needs_bounds || accessor.contains("min") || accessor.contains("max");
    for (const char* key : {"bufferView", "byteOffset", "sparse", "min", "max"}) accessor.erase(key);
    accessor["count"] = kept.size();
    accessor["componentType"] = elements.component_type;
    if (elements.component_type == component_float) accessor.erase("normalized");
    if (needs_bounds)
      write_bounds(accessor, {.bytes = bytes,
                              .count = kept.size(),
                              .stride = element,
                              .width = elements.width,
                              .component_type = elements.component_type,
                              .sparse_indices = {},
                              .sparse_values = {}});
    return add_accessor(std::move(accessor), std::move(bytes));
  }

  std::size_t add_accessor(json accessor, std::vector<std::uint8_t> bytes) {
    json& all = document_["accessors"];
    all.push_back(std::move(accessor));
    added_.emplace(all.size() - 1, std::move(bytes));
    return all.size() - 1;
  }

  std::size_t add_indices(const std::vector<std::uint32_t>& corners) {
    // The largest number of a type means the end of a strip to graphics interfaces.
    const bool narrow = *std::max_element(corners.begin(), corners.end()) < 0xFFFF;
    std::vector<std::uint8_t> bytes(corners.size() * (narrow ? 2 : 4));
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto low = static_cast<std::uint16_t>(corners[i]);
      if (narrow)
        std::memcpy(&bytes[2 * i], &low, 2);
      else
        std::memcpy(&bytes[4 * i], &corners[i], 4);
    }
    return add_accessor({{"componentType", narrow ? 5123 : 5125}, {"count", corners.size()}, {"type", "SCALAR"}},
                        std::move(bytes));
  }

  // new_vertices: whether vertices have new numbers.
  void write_members(vertex_group& group, const vertex_selection& vertices, const json& new_attributes,
                     bool new_vertices) {
    std::map<std::vector<std::uint32_t>, std::size_t> made;  // index accessors: materials may share triangles
    for (group_member& m : group.members) {
      json& target = target_of_member(m);
      if (m.loses && m.corners.empty()) {
        target = nullptr;  // remove_empty_meshes() removes it
        continue;
      }
      if (new_vertices) target["attributes"] = new_attributes;
      if (m.corners.empty() || !(m.loses || new_vertices)) continue;
      for (std::uint32_t& corner : m.corners) corner = vertices.new_number[corner];
      const auto [known, added] = made.try_emplace(m.corners, 0);
      if (added) known->second = add_indices(m.corners);
      target["indices"] = known->second;
      if (m.loses) target.erase("mode");
      if (m.loses) write_clusters(target, kept_.at({m.mesh, m.primitive}).clusters);
      const auto extensions = target.find("extensions");
      if (extensions == target.end()) continue;
      extensions->erase("KHR_draco_mesh_compression");
      if (extensions->empty()) target.erase("extensions");
    }
  }

  void write_clusters(json& target, const std::vector<std::uint32_t>& clusters) {
    if (clusters.empty()) return;
    json& extras = target["extras"];
    if (!extras.is_object()) extras = json::object();
    json& marks = extras["sightcell"];
    if (!marks.is_object()) marks = json::object();
    const std::uint32_t most = *std::max_element(clusters.begin(), clusters.end());
    const int type = most <= 0xFF ? 5121 : most <= 0xFFFF ? 5123 : 5125;
    const std::size_t size = component_size(type);
    std::vector<std::uint8_t> bytes(clusters.size() * size);
    for (std::size_t i = 0; i < clusters.size(); ++i)
      for (std::size_t k = 0; k < size; ++k) bytes[i * size + k] = static_cast<std::uint8_t>(clusters[i] >> (8 * k));
    marks["clusters"] =
        add_accessor({{"componentType", type}, {"count", clusters.size()}, {"type", "SCALAR"}}, std::move(bytes));
  }

  void remove_empty_meshes() {
    std::vector<std::optional<std::size_t>> new_number(primitives_.size());
    json meshes = json::array();
    for (std::size_t i = 0; i < primitives_.size(); ++i) {
      json mesh = std::move(document_["meshes"][i]);
      const auto end = mesh.find("primitives");
      bool loses = false;
      if (end != mesh.end()) {
        json left = json::array();
        for (json& primitive : *end)
          if (primitive.is_null())
            loses = true;
          else
            left.push_back(std::move(primitive));
        *end = std::move(left);
      }
      if (loses && end->empty()) continue;
      new_number[i] = meshes.size();
      meshes.push_back(std::move(mesh));
    }
    document_["meshes"] = std::move(meshes);
    if (document_.contains("nodes"))
      for (json& node : document_["nodes"]) renumber_mesh(node, new_number);
    if (document_.contains("animations"))
      for (json& animation : document_["animations"]) renumber_pointers(animation, new_number);
  }

  static void renumber_mesh(json& node, const std::vector<std::optional<std::size_t>>& new_number) {
    const auto mesh = node.find("mesh");
    if (mesh == node.end()) return;
    const std::optional<std::size_t> number = new_number[mesh->get<std::size_t>()];
    if (number) {
      *mesh = *number;
      return;
    }
    node.erase("mesh"), node.erase("weights");
    const auto extensions = node.find("extensions");
    if (extensions == node.end()) return;
    extensions->erase("EXT_mesh_gpu_instancing");
    if (extensions->empty()) node.erase("extensions");
  }

  // KHR_animation_pointer names meshes by "/meshes/3/weights". Such meshes stay.
  static void renumber_pointers(json& animation, const std::vector<std::optional<std::size_t>>& new_number) {
    if (!animation.contains("channels")) return;
    for (json& channel : animation["channels"]) {
      const json::json_pointer place("/target/extensions/KHR_animation_pointer/pointer");
      if (!channel.contains(place)) continue;
      const auto mesh = mesh_of_pointer(channel[place]);
      if (!mesh || mesh->first >= new_number.size() || !new_number[mesh->first]) continue;
      channel[place] = "/meshes/" + std::to_string(*new_number[mesh->first]) + mesh->second;
    }
  }

  json& document_;
  accessor_table& table_;
  const kept_triangles& kept_;
  std::vector<std::vector<json_object>> primitives_;  // by mesh
  std::map<std::string, vertex_group> groups_;        // by attributes, as text
  added_accessors added_;
};

}  // namespace

std::optional<std::pair<std::size_t, std::string>> mesh_of_pointer(const json& pointer) {
  if (!pointer.is_string()) return std::nullopt;
  const auto& text = pointer.get_ref<const std::string&>();
  constexpr std::string_view prefix = "/meshes/";
  if (!text.starts_with(prefix)) return std::nullopt;
  std::size_t mesh = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, problem] = std::from_chars(text.data() + prefix.size(), end, mesh);
  if (problem != std::errc()) return std::nullopt;
  return std::pair(mesh, std::string(rest, end));
}

added_accessors strip_meshes(json& document, const json_object& root, accessor_table& table,
                             const kept_triangles& kept) {
  return mesh_stripper(document, root, table, kept).run();
}

}  // namespace sightcell::scene
