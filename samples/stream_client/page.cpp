#include "page.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "sightcell/base/json_text.h"

namespace stream_client {
namespace {

using nlohmann::json;

constexpr const char* codec = "EXT_meshopt_compression";
constexpr std::uint64_t most_elements = std::uint64_t{1} << 24;  // of a view: a page has 64 K vertices or fewer
constexpr std::size_t most_uvs = 8;
constexpr std::uint64_t free_bytes = 64 << 20;  // that any page may decode to
constexpr std::uint64_t most_ratio = 64;        // of larger pages
enum : unsigned { gl_unsigned_byte = 5121, gl_unsigned_short = 5123, gl_unsigned_int = 5125, gl_float = 5126 };

void need(bool condition, const std::string& otherwise) {
  if (!condition) throw page_error(otherwise);
}

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  need(at + 4 <= bytes.size(), "it ends in a header");
  return std::uint32_t{bytes[at]} | std::uint32_t{bytes[at + 1]} << 8 | std::uint32_t{bytes[at + 2]} << 16 |
         std::uint32_t{bytes[at + 3]} << 24;
}

struct glb_parts {
  std::string_view text;
  std::span<const std::uint8_t> binary;
};

glb_parts split(std::span<const std::uint8_t> glb) {
  constexpr std::uint32_t magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
  need(word_at(glb, 0) == magic && word_at(glb, 4) == 2, "it is no .glb of version 2");
  need(word_at(glb, 8) == glb.size(), "its length is not that of its header");
  const std::size_t text_bytes = word_at(glb, 12);
  need(word_at(glb, 16) == json_chunk && text_bytes <= glb.size() - 20, "it has no JSON");
  const std::span<const std::uint8_t> text = glb.subspan(20, text_bytes);
  const std::size_t at = 20 + text_bytes;
  const std::size_t binary_bytes = word_at(glb, at);
  need(word_at(glb, at + 4) == binary_chunk && binary_bytes <= glb.size() - at - 8, "it has no binary chunk");
  return {{reinterpret_cast<const char*>(text.data()), text.size()}, glb.subspan(at + 8, binary_bytes)};
}

std::uint64_t number(const json& object, const char* key) {
  const json& value = object.at(key);
  need(value.is_number_unsigned(), std::string("a \"") + key + "\" is not a whole number");
  return value.get<std::uint64_t>();
}

std::uint64_t number_or(const json& object, const char* key, std::uint64_t otherwise) {
  return object.contains(key) ? number(object, key) : otherwise;
}

std::span<const std::uint8_t> part_of(std::span<const std::uint8_t> bytes, std::uint64_t at, std::uint64_t size) {
  need(at <= bytes.size() && size <= bytes.size() - at, "a buffer view is outside its buffer");
  return bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
}

struct decoded_view {
  std::vector<std::uint8_t> bytes;
  std::size_t stride = 0;  // 0: that of the accessor
};

decoded_view decode_stream(const json& stream, std::span<const std::uint8_t> binary) {
  const std::uint64_t count = number(stream, "count"), stride = number(stream, "byteStride");
  const std::string mode = stream.at("mode"), filter = stream.value("filter", "NONE");
  need(number(stream, "buffer") == 0, "compressed bytes are in another file");
  const auto bytes = part_of(binary, number_or(stream, "byteOffset", 0), number(stream, "byteLength"));
  const bool attributes = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES";
  need(attributes || triangles || mode == "INDICES", "a mode of compression is unknown");
  need(attributes ? stride >= 4 && stride <= 256 && stride % 4 == 0 : stride == 2 || stride == 4,
       "a stride does not fit its mode of compression");
  // The least bytes of an element: two bits for 16 equal bytes, a byte per triangle or index.
  const std::uint64_t least = attributes ? count * stride / 64 : triangles ? count / 3 : count;
  need(count <= most_elements && least <= bytes.size(), "a buffer view has more elements than bytes for them");
  need(!triangles || count % 3 == 0, "a buffer view has a part of a triangle");
  decoded_view out{std::vector<std::uint8_t>(static_cast<std::size_t>(count * stride)),
                   static_cast<std::size_t>(stride)};
  const auto n = static_cast<std::size_t>(count);
  const int failure =
      attributes  ? meshopt_decodeVertexBuffer(out.bytes.data(), n, out.stride, bytes.data(), bytes.size())
      : triangles ? meshopt_decodeIndexBuffer(out.bytes.data(), n, out.stride, bytes.data(), bytes.size())
                  : meshopt_decodeIndexSequence(out.bytes.data(), n, out.stride, bytes.data(), bytes.size());
  need(failure == 0, "compressed bytes are damaged");
  if (filter == "EXPONENTIAL" && attributes) {
    meshopt_decodeFilterExp(out.bytes.data(), n, out.stride);
  } else if (filter == "OCTAHEDRAL" && attributes) {
    need(stride == 4 || stride == 8, "a stride does not fit its filter");
    meshopt_decodeFilterOct(out.bytes.data(), n, out.stride);
  } else {
    need(filter == "NONE", "a filter is unknown");
  }
  return out;
}

class page_reader {
 public:
  page_reader(std::span<const std::uint8_t> glb, std::uint32_t geometry_count)
      : parts_(split(glb)),
        document_(sightcell::scene::parse_json(parts_.text)),
        geometry_count_(geometry_count),
        most_bytes_(std::max<std::uint64_t>(free_bytes, most_ratio * glb.size())) {}

