#include "page_glb.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <utility>

#include "glb_bytes.h"
#include "gltf_numbers.h"
#include "meshopt_encode.h"

namespace sightcell::scene {
namespace {

using nlohmann::ordered_json;

// The vertices and indices of geometries that share a layout.
struct joined_parts {
  const vertex_layout* layout;
  std::vector<std::vector<std::uint8_t>> streams;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint32_t> counts;  // geometry and number of its indices, in turn
  std::uint32_t vertices = 0;
  glm::vec3 min{std::numeric_limits<float>::infinity()}, max{-std::numeric_limits<float>::infinity()};

  explicit joined_parts(const vertex_layout& shared) : layout(&shared), streams(shared.size()) {}

  // g: of this layout, or of the same one without texture coordinates.
  void add(const rounded_geometry& g, const page_part& part) {
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t polygon : part.polygons)
      if (g.is_drawn(polygon))
        corners.insert(corners.end(), &g.corners[3 * std::size_t{polygon}], &g.corners[3 * std::size_t{polygon}] + 3);
    if (corners.empty()) return;
    std::vector<std::uint32_t> used = corners;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (std::uint32_t& c : corners)
      c = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), c) - used.begin());
    put_neighbors_together(corners, used.size());
    append(g, used, corners);
    counts.push_back(part.geometry);
    counts.push_back(static_cast<std::uint32_t>(corners.size()));
  }

 private:
  // Numbers vertices in the order of their first use, so that codes of indices and of differences are short.
  // used: vertices of g. corners: in `used`.
  void append(const rounded_geometry& g, const std::vector<std::uint32_t>& used,
              const std::vector<std::uint32_t>& corners) {
    constexpr std::uint32_t none = 0xFFFFFFFFu;
    std::vector<std::uint32_t> number(used.size(), none);
    for (const std::uint32_t c : corners) {
      if (number[c] == none) {
        number[c] = vertices++;
        for (std::size_t s = 0; s < streams.size(); ++s) {
          const std::size_t stride = g.layout[s].stride;
          const auto* const from = &g.streams[s][used[c] * stride];
          streams[s].insert(streams[s].end(), from, from + stride);
          streams[s].resize(streams[s].size() + (*layout)[s].stride - stride);
        }
        const glm::vec3 p = position_of(g, used[c]);
        for (int k = 0; k < 3; ++k) min[k] = std::min(min[k], p[k]), max[k] = std::max(max[k], p[k]);
      }
      indices.push_back(number[c]);
    }
  }
};

// Returns the shortest number that is read as this float.
ordered_json shortest(float value) {
  if (value == std::trunc(value) && std::abs(value) < 1e6f) return static_cast<std::int64_t>(value);
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double read = 0.0;
  std::from_chars(text.data(), end, read);
  return static_cast<float>(read) == value ? read : static_cast<double>(value);
}

ordered_json shortest(const glm::vec3& v) {
  return {shortest(v.x), shortest(v.y), shortest(v.z)};
}

class page_writer {
 public:
  void add(const joined_parts& part) {
    ordered_json attributes;
    const vertex_layout& layout = *part.layout;
    for (std::size_t s = 0; s < layout.size();) {
      // A view takes more JSON than the bytes of many vectors: streams of vectors are one after the other in one.
      std::size_t end = s + 1;
      if (layout[s].filter == stream_filter::octahedral)
        while (end < layout.size() && layout[end].filter == layout[s].filter && layout[end].stride == layout[s].stride)
          ++end;
      add_streams(part, s, end, attributes);
      s = end;
    }
    const std::uint32_t width = part.vertices > 0xFFFF ? 4 : 2;
    const std::size_t view = add_view(encode_triangles(part.indices, part.vertices), part.indices.size(), width,
                                      "TRIANGLES", stream_filter::none);
    primitives_.push_back({{"attributes", std::move(attributes)},
                           {"indices", accessors_.size()},
                           {"extras", {{"sightcell", numbers_of(part)}}}});
    accessors_.push_back({{"bufferView", view},
                          {"componentType", width == 2 ? unsigned_short_type : unsigned_int_type},
                          {"count", part.indices.size()},
                          {"type", "SCALAR"}});
  }

