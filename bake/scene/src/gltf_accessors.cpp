#include "gltf_accessors.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "accessor.h"
#include "gltf_file.h"
#include "meshopt_decode.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

constexpr std::uint64_t byte_limit = std::uint64_t{1} << 40;  // keeps sums of offsets and lengths far from overflow
// An accessor without a buffer view takes memory and no bytes in the file. Others are limited by the bytes of the
// file.
constexpr std::uint64_t zero_filled_limit = std::uint64_t{1} << 24;  // of all together

std::uint64_t width_of(const std::string& type) {
  static const std::array<std::pair<std::string_view, std::uint64_t>, 5> widths = {
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}}};
  for (const auto& [name, width] : widths) {
    if (name == type) return width;
  }
  return 0;
}

}  // namespace

accessor_table::accessor_table(const json_object& root, const gltf_source& source,
                               std::optional<std::vector<std::uint8_t>> binary)
    : source_(source),
      binary_(std::move(binary)),
      accessors_(root.objects("accessors")),
      views_(root.objects("bufferViews")),
      buffers_(root.objects("buffers")) {
  reduced_accessors_.resize(accessors_.size());
  reduced_views_.resize(views_.size());
  bytes_.resize(buffers_.size());
}

std::span<const std::uint8_t> accessor_table::bytes_of_view(std::uint32_t index) {
  const view_bytes v = view(index);
  return buffer(v.buffer).subspan(v.offset, v.length);
}

