#include "gltf_document.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "accessor.h"
#include "draco_decode.h"
#include "gltf_file.h"
#include "gltf_materials.h"
#include "json_object.h"
#include "meshopt_decode.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

constexpr std::uint64_t byte_limit = std::uint64_t{1} << 40;  // keeps sums of offsets and lengths far from overflow
// An accessor without a buffer view costs a file nothing and us memory; real ones are bounded by the file's bytes.
constexpr std::uint64_t zero_filled_limit = std::uint64_t{1} << 24;

// What a file may require: read here, or without influence on which polygons there are and where.
bool is_supported_extension(std::string_view name) {
  static constexpr std::array<std::string_view, 9> known = {
      "EXT_mesh_gpu_instancing", "KHR_mesh_quantization", "EXT_meshopt_compression", "KHR_draco_mesh_compression",
      "KHR_texture_transform",   "KHR_lights_punctual",   "KHR_xmp_json_ld",         "EXT_texture_webp",
      "KHR_texture_basisu"};
  return name.starts_with("KHR_materials_") || std::find(known.begin(), known.end(), name) != known.end();
}

// Supported in the sense above, but a picture will show the difference.
bool is_ignored_in_pictures(std::string_view name) {
  return name == "EXT_texture_webp" || name == "KHR_texture_basisu";
}

struct view_bytes {
  std::uint32_t buffer = 0;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::uint64_t stride = 0;  // 0: tightly packed
};

class document_reader {
 public:
  document_reader(const std::filesystem::path& path, const json& parsed,
                  std::optional<std::vector<std::uint8_t>> binary, const std::string& name,
                  std::vector<std::string> warnings)
      : path_(path), binary_(std::move(binary)), name_(name), root_(parsed, "", name) {
    out_.warnings = std::move(warnings);
    accessors_ = root_.objects("accessors");
    views_ = root_.objects("bufferViews");
    buffers_ = root_.objects("buffers");
    meshes_ = root_.objects("meshes");
    nodes_ = root_.objects("nodes");
    scenes_ = root_.objects("scenes");
    material_count_ = root_.objects("materials").size();
    skin_count_ = root_.objects("skins").size();
    reduced_accessors_.resize(accessors_.size());
    reduced_views_.resize(views_.size());
    out_.buffers.resize(buffers_.size());
  }

  gltf_document read();

 private:
  void check_version();
  void check_extensions();
  std::span<const std::uint8_t> buffer(std::uint32_t index);
  view_bytes view(std::uint32_t index);
  json reduced_mesh(const json_object& mesh);
  std::string uv_key(std::optional<std::uint32_t> material) const;
  json reduced_primitive(const json_object& primitive);
  json reduced_draco(const json_object& primitive, const json_object& attributes, const json_object& draco,
                     std::optional<std::uint32_t> material);
  std::uint32_t decoded_buffer(std::uint32_t view_index, const json_object& meshopt);
  std::uint32_t add_buffer(std::vector<std::uint8_t> bytes);
  template <typename T>
  std::uint32_t add_accessor(const std::vector<T>& values, const char* type, std::uint64_t width);
  json reduced_node(const json_object& node);
  json reduced_instancing(const json_object& instancing);
  void use_accessor(std::uint32_t index);
  void add_zero_view(std::uint32_t accessor);
  void use_sparse(const json_object& accessor, std::uint64_t count, std::uint64_t element_size, json& reduced);
  void use_bytes(const json_object& user, std::uint32_t view_index, std::uint64_t offset, std::uint64_t need);
  std::uint64_t accessor_count(std::uint32_t index) {
    return reduced_accessors_[index].at("count").get<std::uint64_t>();
  }
  void require_accessor(const json_object& user, std::uint32_t index, const char* what,
                        std::initializer_list<const char*> types, std::initializer_list<int> components);
  void warn_once(const std::string& line);