  std::vector<std::byte> write() const {
    ordered_json out{{"asset", {{"version", "2.0"}}}};
    if (!primitives_.empty()) {
      ordered_json extensions = ordered_json::array({"EXT_meshopt_compression"});
      if (quantized_) extensions.push_back("KHR_mesh_quantization");
      out["extensionsUsed"] = out["extensionsRequired"] = std::move(extensions);
      out["buffers"] = {
          {{"byteLength", bytes_.size()}},
          {{"byteLength", decoded_}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
      out["bufferViews"] = views_;
      out["accessors"] = accessors_;
      out["meshes"] = {{{"primitives", primitives_}}};
      out["nodes"] = {{{"mesh", 0}}};
      out["scenes"] = {{{"nodes", {0}}}};
      out["scene"] = 0;
    }
    std::vector<std::byte> file = glb_with_room(out.dump(), bytes_.size());
    if (!bytes_.empty()) std::memcpy(&file[file.size() - bytes_.size()], bytes_.data(), bytes_.size());
    return file;
  }

 private:
  // Geometry, less the one before and 1; number of its polygons; and so on.
  static std::vector<std::uint32_t> numbers_of(const joined_parts& part) {
    std::vector<std::uint32_t> out = part.counts;
    for (std::size_t i = 0; i < out.size(); i += 2) {
      if (i > 0) out[i] -= part.counts[i - 2] + 1;
      out[i + 1] /= 3;
    }
    return out;
  }

  // Adds streams of the layout, from `begin` to before `end`, to one view, and their attributes.
  void add_streams(const joined_parts& part, std::size_t begin, std::size_t end, ordered_json& attributes) {
    const std::uint32_t stride = (*part.layout)[begin].stride;
    std::vector<std::uint8_t> joined;
    if (end > begin + 1)
      for (std::size_t s = begin; s < end; ++s)
        joined.insert(joined.end(), part.streams[s].begin(), part.streams[s].end());
    const std::vector<std::uint8_t>& bytes = end > begin + 1 ? joined : part.streams[begin];
    const std::size_t view = add_view(encode_vertices({bytes, stride}), bytes.size() / stride, stride, "ATTRIBUTES",
                                      (*part.layout)[begin].filter);
    std::size_t accessors = 0;
    bool is_tight = true;
    for (std::size_t s = begin; s < end; ++s) {
      for (const stream_attribute& a : (*part.layout)[s].attributes) {
        attributes[a.name] = accessors_.size();
        const std::size_t offset = (s - begin) * part.streams[s].size() + a.offset;
        accessors_.push_back(accessor_of(part, a, view, offset));
        is_tight = is_tight && a.width * size_of_type(a.component_type) == stride;
        quantized_ = quantized_ || a.component_type == byte_type;
        ++accessors;
      }
    }
    // glTF wants it of a view with several accessors.
    if (accessors > 1 || !is_tight) views_[view]["byteStride"] = stride;
  }

  static ordered_json accessor_of(const joined_parts& part, const stream_attribute& a, std::size_t view,
                                  std::size_t offset) {
    ordered_json out{{"bufferView", view}};
    if (offset > 0) out["byteOffset"] = offset;
    out["componentType"] = a.component_type;
    if (a.normalized) out["normalized"] = true;
    out["count"] = part.vertices;
    out["type"] = vector_type(a.width);
    if (a.name == "POSITION") out["min"] = shortest(part.min), out["max"] = shortest(part.max);
    return out;
  }

  std::size_t add_view(const std::vector<std::uint8_t>& code, std::size_t count, std::uint32_t stride, const char* mode,
                       stream_filter filter) {
    const std::size_t length = count * stride;
    ordered_json compressed{
        {"buffer", 0}, {"byteLength", code.size()}, {"byteStride", stride}, {"count", count}, {"mode", mode}};
    if (!bytes_.empty()) compressed["byteOffset"] = bytes_.size();
    if (filter != stream_filter::none)
      compressed["filter"] = filter == stream_filter::octahedral ? "OCTAHEDRAL" : "EXPONENTIAL";
    ordered_json view{{"buffer", 1}, {"byteLength", length}};
    if (decoded_ > 0) view["byteOffset"] = decoded_;
    view["extensions"] = {{"EXT_meshopt_compression", std::move(compressed)}};
    views_.push_back(std::move(view));
    decoded_ += (length + 3) / 4 * 4;
    bytes_.insert(bytes_.end(), code.begin(), code.end());
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    return views_.size() - 1;
  }

  ordered_json views_ = ordered_json::array(), accessors_ = ordered_json::array(), primitives_ = ordered_json::array();
  std::vector<std::uint8_t> bytes_;
  std::size_t decoded_ = 0;
  bool quantized_ = false;  // has components that the core of glTF does not allow
};

bool has_coordinates(const vertex_layout& layout) {
  return layout.front().attributes.size() > 1;
}

// Returns the layout of the first part that differs from `own` only by texture coordinates, which `own` has none of;
// else `own`. Zeros take next to no bytes, and another primitive 600 bytes of JSON.
const vertex_layout& shared_layout(std::span<const rounded_geometry> geometries, std::span<const page_part> parts,
                                   const vertex_layout& own) {
  if (has_coordinates(own)) return own;
  for (const page_part& part : parts) {
    const vertex_layout& other = geometries[part.geometry].layout;
    if (has_coordinates(other) && std::equal(own.begin() + 1, own.end(), other.begin() + 1, other.end())) return other;
  }
  return own;
}

}  // namespace

std::vector<std::byte> page_glb(std::span<const rounded_geometry> geometries, std::span<const page_part> parts) {
  std::vector<joined_parts> joined;
  for (const page_part& part : parts) {
    const rounded_geometry& g = geometries[part.geometry];
    const vertex_layout& layout = shared_layout(geometries, parts, g.layout);
    auto found = std::find_if(joined.begin(), joined.end(), [&](const auto& j) { return *j.layout == layout; });
    if (found == joined.end()) found = joined.emplace(joined.end(), layout);
    found->add(g, part);
  }
  page_writer writer;
  for (const joined_parts& part : joined)
    if (!part.indices.empty()) writer.add(part);
  return writer.write();
}

std::uint32_t stream_bytes(const rounded_geometry& g, const page_part& part) {
  joined_parts joined(g.layout);
  joined.add(g, part);
  if (joined.indices.empty()) return 0;
  // Streams end with the vertex that differences begin with, up to 32 bytes, which a page has once.
  std::size_t bytes = 0;
  for (std::size_t s = 0; s < joined.streams.size(); ++s) {
    const std::size_t size = encode_vertices({joined.streams[s], (*joined.layout)[s].stride}).size();
    const std::size_t ending = 1 + std::max<std::size_t>(32, (*joined.layout)[s].stride);
    bytes += size - std::min(size, ending);
  }
  const std::size_t size = encode_triangles(joined.indices, joined.vertices).size();
  return static_cast<std::uint32_t>(bytes + size - std::min<std::size_t>(size, 17));
}

}  // namespace sightcell::scene
