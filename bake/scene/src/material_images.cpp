#include "material_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

namespace sightcell::scene {
namespace {

using nlohmann::json;

const json* member(const json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

// Returns the element of a section that an index in `object` names; null: there is none.
const json* element(const json& sections, const char* section, const json* index, std::uint32_t& number) {
  const json* const list = member(sections, section);
  if (!index || !index->is_number_unsigned() || !list || !list->is_array()) return nullptr;
  const auto value = index->get<std::uint64_t>();
  if (value >= list->size()) return nullptr;
  number = static_cast<std::uint32_t>(value);
  return &(*list)[number];
}

double scale_of(const json& texture_info) {
  const json* const extensions = member(texture_info, "extensions");
  const json* const transform = extensions ? member(*extensions, "KHR_texture_transform") : nullptr;
  const json* const scale = transform ? member(*transform, "scale") : nullptr;
  double largest = 1.0;
  if (scale && scale->is_array())
    for (const json& s : *scale)
      if (s.is_number() && std::isfinite(s.get<double>())) largest = std::max(largest, std::abs(s.get<double>()));
  return largest;
}

texture_kind kind_of(std::string_view key) {
  static constexpr std::array base_colors{"baseColorTexture", "diffuseTexture"};
  static constexpr std::array colors{"emissiveTexture", "specularGlossinessTexture", "sheenColorTexture",
                                     "specularColorTexture", "diffuseTransmissionColorTexture"};
  static constexpr std::array normals{"normalTexture", "clearcoatNormalTexture"};
  const auto is_in = [&](const auto& list) { return std::find(list.begin(), list.end(), key) != list.end(); };
  return is_in(base_colors) ? texture_kind::base_color
         : is_in(colors)    ? texture_kind::color
         : is_in(normals)   ? texture_kind::normals
                            : texture_kind::numbers;
}

// Appends the images of all textures at any depth: extensions of materials have textures, too.
void collect(const json& sections, const json& value, std::vector<material_image>& out) {
  if (!value.is_object()) return;
  for (const auto& [key, child] : value.items()) {
    if (std::string_view(key).ends_with("Texture")) {
      std::uint32_t number = 0;
      const json* const texture = element(sections, "textures", member(child, "index"), number);
      if (!texture) continue;
      const double scale = scale_of(child);
      const texture_kind kind = kind_of(key);
      const auto add = [&](const json& holder) {
        if (element(sections, "images", member(holder, "source"), number)) out.push_back({number, kind, scale});
      };
      add(*texture);
      // EXT_texture_webp and others name an image in place of this one.
      if (const json* const extensions = member(*texture, "extensions"); extensions && extensions->is_object())
        for (const auto& extension : extensions->items()) add(extension.value());
    } else {
      collect(sections, child, out);
    }
  }
}

std::uint64_t set_of(const json& texture_info) {
  std::uint64_t set = 0;
  const json* const extensions = member(texture_info, "extensions");
  const json* const transform = extensions ? member(*extensions, "KHR_texture_transform") : nullptr;
  for (const json* const holder : {&texture_info, transform})  // the latter one overrides the set
    if (const json* const number = holder ? member(*holder, "texCoord") : nullptr;
        number && number->is_number_unsigned())
      set = number->get<std::uint64_t>();
  return set;
}

// At any depth, an object with an index is a texture.
void collect_attributes(const json& value, std::string_view key, std::set<std::string>& out) {
  if (value.is_array())
    for (const json& child : value) collect_attributes(child, key, out);
  if (!value.is_object()) return;
  if (key == "KHR_materials_anisotropy") out.insert("TANGENT");
  if (const json* const index = member(value, "index"); index && index->is_number_unsigned()) {
    out.insert("TEXCOORD_" + std::to_string(set_of(value)));
    if (kind_of(key) == texture_kind::normals) out.insert("TANGENT");
  }
  for (const auto& [name, child] : value.items()) collect_attributes(child, name, out);
}

}  // namespace

std::vector<std::set<std::string>> attributes_by_material(const json& sections) {
  std::vector<std::set<std::string>> out;
  const json* const materials = member(sections, "materials");
  if (!materials || !materials->is_array()) return out;
  for (const json& material : *materials) collect_attributes(material, {}, out.emplace_back());
  return out;
}

std::vector<std::vector<material_image>> images_by_material(const json& sections) {
  std::vector<std::vector<material_image>> out;
  const json* const materials = member(sections, "materials");
  if (!materials || !materials->is_array()) return out;
  for (const json& material : *materials) collect(sections, material, out.emplace_back());
  return out;
}

}  // namespace sightcell::scene