  const std::filesystem::path& path_;
  std::optional<std::vector<std::uint8_t>> binary_;
  const std::string& name_;
  json_object root_;
  std::vector<json_object> accessors_, views_, buffers_, meshes_, nodes_, scenes_;
  std::size_t material_count_ = 0, skin_count_ = 0;
  std::vector<json> reduced_accessors_, reduced_views_;     // null until used
  std::map<std::uint32_t, std::uint32_t> decoded_buffers_;  // by compressed view
  std::map<std::string, json> decoded_primitives_;          // by Draco's view and attributes, as text
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
  for (const std::string& extension : root_.texts("extensionsRequired")) {
    if (is_supported_extension(extension)) continue;
    refuse(name_, "scene.extension", "requires the extension " + printable(extension) + ", which is not supported",
           "export the scene without it");
  }
  for (const std::string& extension : root_.texts("extensionsUsed")) {
    if (!is_supported_extension(extension)) {
      warn_once("the extension " + printable(extension) + " is ignored");
    } else if (is_ignored_in_pictures(extension)) {
      warn_once("the extension " + printable(extension) + " is ignored: textures may look wrong in pictures");
    }
  }
}

// Loaded at first use, so that a missing animation file does not refuse a scene.
std::span<const std::uint8_t> document_reader::buffer(std::uint32_t index) {
  std::vector<std::uint8_t>& bytes = out_.buffers[index];
  if (!bytes.empty()) return bytes;
  const json_object& source = buffers_[index];
  const std::uint64_t length = source.required_number("byteLength", byte_limit);
  if (length == 0) source.fail("scene.buffer-size", "has a byteLength of 0", "export the file again");
  const auto uri = source.text("uri");
  if (uri) {
    bytes = read_resource(path_, *uri, source.where(), length);
  } else if (index == 0 && binary_) {
    if (length > binary_->size()) {
      source.fail("scene.buffer-size",
                  "needs " + std::to_string(length) + " bytes but the .glb holds " + std::to_string(binary_->size()),
                  "the file is cut short: copy or export it again");
    }
    bytes = *std::move(binary_);
    binary_.reset();
    bytes.resize(length);
  } else {
    source.fail("scene.missing-field", "has no \"uri\" and there is no binary chunk for it", "export the file again");
  }
  return bytes;
}

// The buffer of our own that holds a compressed view's bytes.
std::uint32_t document_reader::decoded_buffer(std::uint32_t view_index, const json_object& meshopt) {
  const auto known = decoded_buffers_.find(view_index);
  if (known != decoded_buffers_.end()) return known->second;
  const std::uint32_t from = meshopt.required_index("buffer", "buffers", buffers_.size());
  const std::uint64_t offset = meshopt.number("byteOffset", byte_limit).value_or(0);
  const std::uint64_t length = meshopt.required_number("byteLength", byte_limit);
  const std::span<const std::uint8_t> all = buffer(from);
  if (offset + length > all.size()) {
    meshopt.fail("scene.buffer-size",
                 "ends at byte " + std::to_string(offset + length) + " of a buffer of " + std::to_string(all.size()),
                 "export the file again");
  }
  const meshopt_stream stream{meshopt.required_text("mode"), meshopt.text("filter").value_or("NONE"),
                              meshopt.required_number("count", UINT32_MAX), meshopt.required_number("byteStride", 256)};
  std::string why_not;
  auto bytes = decode_meshopt(stream, all.subspan(offset, length), why_not);
  if (!bytes) meshopt.fail("scene.meshopt", "cannot be decoded: " + why_not, "export the file again");
  const std::uint32_t made = add_buffer(std::move(*bytes));
  decoded_buffers_.emplace(view_index, made);
  return made;
}

std::uint32_t document_reader::add_buffer(std::vector<std::uint8_t> bytes) {
  if (bytes.empty()) bytes.resize(1);  // empty means not loaded yet
  out_.buffers.push_back(std::move(bytes));
  return static_cast<std::uint32_t>(out_.buffers.size() - 1);
}

// Numbers of our own as an accessor of the reduced document.
template <typename T>
std::uint32_t document_reader::add_accessor(const std::vector<T>& values, const char* type, std::uint64_t width) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  const std::size_t length = std::max<std::size_t>(bytes.size(), 1);
  reduced_accessors_.push_back({{"type", type},
                                {"componentType", std::is_same_v<T, float> ? 5126 : 5125},
                                {"count", values.size() / width},
                                {"normalized", false},
                                {"bufferView", reduced_views_.size()},
                                {"byteOffset", 0}});
  reduced_views_.push_back({{"buffer", add_buffer(std::move(bytes))}, {"byteOffset", 0}, {"byteLength", length}});
  return static_cast<std::uint32_t>(reduced_accessors_.size() - 1);
}

