#include "gltf_document.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "draco_decode.h"
#include "gltf_accessors.h"
#include "gltf_file.h"
#include "gltf_materials.h"
#include "json_object.h"
#include "sightcell/base/json_text.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

constexpr std::uint64_t zero_filled_instance_limit = std::uint64_t{1} << 16;

// Extensions that the import reads.
constexpr std::array<std::string_view, 11> read_extensions = {"EXT_mesh_gpu_instancing",
                                                              "EXT_meshopt_compression",
                                                              "KHR_animation_pointer",
                                                              "KHR_draco_mesh_compression",
                                                              "KHR_lights_punctual",
                                                              "KHR_mesh_quantization",
                                                              "KHR_texture_transform",
                                                              "KHR_materials_pbrSpecularGlossiness",
                                                              "KHR_materials_transmission",
                                                              "KHR_node_visibility",
                                                              "MSFT_lod"};

// Extensions that cannot change which polygons there are and where: families and single names.
constexpr std::array<std::string_view, 7> harmless_families = {
    "KHR_materials_", "ADOBE_materials_", "EXT_materials_", "NV_materials_", "KHR_lights_", "EXT_lights_", "KHR_xmp"};
constexpr std::array<std::string_view, 14> harmless_extensions = {"AGI_stk_metadata",        "CESIUM_primitive_outline",
                                                                  "EXT_feature_metadata",    "EXT_instance_features",
                                                                  "EXT_mesh_features",       "EXT_mesh_manifold",
                                                                  "EXT_structural_metadata", "FB_geometry_metadata",
                                                                  "GODOT_single_root",       "KHR_audio",
                                                                  "KHR_audio_emitter",       "KHR_node_hoverability",
                                                                  "KHR_node_selectability",  "MSFT_audio_emitter"};

// Likewise, but textures that only such an extension has are missing in pictures.
constexpr std::array<std::string_view, 9> texture_extensions = {"EXT_texture_avif",
                                                                "EXT_texture_procedurals",
                                                                "EXT_texture_video",
                                                                "EXT_texture_webp",
                                                                "KHR_texture_basisu",
                                                                "KHR_texture_procedurals",
                                                                "MSFT_packing_normalRoughnessMetallic",
                                                                "MSFT_packing_occlusionRoughnessMetallic",
                                                                "MSFT_texture_dds"};