// Loads a buffer at its first use, so that a scene whose animation file is missing can be loaded.
std::span<const std::uint8_t> accessor_table::buffer(std::uint32_t index) {
  std::vector<std::uint8_t>& bytes = bytes_[index];
  if (!bytes.empty()) return bytes;
  const json_object& source = buffers_[index];
  const std::uint64_t length = source.required_number("byteLength", byte_limit);
  if (length == 0) source.fail("scene.buffer-size", "has a byteLength of 0", "export the file again");
  const auto uri = source.text("uri");
  if (uri) {
    bytes = read_resource(source_, *uri, source.where(), length);
  } else if (index == 0 && binary_) {
    if (length > binary_->size()) {
      source.fail("scene.buffer-size",
                  "needs " + std::to_string(length) + " bytes but the .glb has " + std::to_string(binary_->size()),
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

void accessor_table::count_compressed(const json_object& user, std::uint64_t bytes) {
  constexpr std::uint64_t free_bytes = std::uint64_t{1} << 20;
  compressed_bytes_ += bytes;
  std::uint64_t all = 0;
  for (std::size_t i = 0; i < buffers_.size(); ++i) all += bytes_[i].size();
  if (compressed_bytes_ > free_bytes + 4 * all)
    user.fail("scene.too-large", "decodes the same bytes as many others", "export the file again");
}

// Returns the buffer with the decoded bytes of a compressed view.
std::uint32_t accessor_table::decoded_buffer(std::uint32_t view_index, const json_object& meshopt) {
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
  count_compressed(meshopt, length);
  const meshopt_stream stream{meshopt.required_text("mode"), meshopt.text("filter").value_or("NONE"),
                              meshopt.required_number("count", UINT32_MAX), meshopt.required_number("byteStride", 256)};
  std::string why_not;
  auto bytes = decode_meshopt(stream, all.subspan(offset, length), why_not);
  if (!bytes) meshopt.fail("scene.meshopt", "cannot be decoded: " + why_not, "export the file again");
  const std::uint32_t made = add_buffer(std::move(*bytes));
  decoded_buffers_.emplace(view_index, made);
  return made;
}

std::uint32_t accessor_table::add_buffer(std::vector<std::uint8_t> bytes) {
  if (bytes.empty()) bytes.resize(1);  // empty means not loaded yet
  bytes_.push_back(std::move(bytes));
  return static_cast<std::uint32_t>(bytes_.size() - 1);
}

std::uint32_t accessor_table::add_bytes(std::vector<std::uint8_t> bytes, const char* type, int component,
                                        std::uint64_t count) {
  const std::size_t length = std::max<std::size_t>(bytes.size(), 1);
  reduced_accessors_.push_back({{"type", type},
                                {"componentType", component},
                                {"count", count},
                                {"normalized", false},
                                {"bufferView", reduced_views_.size()},
                                {"byteOffset", 0}});
  reduced_views_.push_back({{"buffer", add_buffer(std::move(bytes))}, {"byteOffset", 0}, {"byteLength", length}});
  return static_cast<std::uint32_t>(reduced_accessors_.size() - 1);
}

view_bytes accessor_table::view(std::uint32_t index) {
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

void accessor_table::use_bytes(const json_object& user, std::uint32_t view_index, std::uint64_t offset,
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

void accessor_table::use_accessor(std::uint32_t index) {
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
  } else {
    zero_filled_ += count;
    if (zero_filled_ > zero_filled_limit) {
      source.fail("scene.too-large", "asks for " + std::to_string(count) + " elements that are not in the file",
                  "export the file again");
    }
  }
  if (source.has("sparse")) use_sparse(source, count, element, reduced);
  reduced_accessors_[index] = std::move(reduced);
}

void accessor_table::use_sparse(const json_object& accessor, std::uint64_t count, std::uint64_t element_size,
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

void accessor_table::require(const json_object& user, std::uint32_t index, const char* what,
                             std::initializer_list<const char*> types, std::initializer_list<int> components) {
  const std::string type = accessors_[index].required_text("type");
  const int component = static_cast<int>(accessors_[index].required_number("componentType", INT32_MAX));
  const bool fits = std::find(types.begin(), types.end(), type) != types.end() &&
                    std::find(components.begin(), components.end(), component) != components.end();
  if (!fits) {
    user.fail("scene.accessor-type",
              std::string("takes its ") + what + " from accessors[" + std::to_string(index) + "] of type " +
                  printable(type) + " and component type " + std::to_string(component),
              "export the file again");
  }
  use_accessor(index);
}

// user: the part of a reduced accessor that refers to a used view.
std::span<const std::uint8_t> accessor_table::used_bytes(const json& user) const {
  const json& v = reduced_views_[user.at("bufferView").get<std::size_t>()];
  const std::span<const std::uint8_t> all(bytes_[v.at("buffer").get<std::size_t>()]);
  return all.subspan(v.at("byteOffset").get<std::size_t>(), v.at("byteLength").get<std::size_t>())
      .subspan(user.at("byteOffset").get<std::size_t>());
}

accessor_view accessor_table::elements(std::uint32_t index) const {
  const json& reduced = reduced_accessors_[index];
  accessor_view out;
  out.count = reduced.at("count").get<std::size_t>();
  out.width = width_of(reduced.at("type").get<std::string>());
  out.component_type = reduced.at("componentType").get<int>();
  out.normalized = reduced.at("normalized").get<bool>();
  out.stride = out.width * component_size(out.component_type);
  if (reduced.contains("bufferView")) {
    const json& v = reduced_views_[reduced.at("bufferView").get<std::size_t>()];
    if (v.contains("byteStride")) out.stride = v.at("byteStride").get<std::size_t>();
    out.bytes = used_bytes(reduced);
  }
  const auto sparse = reduced.find("sparse");
  if (sparse != reduced.end() && sparse->at("count") > 0) {
    out.sparse_count = sparse->at("count").get<std::size_t>();
    out.sparse_index_type = sparse->at("indices").at("componentType").get<int>();
    out.sparse_indices = used_bytes(sparse->at("indices"));
    out.sparse_values = used_bytes(sparse->at("values"));
  }
  return out;
}

std::vector<accessor_view> accessor_table::all_elements() const {
  std::vector<accessor_view> out(reduced_accessors_.size());
  for (std::uint32_t i = 0; i < out.size(); ++i)
    if (!reduced_accessors_[i].is_null()) out[i] = elements(i);
  return out;
}

// Every accessor has a buffer view, because tinygltf rejects indices without one, which glTF allows.
void accessor_table::write_stubs(json& reduced) const {
  const json stub = {{"type", "SCALAR"}, {"componentType", 5126}, {"count", 0}, {"bufferView", 0}};
  reduced["accessors"] = json::array();
  for (std::size_t i = 0; i < reduced_accessors_.size(); ++i) reduced["accessors"].push_back(stub);
  reduced["bufferViews"] = json::array({{{"buffer", 0}, {"byteLength", 1}}});
  reduced["buffers"] = json::array({{{"byteLength", 1}, {"uri", "data:application/octet-stream;base64,AA=="}}});
}

}  // namespace sightcell::scene