view_bytes document_reader::view(std::uint32_t index) {
  const json_object& source = views_[index];
  view_bytes out;
  out.buffer = source.required_index("buffer", "buffers", buffers_.size());
  out.offset = source.number("byteOffset", byte_limit).value_or(0);
  out.length = source.required_number("byteLength", byte_limit);
  out.stride = source.number("byteStride", 252).value_or(0);
  const auto extensions = source.object("extensions");
  if (extensions && extensions->has("EXT_meshopt_compression")) {
    const json_object meshopt = extensions->required_object("EXT_meshopt_compression");
    out.buffer = decoded_buffer(index, meshopt);
    out.offset = 0;
  } else if (extensions && extensions->has("KHR_meshopt_compression")) {
    source.fail("scene.extension", "is compressed with KHR_meshopt_compression, which is not supported",
                "export the scene without it");
  }
  const std::size_t size = buffer(out.buffer).size();
  if (out.offset + out.length > size) {
    source.fail("scene.buffer-size",
                "ends at byte " + std::to_string(out.offset + out.length) + " of a buffer of " + std::to_string(size),
                "export the file again");
  }
  if (out.stride % 4 != 0) {
    source.fail("scene.bad-field", "has a byteStride of " + std::to_string(out.stride) + ", not a multiple of 4",
                "export the file again");
  }
  return out;
}

void document_reader::use_bytes(const json_object& user, std::uint32_t view_index, std::uint64_t offset,
                                std::uint64_t need) {
  const view_bytes v = view(view_index);
  if (offset + need > v.length) {
    user.fail("scene.accessor-bounds",
              "reads up to byte " + std::to_string(offset + need) + " of bufferViews[" + std::to_string(view_index) +
                  "], which has " + std::to_string(v.length),
              "export the file again");
  }
  reduced_views_[view_index] = {{"buffer", v.buffer}, {"byteOffset", v.offset}, {"byteLength", v.length}};
  if (v.stride != 0) reduced_views_[view_index]["byteStride"] = v.stride;
}

std::uint64_t width_of(const std::string& type) {
  static const std::array<std::pair<std::string_view, std::uint64_t>, 4> widths = {
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}}};
  for (const auto& [name, width] : widths) {
    if (name == type) return width;
  }
  return 0;
}

void document_reader::use_accessor(std::uint32_t index) {
  if (!reduced_accessors_[index].is_null()) return;
  const json_object& source = accessors_[index];
  const std::string type = source.required_text("type");
  const int component = static_cast<int>(source.required_number("componentType", INT32_MAX));
  const std::uint64_t count = source.required_number("count", UINT32_MAX);
  const std::uint64_t element = width_of(type) * component_size(component);
  if (element == 0) {
    source.fail("scene.accessor-type",
                "has the type " + printable(type) + " of component type " + std::to_string(component) +
                    ", which geometry cannot have",
                "export the file again");
  }
  json reduced = {{"type", type},
                  {"componentType", component},
                  {"count", count},
                  {"normalized", source.boolean("normalized").value_or(false)}};
  const auto view_index = source.index("bufferView", "bufferViews", views_.size());
  if (view_index) {
    const std::uint64_t offset = source.number("byteOffset", byte_limit).value_or(0);
    const std::uint64_t declared = views_[*view_index].number("byteStride", 252).value_or(0);
    const std::uint64_t stride = declared == 0 ? element : declared;
    if (stride < element) {
      source.fail(
          "scene.bad-field",
          "has elements of " + std::to_string(element) + " bytes in a buffer view of stride " + std::to_string(stride),
          "export the file again");
    }
    use_bytes(source, *view_index, offset, count == 0 ? 0 : (count - 1) * stride + element);
    reduced["bufferView"] = *view_index;
    reduced["byteOffset"] = offset;
  } else if (count > zero_filled_limit) {
    source.fail("scene.too-large", "asks for " + std::to_string(count) + " elements that are not in the file",
                "export the file again");
  }
  if (source.has("sparse")) use_sparse(source, count, element, reduced);
  reduced_accessors_[index] = std::move(reduced);
}