template <std::size_t N>
bool is_one_of(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Returns whether a file may require the extension.
bool is_supported_extension(std::string_view name) {
  return is_one_of(read_extensions, name) || is_one_of(harmless_extensions, name) ||
         is_one_of(texture_extensions, name) ||
         std::any_of(harmless_families.begin(), harmless_families.end(),
                     [name](std::string_view family) { return name.starts_with(family); });
}

// Joints and weights, four of each.
constexpr std::array<std::pair<const char*, const char*>, 2> influences = {
    {{"JOINTS_0", "WEIGHTS_0"}, {"JOINTS_1", "WEIGHTS_1"}}};

// What nodes need of a mesh besides its triangles.
struct mesh_use {
  bool skinned = false;
  std::vector<bool> targets;  // morph targets with a weight in some node
};

class document_reader {
 public:
  document_reader(const gltf_source& source, const json& parsed, std::optional<std::vector<std::uint8_t>> binary,
                  std::vector<std::string> warnings)
      : source_(source), name_(source.name), root_(parsed, "", source.name), table_(root_, source, std::move(binary)) {
    out_.warnings = std::move(warnings);
    meshes_ = root_.objects("meshes");
    nodes_ = root_.objects("nodes");
    scenes_ = root_.objects("scenes");
    material_count_ = root_.objects("materials").size();
    skins_ = root_.objects("skins");
  }

  gltf_document read();

 private:
  void check_version();
  void check_extensions();
  void note_uses();
  void add_clusters(const json_object& primitive, json& reduced);
  json reduced_mesh(std::size_t mesh);
  std::string uv_key(std::optional<std::uint32_t> material) const;
  json reduced_primitive(const json_object& primitive, const mesh_use& use);
  json reduced_draco(const json_object& primitive, const json_object& attributes, const json_object& draco,
                     std::optional<std::uint32_t> material, const mesh_use& use);
  json reduced_targets(const json_object& primitive, std::uint64_t vertex_count, const mesh_use& use);
  json reduced_skin(std::size_t skin);
  json reduced_node(std::size_t number);
  json reduced_instancing(const json_object& instancing);
  void warn_once(const std::string& line);

  const gltf_source& source_;
  const std::string& name_;
  json_object root_;
  accessor_table table_;
  std::vector<json_object> meshes_, nodes_, scenes_, skins_;
  std::size_t material_count_ = 0;
  std::vector<mesh_use> uses_;                // by mesh
  std::vector<std::vector<double>> weights_;  // of morph targets, by node; empty: all are 0
  std::vector<bool> skin_used_;
  std::map<std::string, json> decoded_primitives_;  // by Draco's view and attributes, as text
  std::set<std::string> warned_;
  gltf_document out_;
};

void document_reader::warn_once(const std::string& line) {
  if (warned_.insert(line).second) out_.warnings.push_back(line);
}

void document_reader::check_version() {
  const auto asset = root_.object("asset");
  if (!asset) {
    warn_once("the file has no \"asset\", taken as glTF 2.0");
    return;
  }
  const std::string version = asset->text("version").value_or("2.0");
  if (version != "2" && !version.starts_with("2.")) {
    refuse(name_, "scene.version", "is glTF " + printable(version) + ", only 2.0 is read", "export it as glTF 2.0");
  }
}

void document_reader::check_extensions() {
  std::map<std::string, extension_use> uses;
  for (const std::string& extension : root_.texts("extensionsRequired")) {
    uses[extension].required = true;
    if (is_supported_extension(extension)) continue;
    refuse(name_, "scene.extension", "requires the extension " + printable(extension) + ", which is not supported",
           "export the scene without it");
  }
  for (const std::string& extension : root_.texts("extensionsUsed")) {
    uses[extension];
    if (!is_supported_extension(extension)) {
      warn_once("the extension " + printable(extension) + " is ignored");
    } else if (is_one_of(texture_extensions, extension)) {
      warn_once("the extension " + printable(extension) + " is ignored: textures may look wrong in pictures");
    }
  }
  for (const auto& [name, use] : uses)
    out_.extensions.push_back({printable(name), use.required, is_one_of(read_extensions, name)});
}

// Returns the texture coordinates of the material's base color.
std::string document_reader::uv_key(std::optional<std::uint32_t> material) const {
  return "TEXCOORD_" + std::to_string(material ? out_.coordinates[*material].set : 0);
}

// Joints and targets are read only for meshes that some node bends or displaces.
void document_reader::note_uses() {
  uses_.resize(meshes_.size());
  weights_.resize(nodes_.size());
  skin_used_.resize(skins_.size(), false);
  std::vector<bool> has_targets;
  for (const json_object& mesh : meshes_) {
    const auto primitives = mesh.objects("primitives");
    has_targets.push_back(
        std::any_of(primitives.begin(), primitives.end(), [](const json_object& p) { return p.has("targets"); }));
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto mesh = nodes_[i].index("mesh", "meshes", meshes_.size());
    if (!mesh) continue;
    mesh_use& use = uses_[*mesh];
    const auto skin = nodes_[i].index("skin", "skins", skins_.size());
    if (skin) use.skinned = skin_used_[*skin] = true;
    if (!has_targets[*mesh]) continue;
    std::vector<double> weights = (nodes_[i].has("weights") ? nodes_[i] : meshes_[*mesh]).reals("weights");
    while (!weights.empty() && weights.back() == 0.0) weights.pop_back();
    use.targets.resize(std::max(use.targets.size(), weights.size()), false);
    for (std::size_t k = 0; k < weights.size(); ++k) use.targets[k] = use.targets[k] || weights[k] != 0.0;
    weights_[i] = std::move(weights);
  }
}

// Targets without a weight in any node are empty, so that the others keep their numbers.
json document_reader::reduced_targets(const json_object& primitive, std::uint64_t vertex_count, const mesh_use& use) {
  json reduced = json::array();
  if (use.targets.empty()) return reduced;
  for (const json_object& target : primitive.objects("targets")) {
    if (reduced.size() == use.targets.size()) break;
    json& entry = reduced.emplace_back(json::object());
    if (!use.targets[reduced.size() - 1]) continue;
    const auto accessor = target.index("POSITION", "accessors", table_.size());
    if (!accessor) continue;
    table_.require(target, *accessor, "displacements", {"VEC3"}, {5120, 5122, 5126});
    if (table_.count(*accessor) != vertex_count) {
      target.fail("scene.bad-field",
                  "has " + std::to_string(table_.count(*accessor)) + " displacements for " +
                      std::to_string(vertex_count) + " positions",
                  "export the file again");
    }
    entry["POSITION"] = *accessor;
  }
  return reduced;
}

json document_reader::reduced_primitive(const json_object& primitive, const mesh_use& use) {
  const std::uint64_t mode = primitive.number("mode", 6).value_or(4);
  json reduced = {{"mode", mode}, {"attributes", json::object()}};
  const auto material = primitive.index("material", "materials", material_count_);
  if (material) reduced["material"] = *material;
  // Points and lines have no polygons, and without positions there are none.
  const auto attributes = primitive.object("attributes");
  if (mode < 4 || !attributes || !attributes->has("POSITION")) return reduced;
  const auto extensions = primitive.object("extensions");
  const std::uint32_t position = attributes->required_index("POSITION", "accessors", table_.size());
  // A file may contain the same triangles uncompressed too.
  if (extensions && extensions->has("KHR_draco_mesh_compression") && !table_.source(position).has("bufferView")) {
    reduced.update(reduced_draco(primitive, *attributes, extensions->required_object("KHR_draco_mesh_compression"),
                                 material, use));
    const std::uint64_t vertices = table_.count(reduced["attributes"]["POSITION"].get<std::uint32_t>());
    reduced["targets"] = reduced_targets(primitive, vertices, use);
    return reduced;
  }
  table_.require(*attributes, position, "positions", {"VEC3"}, {5120, 5121, 5122, 5123, 5126});
  reduced["attributes"]["POSITION"] = position;
  const auto take = [&](const std::string& key, const char* as, const char* what,
                        std::initializer_list<const char*> types, std::initializer_list<int> components) {
    const auto accessor = attributes->index(key.c_str(), "accessors", table_.size());
    if (!accessor) return;
    table_.require(*attributes, *accessor, what, types, components);
    if (table_.count(*accessor) != table_.count(position)) {
      attributes->fail("scene.bad-field",
                       "has " + std::to_string(table_.count(*accessor)) + " " + what + " for " +
                           std::to_string(table_.count(position)) + " positions",
                       "export the file again");
    }
    reduced["attributes"][as] = *accessor;
  };
  take(uv_key(material), "TEXCOORD_0", "texture coordinates", {"VEC2"}, {5120, 5121, 5122, 5123, 5126});
  take("COLOR_0", "COLOR_0", "colors", {"VEC3", "VEC4"}, {5121, 5123, 5126});
  for (const auto& [joints, weights] : influences) {
    if (!use.skinned || !attributes->has(joints) || !attributes->has(weights)) break;
    take(joints, joints, "joints", {"VEC4"}, {5121, 5123});
    take(weights, weights, "weights", {"VEC4"}, {5121, 5123, 5126});
  }
  reduced["targets"] = reduced_targets(primitive, table_.count(position), use);
  const auto indices = primitive.index("indices", "accessors", table_.size());
  if (indices) {
    table_.require(primitive, *indices, "indices", {"SCALAR"}, {5121, 5123, 5125});
    reduced["indices"] = *indices;
  }
  return reduced;
}

// Returns what replaces attributes, indices and mode of a compressed primitive.
json document_reader::reduced_draco(const json_object& primitive, const json_object& attributes,
                                    const json_object& draco, std::optional<std::uint32_t> material,
                                    const mesh_use& use) {
  const std::uint32_t view_index = draco.required_index("bufferView", "bufferViews", table_.view_count());
  const json_object ids = draco.required_object("attributes");
  // The name in the reduced document, the type there, and the attribute of the stream.
  struct wanted {
    const char *as, *type;
    draco_wish wish;
  };
  std::vector<wanted> wants = {
      {"POSITION", "VEC3", {static_cast<std::uint32_t>(ids.required_number("POSITION", UINT32_MAX)), 3}}};
  if (const auto uv = ids.number(uv_key(material).c_str(), UINT32_MAX))
    wants.push_back({"TEXCOORD_0", "VEC2", {static_cast<std::uint32_t>(*uv), 2}});
  const auto color_accessor = attributes.index("COLOR_0", "accessors", table_.size());
  if (const auto color = ids.number("COLOR_0", UINT32_MAX); color && color_accessor) {
    const bool has_alpha = table_.source(*color_accessor).required_text("type") == "VEC4";
    wants.push_back(
        {"COLOR_0", has_alpha ? "VEC4" : "VEC3", {static_cast<std::uint32_t>(*color), has_alpha ? 4u : 3u}});
  }
  for (const auto& [joints, weights] : influences) {
    const auto joints_id = ids.number(joints, UINT32_MAX), weights_id = ids.number(weights, UINT32_MAX);
    if (!use.skinned || !joints_id || !weights_id) break;
    wants.push_back({joints, "VEC4", {static_cast<std::uint32_t>(*joints_id), 4}});
    wants.push_back({weights, "VEC4", {static_cast<std::uint32_t>(*weights_id), 4}});
  }
  std::vector<draco_wish> wishes;
  for (const wanted& w : wants) wishes.push_back(w.wish);
  std::string key = std::to_string(view_index);
  for (const wanted& w : wants) key += std::string(" ") + w.as + " " + std::to_string(w.wish.id);
  const auto known = decoded_primitives_.find(key);
  if (known != decoded_primitives_.end()) return known->second;

  const std::span<const std::uint8_t> stream = table_.bytes_of_view(view_index);
  table_.count_compressed(draco, stream.size());
  std::string why_not;
  const auto mesh = decode_draco(stream, wishes, why_not);
  if (!mesh) draco.fail("scene.draco", "cannot be decoded: " + printable(why_not), "export the file again");
  // Source ids are counted from the accessors, so a stream with another number of elements would shift all ids after
  // it.
  const auto require_count = [&](const json_object& user, const char* key_of, std::uint64_t decoded) {
    const auto accessor = user.index(key_of, "accessors", table_.size());
    if (!accessor) return;
    const std::uint64_t promised = table_.source(*accessor).required_number("count", UINT32_MAX);
    if (promised != decoded) {
      draco.fail("scene.draco",
                 "holds " + std::to_string(decoded) + " of what accessors[" + std::to_string(*accessor) + "] counts " +
                     std::to_string(promised) + " of",
                 "export the file again");
    }
  };
  require_count(attributes, "POSITION", mesh->vertex_count);
  if (primitive.number("mode", 6).value_or(4) == 4) require_count(primitive, "indices", mesh->indices.size());

  json reduced = {{"mode", 4}, {"attributes", json::object()}};
  for (std::size_t i = 0; i < wants.size(); ++i)
    reduced["attributes"][wants[i].as] = table_.add(mesh->attributes[i], wants[i].type, wants[i].wish.width);
  reduced["indices"] = table_.add(mesh->indices, "SCALAR", 1);
  decoded_primitives_.emplace(std::move(key), reduced);
  return reduced;
}

// Adds the accessor of the host's clusters, extras.sightcell.clusters, as one more attribute.
void document_reader::add_clusters(const json_object& primitive, json& reduced) {
  const json* extras = primitive.raw("extras");
  if (extras == nullptr || !extras->is_object() || !reduced.contains("attributes")) return;
  const auto marks = extras->find("sightcell");
  if (marks == extras->end() || !marks->is_object()) return;
  const json_object given = primitive.required_object("extras").required_object("sightcell");
  const auto index = given.index("clusters", "accessors", table_.size());
  if (!index) return;
  table_.require(given, *index, "clusters", {"SCALAR"}, {5121, 5123, 5125});
  reduced["attributes"][clusters_attribute] = *index;
}

json document_reader::reduced_mesh(std::size_t mesh) {
  json primitives = json::array();
  for (const json_object& primitive : meshes_[mesh].objects("primitives")) {
    json& reduced = primitives.emplace_back(reduced_primitive(primitive, uses_[mesh]));
    add_clusters(primitive, reduced);
  }
  return {{"primitives", std::move(primitives)}};
}

json document_reader::reduced_instancing(const json_object& instancing) {
  const json_object attributes = instancing.required_object("attributes");
  json reduced = json::object();
  std::optional<std::uint64_t> count;
  for (const auto& [key, type] : {std::pair{"TRANSLATION", "VEC3"}, {"ROTATION", "VEC4"}, {"SCALE", "VEC3"}}) {
    const auto index = attributes.index(key, "accessors", table_.size());
    if (!index) continue;
    table_.require(attributes, *index, key, {type}, {5120, 5122, 5126});
    if (count && *count != table_.count(*index)) {
      attributes.fail("scene.bad-field", "has attributes of different counts", "export the file again");
    }
    count = table_.count(*index);
    // An accessor without a buffer view takes no bytes in the file.
    if (!table_.source(*index).has("bufferView") && *count > zero_filled_instance_limit) {
      attributes.fail("scene.too-large", "asks for " + std::to_string(*count) + " instances that are not in the file",
                      "export the file again");
    }
    reduced[key] = *index;
  }
  if (!count) {
    attributes.fail("scene.missing-field", "has none of TRANSLATION, ROTATION and SCALE", "export the file again");
  }
  return {{"attributes", std::move(reduced)}};
}

json document_reader::reduced_skin(std::size_t skin) {
  if (!skin_used_[skin]) return {{"joints", json::array()}};
  const auto joints = skins_[skin].indices("joints", "nodes", nodes_.size());
  if (joints.empty()) skins_[skin].fail("scene.missing-field", "has no joints", "export the file again");
  json reduced = {{"joints", joints}};
  const auto bind = skins_[skin].index("inverseBindMatrices", "accessors", table_.size());
  if (!bind) return reduced;
  table_.require(skins_[skin], *bind, "inverse bind matrices", {"MAT4"}, {5126});
  if (table_.count(*bind) < joints.size()) {
    skins_[skin].fail("scene.bad-field",
                      "has " + std::to_string(table_.count(*bind)) + " inverse bind matrices for " +
                          std::to_string(joints.size()) + " joints",
                      "export the file again");
  }
  reduced["inverseBindMatrices"] = *bind;
  return reduced;
}

json document_reader::reduced_node(std::size_t number) {
  const json_object& node = nodes_[number];
  json reduced = {{"name", node.text("name").value_or("")}};  // unchanged, because cells files refer to nodes by name
  const auto mesh = node.index("mesh", "meshes", meshes_.size());
  if (mesh) reduced["mesh"] = *mesh;
  if (node.has("camera")) reduced["camera"] = 0;  // that it has one is all that counts
  const auto children = node.indices("children", "nodes", nodes_.size());
  if (!children.empty()) reduced["children"] = children;
  const auto matrix = node.reals("matrix", 16);
  if (!matrix.empty()) {
    reduced["matrix"] = matrix;
  } else {
    for (const auto& [key, count] :
         {std::pair<const char*, std::size_t>{"translation", 3}, {"rotation", 4}, {"scale", 3}}) {
      const auto values = node.reals(key, count);
      if (!values.empty()) reduced[key] = values;
    }
  }
  const auto skin = mesh ? node.index("skin", "skins", skins_.size()) : std::nullopt;
  if (skin) reduced["skin"] = *skin;
  if (!weights_[number].empty()) reduced["weights"] = weights_[number];
  const auto extensions = node.object("extensions");
  if (mesh && extensions && extensions->has("EXT_mesh_gpu_instancing")) {
    const json_object instancing = extensions->required_object("EXT_mesh_gpu_instancing");
    reduced["extensions"] = {{"EXT_mesh_gpu_instancing", reduced_instancing(instancing)}};
  }
  return reduced;
}

gltf_document document_reader::read() {
  check_version();
  check_extensions();
  const auto bytes_of_view = [this](std::uint32_t index) { return table_.bytes_of_view(index); };
  material_set materials = read_materials(root_, source_, bytes_of_view, table_.view_count(), out_.warnings);
  out_.materials = std::move(materials.materials);
  out_.coordinates = std::move(materials.coordinates);
  out_.images = std::move(materials.images);
  out_.nodes = read_nodes(root_, out_.warnings);
  out_.lights = read_lights(root_);

  json reduced = {{"asset", {{"version", "2.0"}}}};
  reduced["meshes"] = json::array();
  note_uses();
  for (std::size_t i = 0; i < meshes_.size(); ++i) reduced["meshes"].push_back(reduced_mesh(i));
  reduced["nodes"] = json::array();
  for (std::size_t i = 0; i < nodes_.size(); ++i) reduced["nodes"].push_back(reduced_node(i));
  reduced["skins"] = json::array();
  for (std::size_t i = 0; i < skins_.size(); ++i) reduced["skins"].push_back(reduced_skin(i));
  reduced["scenes"] = json::array();
  for (const json_object& scene : scenes_) {
    reduced["scenes"].push_back({{"nodes", scene.indices("nodes", "nodes", nodes_.size())}});
  }
  const auto default_scene = root_.index("scene", "scenes", scenes_.size());
  if (default_scene) reduced["scene"] = *default_scene;

  table_.write_stubs(reduced);
  out_.accessors = table_.all_elements();
  out_.buffers = table_.take_buffers();
  out_.json = reduced.dump();
  return std::move(out_);
}

}  // namespace

gltf_document read_gltf_document(gltf_file file, const gltf_source& source) {
  json parsed;
  try {
    parsed = parse_json(file.json);
  } catch (const json::exception& e) {
    refuse(source.name, "scene.bad-json", "its JSON cannot be parsed: " + printable(e.what(), 160),
           "the file is damaged: copy or export it again");
  }
  file.json = std::string();
  return document_reader(source, parsed, std::move(file.binary), std::move(file.warnings)).read();
}

}  // namespace sightcell::scene
