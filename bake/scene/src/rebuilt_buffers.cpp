#include "rebuilt_buffers.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "accessor.h"
#include "json_object.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

// Targets of buffer views in glTF; 0 here for views without.
constexpr int no_target = 0, target_vertices = 34962, target_indices = 34963;

json* member_of(json* value, const char* key) {
  if (value == nullptr || !value->is_object()) return nullptr;
  const auto found = value->find(key);
  return found == value->end() ? nullptr : &*found;
}

// Calls with each element of an array, or each value of an object; for anything else with none.
void for_each_in(json* value, const std::function<void(json&)>& visit) {
  if (value != nullptr && value->is_structured())
    for (json& one : *value) visit(one);
}

// Calls with each number of an accessor, and with the target of its buffer view.
void visit_accessors(json& document, const std::function<void(json&, int target)>& visit) {
  const auto of_vertices = [&](json& number) { visit(number, target_vertices); };
  const auto of_instances = [&](json& number) { visit(number, no_target); };
  const auto other = [&](json* number) {
    if (number != nullptr) visit(*number, no_target);
  };
  for_each_in(member_of(&document, "meshes"), [&](json& mesh) {
    for_each_in(member_of(&mesh, "primitives"), [&](json& primitive) {
      for_each_in(member_of(&primitive, "attributes"), of_vertices);
      for_each_in(member_of(&primitive, "targets"), [&](json& target) { for_each_in(&target, of_vertices); });
      if (json* const indices = member_of(&primitive, "indices")) visit(*indices, target_indices);
      json* const extensions = member_of(&primitive, "extensions");
      other(member_of(member_of(extensions, "CESIUM_primitive_outline"), "indices"));
      other(member_of(member_of(member_of(&primitive, "extras"), "sightcell"), "clusters"));
    });
  });
  for_each_in(member_of(&document, "skins"), [&](json& skin) { other(member_of(&skin, "inverseBindMatrices")); });
  for_each_in(member_of(&document, "animations"), [&](json& animation) {
    for_each_in(member_of(&animation, "samplers"), [&](json& sampler) {
      other(member_of(&sampler, "input"));
      other(member_of(&sampler, "output"));
    });
  });
  for_each_in(member_of(&document, "nodes"), [&](json& node) {
    json* const instancing = member_of(member_of(&node, "extensions"), "EXT_mesh_gpu_instancing");
    for_each_in(member_of(instancing, "attributes"), of_instances);
  });
}

bool is_view_number(std::string_view key, bool in_metadata) {
  static constexpr std::array<std::string_view, 3> everywhere{"bufferView", "arrayOffsetBufferView",
                                                              "stringOffsetBufferView"};
  static constexpr std::array<std::string_view, 3> of_metadata{"values", "arrayOffsets", "stringOffsets"};
  const auto has = [key](const auto& names) { return std::find(names.begin(), names.end(), key) != names.end(); };
  return has(everywhere) || (in_metadata && has(of_metadata));
}

// Calls with each number of a buffer view outside accessors and images: extensions have some. Uses its own stack,
// because files may be hostile.
void visit_views(json& document, const std::function<void(json&)>& visit) {
  struct place {
    json* value;
    bool in_metadata;
  };
  std::vector<place> open;
  for (auto it = document.begin(); it != document.end(); ++it)
    if (it.key() != "accessors" && it.key() != "bufferViews" && it.key() != "images" && it.key() != "buffers" &&
        it.key() != "extras")
      open.push_back({&*it, false});
  while (!open.empty()) {
    const place at = open.back();
    open.pop_back();
    if (at.value->is_array())
      for (json& one : *at.value) open.push_back({&one, at.in_metadata});
    if (!at.value->is_object()) continue;
    for (auto it = at.value->begin(); it != at.value->end(); ++it) {
      if (it.key() == "extras") continue;
      if (it->is_number() && is_view_number(it.key(), at.in_metadata))
        visit(*it);
      else
        open.push_back({&*it, at.in_metadata || it.key() == "EXT_structural_metadata"});
    }
  }
}

}  // namespace

