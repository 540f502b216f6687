#include "materials.h"

#include <nlohmann/json.hpp>
#include <string>

#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace stream_client {
namespace {

using nlohmann::json;
using sightcell::scene::alpha_mode;
using sightcell::scene::wrap;

// A member, or null. The JSON is that of the scene: members of another type count as missing.
const json& member(const json& object, const char* key) {
  static const json nothing;
  const auto found = object.find(key);
  return object.is_object() && found != object.end() ? *found : nothing;
}

float real_or(const json& object, const char* key, float otherwise) {
  const json& value = member(object, key);
  return value.is_number() ? value.get<float>() : otherwise;
}

std::uint32_t index_or(const json& object, const char* key, std::uint32_t otherwise) {
  const json& value = member(object, key);
  return value.is_number_unsigned() && value.get<std::uint64_t>() < no_image ? value.get<std::uint32_t>() : otherwise;
}

template <class Vector>
Vector reals_or(const json& object, const char* key, Vector otherwise) {
  const json& values = member(object, key);
  if (!values.is_array() || values.size() != static_cast<std::size_t>(Vector::length())) return otherwise;
  Vector out = otherwise;
  for (int i = 0; i < Vector::length(); ++i) {
    const json& value = values[static_cast<std::size_t>(i)];
    if (value.is_number()) out[i] = value.get<float>();
  }
  return out;
}

const json& element(const json& list, std::uint32_t index) {
  static const json nothing;
  return list.is_array() && index < list.size() ? list[index] : nothing;
}

wrap wrap_of(const json& sampler, const char* key) {
  const std::uint32_t mode = index_or(sampler, key, 10497);
  return mode == 33071 ? wrap::clamp : mode == 33648 ? wrap::mirror : wrap::repeat;
}

void read_texture(const json& document, const json& info, material& m) {
  const json& texture = element(member(document, "textures"), index_or(info, "index", no_image));
  m.image = index_or(texture, "source", no_image);
  m.uv_set = index_or(info, "texCoord", 0);
  const json& transform = member(member(info, "extensions"), "KHR_texture_transform");
  m.uv_scale = reals_or(transform, "scale", m.uv_scale);
  m.uv_offset = reals_or(transform, "offset", m.uv_offset);
  m.uv_rotation = real_or(transform, "rotation", 0.0f);
  m.uv_set = index_or(transform, "texCoord", m.uv_set);
  const json& sampler = element(member(document, "samplers"), index_or(texture, "sampler", no_image));
  m.wrap_u = wrap_of(sampler, "wrapS");
  m.wrap_v = wrap_of(sampler, "wrapT");
}

material read_material(const json& document, const json& source) {
  material m;
  const json& mode = member(source, "alphaMode");
  m.alpha = mode == "MASK" ? alpha_mode::mask : mode == "BLEND" ? alpha_mode::blend : alpha_mode::opaque;
  m.alpha_cutoff = real_or(source, "alphaCutoff", m.alpha_cutoff);
  m.double_sided = member(source, "doubleSided") == true;
  const json& diffuse = member(member(source, "extensions"), "KHR_materials_pbrSpecularGlossiness");
  const json& color = diffuse.is_object() ? diffuse : member(source, "pbrMetallicRoughness");
  m.base_color = reals_or(color, diffuse.is_object() ? "diffuseFactor" : "baseColorFactor", m.base_color);
  const json& texture = member(color, diffuse.is_object() ? "diffuseTexture" : "baseColorTexture");
  if (texture.is_object()) read_texture(document, texture, m);
  const json& transmission = member(member(source, "extensions"), "KHR_materials_transmission");
  if (real_or(transmission, "transmissionFactor", 0.0f) > 0.0f) m.alpha = alpha_mode::blend;
  return m;
}

}  // namespace

std::vector<material> read_materials(std::string_view text) {
  const json document = text.empty() ? json::object() : sightcell::scene::parse_json(text, false);
  if (!document.is_object()) {
    throw sightcell::error(sightcell::error_kind::bad_input, "client.materials", "the front",
                           "its materials are no JSON", "pack the scene again");
  }
  std::vector<material> out;
  const json& materials = member(document, "materials");
  if (materials.is_array()) {
    for (const json& source : materials) out.push_back(read_material(document, source));
  }
  out.emplace_back();
  return out;
}

}  // namespace stream_client