  page read() {
    page out;
    const json& meshes = document_.at("meshes");
    need(meshes.is_array() && meshes.size() == 1, "it has not one mesh");
    for (const json& primitive : meshes[0].at("primitives")) out.parts.push_back(read_part(primitive));
    return out;
  }

 private:
  const decoded_view& view(std::uint64_t index) {
    const auto found = views_.find(index);
    if (found != views_.end()) return found->second;
    const json& views = document_.at("bufferViews");
    need(index < views.size(), "a buffer view does not exist");
    const json& v = views[static_cast<std::size_t>(index)];
    decoded_view out;
    if (v.contains("extensions") && v["extensions"].contains(codec)) {
      out = decode_stream(v["extensions"][codec], parts_.binary);
    } else {
      need(number(v, "buffer") == 0, "a buffer view is in another file");
      const auto bytes = part_of(parts_.binary, number_or(v, "byteOffset", 0), number(v, "byteLength"));
      out = {{bytes.begin(), bytes.end()}, static_cast<std::size_t>(number_or(v, "byteStride", 0))};
    }
    return views_.emplace(index, std::move(out)).first->second;
  }

  // Calls `take` with the bytes of each element of an accessor.
  template <class Take>
  std::size_t each(const json& accessor, std::size_t element, Take take) {
    const decoded_view& v = view(number(accessor, "bufferView"));
    const std::uint64_t at = number_or(accessor, "byteOffset", 0), count = number(accessor, "count");
    const std::size_t stride = v.stride == 0 ? element : v.stride;
    need(count <= most_elements && at <= v.bytes.size() &&
             (count == 0 || at + (count - 1) * stride + element <= v.bytes.size()),
         "an accessor is outside its buffer view");
    decoded_bytes_ += count * element;
    need(decoded_bytes_ <= most_bytes_, "it has more than " + std::to_string(most_bytes_) + " bytes");
    for (std::size_t i = 0; i < count; ++i) take(v.bytes.data() + at + i * stride);
    return static_cast<std::size_t>(count);
  }

  const json& accessor(const json& index) const {
    const json& accessors = document_.at("accessors");
    need(index.is_number_unsigned() && index.get<std::uint64_t>() < accessors.size(), "an accessor does not exist");
    return accessors[index.get<std::size_t>()];
  }

  void need_type(const json& a, const char* type, bool component, const char* attribute) const {
    need(a.at("type") == type && component, std::string(attribute) + " is of another type");
  }

  std::vector<float> floats(const json& index, const char* type, std::size_t width, const char* attribute) {
    const json& a = accessor(index);
    need_type(a, type, number(a, "componentType") == gl_float, attribute);
    std::vector<float> out;
    each(a, 4 * width, [&](const std::uint8_t* bytes) {
      out.resize(out.size() + width);
      std::memcpy(out.data() + out.size() - width, bytes, 4 * width);
    });
    for (const float f : out) need(std::isfinite(f), std::string(attribute) + " has a number that is not finite");
    return out;
  }