rebuilt_buffers::rebuilt_buffers(json& document, const json_object& root, accessor_table& table,
                                 const added_accessors& added, const carried_images& images, const std::string& file,
                                 std::uint64_t room_bytes)
    : root_(root), table_(table), added_(added), file_(file) {
  renumber_accessors(document);
  renumber_views(document);
  if (room_bytes > 0) room_view_ = add_piece({.size = room_bytes, .bytes = {}, .elements = {}}, 0, no_target);
  std::map<std::string_view, std::size_t> views_of_images;  // some files have an image under several numbers
  for (const auto& [number, bytes] : images) {
    const std::string_view content(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto [known, is_new] = views_of_images.try_emplace(content, 0);
    if (is_new) known->second = add_piece({.size = bytes.size(), .bytes = bytes, .elements = {}}, 0, no_target);
    document["images"][number]["bufferView"] = known->second;
  }
  for (const char* section : {"bufferViews", "buffers"}) document.erase(section);
  if (views_.empty()) return;
  document["bufferViews"] = views_;
  document["buffers"] = json::array({{{"byteLength", bytes_}}});
}

void rebuilt_buffers::renumber_accessors(json& document) {
  const json old = document.contains("accessors") ? std::move(document["accessors"]) : json::array();
  document.erase("accessors");
  std::map<std::pair<std::size_t, int>, std::size_t> known;
  json made = json::array();
  visit_accessors(document, [&](json& number, int target) {
    const std::size_t before = index_of(number, old.size(), "accessors");
    const auto [entry, is_new] = known.try_emplace({before, target}, made.size());
    if (is_new) made.push_back(rebuilt_accessor(old[before], before, target));
    number = entry->second;
  });
  if (!made.empty()) document["accessors"] = std::move(made);
}

json rebuilt_buffers::rebuilt_accessor(const json& source, std::size_t number, int target) {
  json made = source;
  for (const char* key : {"bufferView", "byteOffset", "sparse"}) made.erase(key);
  piece from;
  if (const auto fresh = added_.find(number); fresh != added_.end()) {
    from.elements.bytes = fresh->second;
    from.elements.count = source.at("count").get<std::size_t>();
    from.elements.stride = from.elements.count == 0 ? 0 : fresh->second.size() / from.elements.count;
    from.elements.component_type = source.at("componentType").get<int>();
    from.elements.width = from.elements.stride / std::max<std::size_t>(component_size(from.elements.component_type), 1);
  } else {
    const auto at = static_cast<std::uint32_t>(number);
    // All zero: of Draco, which has the elements, or as they are.
    if (!table_.source(at).has("bufferView") && !table_.source(at).has("sparse")) return made;
    table_.require(root_, at, "values", {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT4"},
                   {5120, 5121, 5122, 5123, 5125, 5126});
    from.elements = table_.elements(at);
  }
  const std::size_t element = from.elements.width * component_size(from.elements.component_type);
  from.stride = target == target_vertices ? (element + 3) / 4 * 4 : element;  // as glTF requires
  from.size = std::uint64_t{from.elements.count} * from.stride;
  if (from.size == 0) return made;
  made["bufferView"] = add_piece(from, from.stride == element ? 0 : from.stride, target);
  return made;
}

void rebuilt_buffers::renumber_views(json& document) {
  std::map<std::size_t, std::size_t> known;
  visit_views(document, [&](json& number) {
    const std::size_t before = index_of(number, table_.view_count(), "bufferViews");
    const auto [entry, is_new] = known.try_emplace(before, 0);
    if (is_new) {
      const std::span<const std::uint8_t> bytes = table_.bytes_of_view(static_cast<std::uint32_t>(before));
      entry->second = add_piece({.size = bytes.size(), .bytes = bytes, .elements = {}}, 0, no_target);
    }
    number = entry->second;
  });
}

// byte_stride: 0: tightly packed.
std::size_t rebuilt_buffers::add_piece(piece made, std::size_t byte_stride, int target) {
  const accessor_view& e = made.elements;
  if (!e.bytes.empty() && e.sparse_count == 0) {
    const auto [known, is_new] = views_of_elements_.try_emplace(
        {e.bytes.data(), e.count, e.stride, e.width * component_size(e.component_type), made.stride, target},
        pieces_.size());
    if (!is_new) return known->second;
  }
  made.offset = bytes_;
  const std::uint64_t length = std::max<std::uint64_t>(made.size, 1);  // an image may be empty
  bytes_ += (length + 3) / 4 * 4;
  json view = {{"buffer", 0}, {"byteOffset", made.offset}, {"byteLength", length}};
  if (byte_stride != 0) view["byteStride"] = byte_stride;
  if (target != no_target) view["target"] = target;
  views_.push_back(std::move(view));
  pieces_.push_back(std::move(made));
  return pieces_.size() - 1;
}

std::size_t rebuilt_buffers::index_of(const json& value, std::size_t size, const char* section) const {
  const json holder = {{section, value}};
  return json_object(holder, "a reference", file_).required_index(section, section, size);
}

void rebuilt_buffers::write(std::span<std::byte> into) const {
  std::vector<std::uint8_t> elements;
  for (const piece& p : pieces_) {
    std::span<const std::uint8_t> bytes = p.bytes;
    if (p.stride != 0) {
      if (!read_bytes(p.elements, p.stride, elements))
        refuse(file_, "scene.index-out-of-range", "has an accessor with a sparse index beyond its count",
               "export the file again");
      bytes = elements;
    }
    if (!bytes.empty()) std::memcpy(&into[p.offset], bytes.data(), bytes.size());
  }
}

}  // namespace sightcell::scene
