#include "glb_writer.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "sightcell/base/error.h"
#include "textures.h"

namespace sightcell::city {
namespace {

using nlohmann::json;

struct look {
  const char* name;
  std::array<double, 4> color;  // linear
  const char* alpha = "OPAQUE";
  bool double_sided = false;
};

// In the order of `surface`.
constexpr std::array<look, static_cast<std::size_t>(surface::count)> looks = {{
    {"plaster cream", {0.78, 0.68, 0.48, 1}},
    {"plaster ochre", {0.70, 0.45, 0.18, 1}},
    {"plaster rose", {0.66, 0.32, 0.26, 1}},
    {"plaster grey", {0.48, 0.47, 0.44, 1}},
    {"plaster green", {0.38, 0.46, 0.32, 1}},
    {"plaster white", {0.82, 0.81, 0.77, 1}},
    {"roof tile", {0.42, 0.11, 0.06, 1}},
    {"roof slate", {0.11, 0.13, 0.16, 1}},
    {"stone", {0.55, 0.52, 0.46, 1}},
    {"window", {0.05, 0.07, 0.10, 1}},
    {"glass", {0.55, 0.70, 0.80, 0.25}, "BLEND"},
    {"wood", {0.22, 0.11, 0.05, 1}},
    {"road", {0.16, 0.16, 0.17, 1}},
    {"pavement", {0.40, 0.38, 0.35, 1}},
    {"lawn", {0.14, 0.30, 0.07, 1}},
    {"bark", {0.13, 0.08, 0.05, 1}},
    {"leaves light", {0.20, 0.38, 0.08, 1}},
    {"leaves dark", {0.08, 0.23, 0.07, 1}},
    {"metal", {0.06, 0.07, 0.07, 1}},
    {"paint", {0.75, 0.72, 0.62, 1}},
    {"fence", {0.10, 0.12, 0.10, 1}, "MASK", true},
    {"brick", {0.35, 0.17, 0.11, 1}},
    {"foliage", {0.16, 0.33, 0.07, 1}, "MASK", true},
    {"litter", {0.80, 0.78, 0.70, 1}, "OPAQUE", true},
    {"cloth", {0.25, 0.35, 0.62, 1}, "OPAQUE", true},
    {"flower", {0.70, 0.10, 0.22, 1}},
    {"fruit", {0.85, 0.48, 0.06, 1}},
    {"sign red", {0.62, 0.05, 0.04, 1}},
    {"sign blue", {0.05, 0.14, 0.45, 1}},
    {"concrete", {0.42, 0.41, 0.39, 1}},
    {"panel light", {0.66, 0.64, 0.58, 1}},
    {"panel grey", {0.38, 0.39, 0.39, 1}},
    {"panel rose", {0.58, 0.40, 0.34, 1}},
    {"panel dark", {0.09, 0.10, 0.12, 1}},
    {"rust", {0.30, 0.14, 0.07, 1}},
}};

json materials(const model& city, bool textured) {
  json out = json::array();
  for (std::size_t i = 0; i < city.surface_count; ++i) {
    const look& l = looks[i];
    json m = {
        {"name", l.name},
        {"pbrMetallicRoughness", {{"baseColorFactor", l.color}, {"metallicFactor", 0}, {"roughnessFactor", 0.9}}}};
    if (textured) m["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", i}};
    if (std::strcmp(l.alpha, "OPAQUE") != 0) m["alphaMode"] = l.alpha;
    if (l.double_sided) m["doubleSided"] = true;
    out.push_back(std::move(m));
  }
  return out;
}

class packer {
 public:
  explicit packer(bool textured) : textured_(textured) {}

  json pack(const model& m) {
    json meshes = json::array();
    for (const mesh& part : m.meshes) {
      json primitives = json::array();
      for (const primitive& p : part.primitives()) {
        json attributes = {{"POSITION", add_positions(p)}};
        if (textured_) attributes["TEXCOORD_0"] = add_texture_coordinates(p);
        primitives.push_back({{"attributes", std::move(attributes)},
                              {"indices", add_indices(p)},
                              {"material", static_cast<unsigned>(p.material)}});
      }
      meshes.push_back({{"name", part.name()}, {"primitives", std::move(primitives)}});
    }
    return meshes;
  }

  // One buffer: all positions, then all indices; then texture coordinates and textures, where there are any.
  json views() const {
    std::size_t offset = 0;
    json out = json::array();
    const auto add = [&](std::size_t bytes, int target) {
      out.push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
      if (target != 0) out.back()["target"] = target;
      offset += bytes;
    };
    add(positions_.size(), 34962);
    add(indices_.size(), 34963);
    if (!textured_) return out;
    add(coordinates_.size(), 34962);
    for (const texture& t : textures_) add(t.png.size(), 0);
    return out;
  }

  json images() const {
    json out = json::array();
    for (std::size_t i = 0; i < textures_.size(); ++i) {
      out.push_back({{"name", looks[i].name}, {"bufferView", 3 + i}, {"mimeType", "image/png"}});
    }
    return out;
  }

  json textures() const {
    json out = json::array();
    for (std::size_t i = 0; i < textures_.size(); ++i) out.push_back({{"source", i}, {"sampler", 0}});
    return out;
  }

  // What follows the indices.
  std::vector<char> rest() const {
    std::vector<char> out = coordinates_;
    for (const texture& t : textures_) out.insert(out.end(), t.png.begin(), t.png.end());
    while (out.size() % 4 != 0) out.push_back(0);
    return out;
  }

  json accessors() { return std::move(accessors_); }
  const std::vector<char>& positions() const { return positions_; }
  const std::vector<char>& indices() const { return indices_; }