  std::vector<std::uint16_t> colors(const json& index) {
    const json& a = accessor(index);
    const std::uint64_t component = number(a, "componentType");
    const bool wide = component == gl_unsigned_short;
    need_type(a, "VEC4", wide || component == gl_unsigned_byte, "COLOR_0");
    std::vector<std::uint16_t> out;
    each(a, wide ? 8 : 4, [&](const std::uint8_t* bytes) {
      for (std::size_t k = 0; k < 4; ++k) {
        out.push_back(wide ? static_cast<std::uint16_t>(bytes[2 * k] | bytes[2 * k + 1] << 8)
                           : static_cast<std::uint16_t>(bytes[k] * 257));
      }
    });
    return out;
  }

  std::vector<std::uint32_t> indices(const json& index, std::size_t vertices) {
    const json& a = accessor(index);
    const std::uint64_t component = number(a, "componentType");
    need_type(a, "SCALAR", component == gl_unsigned_short || component == gl_unsigned_int, "the index list");
    std::vector<std::uint32_t> out;
    const std::size_t size = component == gl_unsigned_int ? 4 : 2;
    each(a, size, [&](const std::uint8_t* bytes) {
      std::uint32_t value = 0;
      for (std::size_t k = 0; k < size; ++k) value |= std::uint32_t{bytes[k]} << (8 * k);
      need(value < vertices, "an index is not below the number of vertices");
      out.push_back(value);
    });
    return out;
  }

  page_part read_part(const json& primitive) {
    page_part out;
    const json& attributes = primitive.at("attributes");
    need(number_or(primitive, "mode", 4) == 4, "a primitive has no triangles");
    out.positions = floats(attributes.at("POSITION"), "VEC3", 3, "POSITION");
    const std::size_t vertices = out.positions.size() / 3;
    for (std::size_t set = 0; set < most_uvs; ++set) {
      const std::string name = "TEXCOORD_" + std::to_string(set);
      if (!attributes.contains(name)) continue;
      out.uvs.resize(set + 1);
      out.uvs[set] = floats(attributes[name], "VEC2", 2, name.c_str());
      need(out.uvs[set].size() == 2 * vertices, name + " has another number of vertices");
    }
    if (attributes.contains("COLOR_0")) out.colors = colors(attributes["COLOR_0"]);
    need(out.colors.empty() || out.colors.size() == 4 * vertices, "COLOR_0 has another number of vertices");
    out.indices = indices(primitive.at("indices"), vertices);
    read_pieces(primitive.at("extras").at("sightcell"), out);
    return out;
  }

  // Two numbers per geometry: the gap to the previous geometry, and its polygons.
  void read_pieces(const json& numbers, page_part& out) const {
    need(numbers.is_array() && numbers.size() % 2 == 0, "extras.sightcell is no list of pairs");
    std::uint64_t geometry = 0, first = 0;
    for (std::size_t i = 0; i < numbers.size(); i += 2) {
      need(numbers[i].is_number_unsigned() && numbers[i + 1].is_number_unsigned(),
           "extras.sightcell has a number that is not whole");
      const auto gap = numbers[i].get<std::uint64_t>(), polygons = numbers[i + 1].get<std::uint64_t>();
      need(gap < geometry_count_ && geometry + gap < geometry_count_, "a geometry does not exist");
      need(polygons <= (out.indices.size() - first) / 3, "extras.sightcell has more polygons than the primitive");
      out.pieces.push_back({static_cast<std::uint32_t>(geometry + gap), static_cast<std::uint32_t>(first),
                            static_cast<std::uint32_t>(3 * polygons)});
      geometry += gap + 1;
      first += 3 * polygons;
    }
    need(first == out.indices.size(), "extras.sightcell has fewer polygons than the primitive");
  }

  glb_parts parts_;
  json document_;
  std::uint32_t geometry_count_;
  std::uint64_t most_bytes_, decoded_bytes_ = 0;
  std::map<std::uint64_t, decoded_view> views_;
};

}  // namespace

std::uint64_t page::bytes() const {
  std::uint64_t sum = 0;
  for (const page_part& p : parts) {
    sum += 4 * p.positions.size() + 2 * p.colors.size() + 4 * p.indices.size() + sizeof(page_piece) * p.pieces.size();
    for (const auto& uv : p.uvs) sum += 4 * uv.size();
  }
  return sum;
}

page read_page(std::span<const std::uint8_t> glb, std::uint32_t geometry_count) {
  try {
    return page_reader(glb, geometry_count).read();
  } catch (const json::exception& e) {
    throw page_error(std::string("its JSON is not that of a page: ") + e.what());
  }
}

}  // namespace stream_client