void document_reader::use_sparse(const json_object& accessor, std::uint64_t count, std::uint64_t element_size,
                                 json& reduced) {
  const json_object sparse = accessor.required_object("sparse");
  const std::uint64_t sparse_count = sparse.required_number("count", count);
  const json_object indices = sparse.required_object("indices");
  const json_object values = sparse.required_object("values");
  const int component = static_cast<int>(indices.required_number("componentType", INT32_MAX));
  if (component != 5121 && component != 5123 && component != 5125) {
    indices.fail("scene.accessor-type", "has component type " + std::to_string(component) + ", not an unsigned integer",
                 "export the file again");
  }
  const std::uint64_t index_offset = indices.number("byteOffset", INT32_MAX).value_or(0);
  const std::uint64_t value_offset = values.number("byteOffset", INT32_MAX).value_or(0);
  const std::uint32_t index_view = indices.required_index("bufferView", "bufferViews", views_.size());
  const std::uint32_t value_view = values.required_index("bufferView", "bufferViews", views_.size());
  use_bytes(indices, index_view, index_offset, sparse_count * component_size(component));
  use_bytes(values, value_view, value_offset, sparse_count * element_size);
  reduced["sparse"] = {
      {"count", sparse_count},
      {"indices", {{"bufferView", index_view}, {"byteOffset", index_offset}, {"componentType", component}}},
      {"values", {{"bufferView", value_view}, {"byteOffset", value_offset}}}};
}

void document_reader::require_accessor(const json_object& user, std::uint32_t index, const char* what,
                                       std::initializer_list<const char*> types,
                                       std::initializer_list<int> components) {
  use_accessor(index);
  const std::string type = reduced_accessors_[index].at("type").get<std::string>();
  const int component = reduced_accessors_[index].at("componentType").get<int>();
  const bool fits = std::find(types.begin(), types.end(), type) != types.end() &&
                    std::find(components.begin(), components.end(), component) != components.end();
  if (!fits) {
    user.fail("scene.accessor-type",
              std::string("takes its ") + what + " from accessors[" + std::to_string(index) + "] of type " +
                  printable(type) + " and component type " + std::to_string(component),
              "export the file again");
  }
}

// tinygltf refuses indices without a buffer view, which glTF allows: they are all zero.
void document_reader::add_zero_view(std::uint32_t accessor) {
  json& reduced = reduced_accessors_[accessor];
  const std::size_t bytes =
      std::max<std::size_t>(1, accessor_count(accessor) * component_size(reduced.at("componentType").get<int>()));
  reduced["bufferView"] = reduced_views_.size();
  reduced_views_.push_back({{"buffer", out_.buffers.size()}, {"byteLength", bytes}});
  out_.buffers.emplace_back(bytes);
}

// The coordinates that the material's base color texture takes.
std::string document_reader::uv_key(std::optional<std::uint32_t> material) const {
  return "TEXCOORD_" + std::to_string(material ? out_.coordinates[*material].set : 0);
}

json document_reader::reduced_primitive(const json_object& primitive) {
  const std::uint64_t mode = primitive.number("mode", 6).value_or(4);
  json reduced = {{"mode", mode}, {"attributes", json::object()}};
  const auto material = primitive.index("material", "materials", material_count_);
  if (material) reduced["material"] = *material;
  // Points and lines count nothing, and without positions there is nothing to see.
  const auto attributes = primitive.object("attributes");
  if (mode < 4 || !attributes || !attributes->has("POSITION")) return reduced;
  const auto extensions = primitive.object("extensions");
  const std::uint32_t position = attributes->required_index("POSITION", "accessors", accessors_.size());
  // A file may bring the same triangles uncompressed too.
  if (extensions && extensions->has("KHR_draco_mesh_compression") && !accessors_[position].has("bufferView")) {
    reduced.update(
        reduced_draco(primitive, *attributes, extensions->required_object("KHR_draco_mesh_compression"), material));
    return reduced;
  }
  require_accessor(*attributes, position, "positions", {"VEC3"}, {5120, 5121, 5122, 5123, 5126});
  reduced["attributes"]["POSITION"] = position;
  const auto take = [&](const std::string& key, const char* as, const char* what,
                        std::initializer_list<const char*> types, std::initializer_list<int> components) {
    const auto accessor = attributes->index(key.c_str(), "accessors", accessors_.size());
    if (!accessor) return;
    require_accessor(*attributes, *accessor, what, types, components);
    if (accessor_count(*accessor) != accessor_count(position)) {
      attributes->fail("scene.bad-field",
                       "has " + std::to_string(accessor_count(*accessor)) + " " + what + " for " +
                           std::to_string(accessor_count(position)) + " positions",
                       "export the file again");
    }
    reduced["attributes"][as] = *accessor;
  };
  take(uv_key(material), "TEXCOORD_0", "texture coordinates", {"VEC2"}, {5120, 5121, 5122, 5123, 5126});
  take("COLOR_0", "COLOR_0", "colors", {"VEC3", "VEC4"}, {5121, 5123, 5126});
  const auto indices = primitive.index("indices", "accessors", accessors_.size());
  if (indices) {
    require_accessor(primitive, *indices, "indices", {"SCALAR"}, {5121, 5123, 5125});
    if (!reduced_accessors_[*indices].contains("bufferView")) add_zero_view(*indices);
    reduced["indices"] = *indices;
  }
  return reduced;
}