 private:
  template <typename T>
  static void append(std::vector<char>& bytes, const T& value) {
    const auto at = bytes.size();
    bytes.resize(at + sizeof(T));
    std::memcpy(bytes.data() + at, &value, sizeof(T));
  }

  std::size_t add_positions(const primitive& p) {
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    const std::size_t offset = positions_.size();
    for (const auto& position : p.positions) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], position[axis]);
        high[axis] = std::max(high[axis], position[axis]);
      }
      append(positions_, position);
    }
    accessors_.push_back({{"bufferView", 0},
                          {"byteOffset", offset},
                          {"componentType", 5126},
                          {"count", p.positions.size()},
                          {"type", "VEC3"},
                          {"min", low},
                          {"max", high}});
    return accessors_.size() - 1;
  }

  std::size_t add_indices(const primitive& p) {
    const bool is_small = p.positions.size() < 65535;
    const std::size_t offset = indices_.size();
    for (const std::uint32_t index : p.indices) {
      if (is_small) {
        append(indices_, static_cast<std::uint16_t>(index));
      } else {
        append(indices_, index);
      }
    }
    while (indices_.size() % 4 != 0) indices_.push_back(0);
    accessors_.push_back({{"bufferView", 1},
                          {"byteOffset", offset},
                          {"componentType", is_small ? 5123 : 5125},
                          {"count", p.indices.size()},
                          {"type", "SCALAR"}});
    return accessors_.size() - 1;
  }

  std::size_t add_texture_coordinates(const primitive& p) {
    const std::size_t offset = coordinates_.size();
    for (const auto& uv : texture_coordinates(p)) append(coordinates_, uv);
    accessors_.push_back({{"bufferView", 2},
                          {"byteOffset", offset},
                          {"componentType", 5126},
                          {"count", p.positions.size()},
                          {"type", "VEC2"}});
    return accessors_.size() - 1;
  }

  bool textured_;
  std::vector<texture> textures_ = textured_ ? make_textures() : std::vector<texture>();
  json accessors_ = json::array();
  std::vector<char> positions_, indices_, coordinates_;
};

json nodes(const model& m) {
  json out = json::array();
  for (const node& n : m.nodes) {
    json entry = {{"name", n.name}};
    if (n.mesh < m.meshes.size()) entry["mesh"] = n.mesh;
    if (!n.children.empty()) entry["children"] = n.children;
    if (n.translation != glm::dvec3(0.0)) {
      entry["translation"] = {n.translation.x, n.translation.y, n.translation.z};
    }
    if (n.turn.x != 0.0 || n.tilt != glm::dvec2(0.0)) entry["rotation"] = {n.tilt.x, n.turn.x, n.tilt.y, n.turn.y};
    if (n.scale != 1.0) entry["scale"] = {n.scale, n.scale, n.scale};
    out.push_back(std::move(entry));
  }
  return out;
}

void put_u32(std::ofstream& stream, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) stream.put(static_cast<char>(value >> shift & 0xFFu));
}

[[noreturn]] void fail_to_write(const std::filesystem::path& path) {
  throw error(error_kind::failed, "city.write", path.string(), "cannot be written",
              "check that the folder exists and has room");
}

}  // namespace

void write_glb(const model& m, const std::filesystem::path& path, bool textured) {
  packer pack(textured);
  json document = {{"asset", {{"version", "2.0"}, {"generator", "sightcell-city"}}},
                   {"scene", 0},
                   {"scenes", json::array({{{"name", "city"}, {"nodes", m.roots}}})},
                   {"nodes", nodes(m)},
                   {"materials", materials(m, textured)}};
  document["meshes"] = pack.pack(m);
  document["accessors"] = pack.accessors();
  document["bufferViews"] = pack.views();
  if (textured) {
    document["images"] = pack.images();
    document["textures"] = pack.textures();
    document["samplers"] = json::array({{{"wrapS", 10497}, {"wrapT", 10497}}});
  }
  const std::vector<char> rest = pack.rest();
  const std::uint64_t binary = pack.positions().size() + pack.indices().size() + rest.size();
  document["buffers"] = json::array({{{"byteLength", binary}}});
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t total = 12 + 8 + text.size() + 8 + binary;
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    throw error(error_kind::failed, "city.too-large", path.string(), "a .glb cannot hold more than 4 GiB",
                "ask for fewer polygons");
  }
  std::ofstream stream(path, std::ios::binary);
  put_u32(stream, 0x46546C67u);  // "glTF"
  put_u32(stream, 2);
  put_u32(stream, static_cast<std::uint32_t>(total));
  put_u32(stream, static_cast<std::uint32_t>(text.size()));
  put_u32(stream, 0x4E4F534Au);  // "JSON"
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  put_u32(stream, static_cast<std::uint32_t>(binary));
  put_u32(stream, 0x004E4942u);  // "BIN"
  stream.write(pack.positions().data(), static_cast<std::streamsize>(pack.positions().size()));
  stream.write(pack.indices().data(), static_cast<std::streamsize>(pack.indices().size()));
  stream.write(rest.data(), static_cast<std::streamsize>(rest.size()));
  stream.close();
  if (!stream) fail_to_write(path);
}

void write_cells(const model& m, const std::filesystem::path& path) {
  json cells = json::array();
  for (const named_cell& cell : m.cells) {
    cells.push_back({{"name", cell.name},
                     {"min", {cell.min.x, cell.min.y, cell.min.z}},
                     {"max", {cell.max.x, cell.max.y, cell.max.z}}});
  }
  std::ofstream stream(path, std::ios::binary);
  stream << json{{"cells", std::move(cells)}}.dump(1) << '\n';
  stream.close();
  if (!stream) fail_to_write(path);
}

}  // namespace sightcell::city
