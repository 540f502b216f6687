#include "page_glb.h"

#include <algorithm>
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

// The vertices and indices of geometries with one layout.
struct joined_parts {
  const vertex_layout* layout = nullptr;
  std::vector<std::vector<std::uint8_t>> streams;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint32_t> counts;  // geometry and number of its indices, in turn
  std::uint32_t vertices = 0;
  glm::vec3 min{std::numeric_limits<float>::infinity()}, max{-std::numeric_limits<float>::infinity()};

  void add(const rounded_geometry& g, const page_part& part) {
    if (!layout) {
      layout = &g.layout;
      streams.resize(g.layout.size());
    }
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
        }
        const glm::vec3 p = position_of(g, used[c]);
        for (int k = 0; k < 3; ++k) min[k] = std::min(min[k], p[k]), max[k] = std::max(max[k], p[k]);
      }
      indices.push_back(number[c]);
    }
  }
};

class page_writer {
 public:
  void add(const joined_parts& part) {
    ordered_json attributes;
    for (std::size_t s = 0; s < part.streams.size(); ++s) {
      const vertex_stream& stream = (*part.layout)[s];
      const std::size_t view = add_view(encode_vertices({part.streams[s], stream.stride}), part.vertices, stream.stride,
                                        "ATTRIBUTES", stream.filter);
      views_[view]["byteStride"] = stream.stride;
      views_[view]["target"] = array_buffer;
      for (const stream_attribute& a : stream.attributes) {
        attributes[a.name] = accessors_.size();
        ordered_json accessor{{"bufferView", view}};
        if (a.offset > 0) accessor["byteOffset"] = a.offset;
        accessor["componentType"] = a.component_type;
        if (a.normalized) accessor["normalized"] = true;
        accessor["count"] = part.vertices;
        accessor["type"] = vector_type(a.width);
        if (a.name == "POSITION") {
          accessor["min"] = {part.min.x, part.min.y, part.min.z};
          accessor["max"] = {part.max.x, part.max.y, part.max.z};
        }
        accessors_.push_back(std::move(accessor));
      }
    }
    const std::uint32_t width = part.vertices > 0xFFFF ? 4 : 2;
    const std::size_t view = add_view(encode_triangles(part.indices, part.vertices), part.indices.size(), width,
                                      "TRIANGLES", stream_filter::none);
    views_[view]["target"] = element_array_buffer;
    primitives_.push_back({{"attributes", std::move(attributes)},
                           {"indices", accessors_.size()},
                           {"extras", {{"sightcell", part.counts}}}});
    accessors_.push_back({{"bufferView", view},
                          {"componentType", width == 2 ? unsigned_short_type : unsigned_int_type},
                          {"count", part.indices.size()},
                          {"type", "SCALAR"}});
  }

  std::vector<std::byte> write() const {
    ordered_json out{{"asset", {{"version", "2.0"}}}};
    if (!primitives_.empty()) {
      out["extensionsUsed"] = out["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
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
  std::size_t add_view(const std::vector<std::uint8_t>& code, std::size_t count, std::uint32_t stride, const char* mode,
                       stream_filter filter) {
    const std::size_t length = count * stride;
    ordered_json compressed{{"buffer", 0},
                            {"byteOffset", bytes_.size()},
                            {"byteLength", code.size()},
                            {"byteStride", stride},
                            {"count", count},
                            {"mode", mode}};
    if (filter != stream_filter::none)
      compressed["filter"] = filter == stream_filter::octahedral ? "OCTAHEDRAL" : "EXPONENTIAL";
    views_.push_back({{"buffer", 1},
                      {"byteOffset", decoded_},
                      {"byteLength", length},
                      {"extensions", {{"EXT_meshopt_compression", std::move(compressed)}}}});
    decoded_ += (length + 3) / 4 * 4;
    bytes_.insert(bytes_.end(), code.begin(), code.end());
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    return views_.size() - 1;
  }

  ordered_json views_ = ordered_json::array(), accessors_ = ordered_json::array(), primitives_ = ordered_json::array();
  std::vector<std::uint8_t> bytes_;
  std::size_t decoded_ = 0;
};

}  // namespace

std::vector<std::byte> page_glb(std::span<const rounded_geometry> geometries, std::span<const page_part> parts) {
  std::vector<joined_parts> joined;
  for (const page_part& part : parts) {
    const rounded_geometry& g = geometries[part.geometry];
    auto found = std::find_if(joined.begin(), joined.end(), [&](const auto& j) { return *j.layout == g.layout; });
    if (found == joined.end()) {
      joined.emplace_back().add(g, part);
    } else {
      found->add(g, part);
    }
  }
  page_writer writer;
  for (const joined_parts& part : joined)
    if (!part.indices.empty()) writer.add(part);
  return writer.write();
}

std::uint32_t stream_bytes(const rounded_geometry& g, const page_part& part) {
  joined_parts joined;
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