// What replaces attributes, indices and mode of a compressed primitive.
json document_reader::reduced_draco(const json_object& primitive, const json_object& attributes,
                                    const json_object& draco, std::optional<std::uint32_t> material) {
  const std::uint32_t view_index = draco.required_index("bufferView", "bufferViews", views_.size());
  const json_object ids = draco.required_object("attributes");
  // What the reduced document calls it, its type there, and what the stream calls it.
  struct wanted {
    const char *as, *type;
    draco_wish wish;
  };
  std::vector<wanted> wants = {
      {"POSITION", "VEC3", {static_cast<std::uint32_t>(ids.required_number("POSITION", UINT32_MAX)), 3}}};
  if (const auto uv = ids.number(uv_key(material).c_str(), UINT32_MAX))
    wants.push_back({"TEXCOORD_0", "VEC2", {static_cast<std::uint32_t>(*uv), 2}});
  const auto color_accessor = attributes.index("COLOR_0", "accessors", accessors_.size());
  if (const auto color = ids.number("COLOR_0", UINT32_MAX); color && color_accessor) {
    const bool has_alpha = accessors_[*color_accessor].required_text("type") == "VEC4";
    wants.push_back(
        {"COLOR_0", has_alpha ? "VEC4" : "VEC3", {static_cast<std::uint32_t>(*color), has_alpha ? 4u : 3u}});
  }
  std::vector<draco_wish> wishes;
  for (const wanted& w : wants) wishes.push_back(w.wish);
  std::string key = std::to_string(view_index);
  for (const wanted& w : wants) key += std::string(" ") + w.as + " " + std::to_string(w.wish.id);
  const auto known = decoded_primitives_.find(key);
  if (known != decoded_primitives_.end()) return known->second;

  const view_bytes v = view(view_index);
  std::string why_not;
  const auto mesh = decode_draco(buffer(v.buffer).subspan(v.offset, v.length), wishes, why_not);
  if (!mesh) draco.fail("scene.draco", "cannot be decoded: " + printable(why_not), "export the file again");
  // Source ids count what the accessors promise: a stream that holds something else would shift all that follow.
  const auto require_count = [&](const json_object& user, const char* key_of, std::uint64_t decoded) {
    const auto accessor = user.index(key_of, "accessors", accessors_.size());
    if (!accessor) return;
    const std::uint64_t promised = accessors_[*accessor].required_number("count", UINT32_MAX);
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
    reduced["attributes"][wants[i].as] = add_accessor(mesh->attributes[i], wants[i].type, wants[i].wish.width);
  reduced["indices"] = add_accessor(mesh->indices, "SCALAR", 1);
  decoded_primitives_.emplace(std::move(key), reduced);
  return reduced;
}

json document_reader::reduced_mesh(const json_object& mesh) {
  json primitives = json::array();
  for (const json_object& primitive : mesh.objects("primitives")) primitives.push_back(reduced_primitive(primitive));
  return {{"primitives", std::move(primitives)}};
}

json document_reader::reduced_instancing(const json_object& instancing) {
  const json_object attributes = instancing.required_object("attributes");
  json reduced = json::object();
  std::optional<std::uint64_t> count;
  for (const auto& [key, type] : {std::pair{"TRANSLATION", "VEC3"}, {"ROTATION", "VEC4"}, {"SCALE", "VEC3"}}) {
    const auto index = attributes.index(key, "accessors", accessors_.size());
    if (!index) continue;
    require_accessor(attributes, *index, key, {type}, {5120, 5122, 5126});
    if (count && *count != accessor_count(*index)) {
      attributes.fail("scene.bad-field", "has attributes of different counts", "export the file again");
    }
    count = accessor_count(*index);
    reduced[key] = *index;
  }
  if (!count) {
    attributes.fail("scene.missing-field", "has none of TRANSLATION, ROTATION and SCALE", "export the file again");
  }
  return {{"attributes", std::move(reduced)}};
}

json document_reader::reduced_node(const json_object& node) {
  json reduced = {{"name", printable(node.text("name").value_or(""))}};
  const auto mesh = node.index("mesh", "meshes", meshes_.size());
  if (mesh) reduced["mesh"] = *mesh;
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
  const auto skin = mesh ? node.index("skin", "skins", skin_count_) : std::nullopt;
  if (skin) reduced["skin"] = *skin;
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
  const auto bytes_of_view = [this](std::uint32_t index) {
    const view_bytes v = view(index);
    return buffer(v.buffer).subspan(v.offset, v.length);
  };
  material_set materials = read_materials(root_, path_, bytes_of_view, views_.size(), out_.warnings);
  out_.materials = std::move(materials.materials);
  out_.coordinates = std::move(materials.coordinates);
  out_.images = std::move(materials.images);
  out_.nodes = read_nodes(root_, out_.warnings);

  json reduced = {{"asset", {{"version", "2.0"}}}};
  reduced["meshes"] = json::array();
  for (const json_object& mesh : meshes_) reduced["meshes"].push_back(reduced_mesh(mesh));
  reduced["nodes"] = json::array();
  for (const json_object& node : nodes_) reduced["nodes"].push_back(reduced_node(node));
  reduced["scenes"] = json::array();
  for (const json_object& scene : scenes_) {
    reduced["scenes"].push_back({{"nodes", scene.indices("nodes", "nodes", nodes_.size())}});
  }
  const auto default_scene = root_.index("scene", "scenes", scenes_.size());
  if (default_scene) reduced["scene"] = *default_scene;

  // Numbers must stay what they are, so what nothing uses is replaced by a stub.
  reduced["accessors"] = json::array();
  for (json& accessor : reduced_accessors_) {
    if (accessor.is_null()) accessor = {{"type", "SCALAR"}, {"componentType", 5126}, {"count", 0}};
    reduced["accessors"].push_back(std::move(accessor));
  }
  reduced["bufferViews"] = json::array();
  for (json& reduced_view : reduced_views_) {
    if (reduced_view.is_null()) reduced_view = {{"buffer", 0}, {"byteLength", 1}};
    reduced["bufferViews"].push_back(std::move(reduced_view));
  }
  reduced["buffers"] = json::array();
  for (std::size_t i = 0; i < out_.buffers.size(); ++i) {
    if (out_.buffers[i].empty()) out_.buffers[i].resize(1);
    reduced["buffers"].push_back({{"byteLength", out_.buffers[i].size()}, {"uri", buffer_uri(i)}});
  }
  out_.json = reduced.dump();
  return std::move(out_);
}

}  // namespace

std::string buffer_uri(std::size_t buffer) {
  return std::to_string(buffer);
}

std::size_t buffer_of_uri(const std::string& uri) {
  std::size_t number = SIZE_MAX;
  const auto [end, problem] = std::from_chars(uri.data(), uri.data() + uri.size(), number);
  return problem == std::errc() && end == uri.data() + uri.size() ? number : SIZE_MAX;
}

gltf_document read_gltf_document(const std::filesystem::path& path) {
  gltf_file file = read_gltf_file(path);
  const std::string name = printable(path.string(), 1000);
  json parsed;
  try {
    parsed = json::parse(file.json);
  } catch (const json::exception& e) {
    refuse(name, "scene.bad-json", "its JSON cannot be parsed: " + printable(e.what(), 160),
           "the file is damaged: copy or export it again");
  }
  file.json = std::string();
  return document_reader(path, parsed, std::move(file.binary), name, std::move(file.warnings)).read();
}

}  // namespace sightcell::scene
