#include "input/host_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <utility>

#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t side_limit = 16384;  // texels

class importer {
 public:
  explicit importer(const host_scene& host) : host_(host) {}

  scene::scene run() {
    out_.name = host_.name;
    for (std::size_t i = 0; i < host_.meshes.size(); ++i) add_mesh(i);
    for (std::size_t i = 0; i < host_.materials.size(); ++i) add_material(i);
    for (std::size_t i = 0; i < host_.draws.size(); ++i) add_draw(i);
    scene::finish(out_);
    return std::move(out_);
  }

 private:
  [[noreturn]] void refuse(const std::string& thing, const std::string& cause, const std::string& remedy) const {
    throw error(error_kind::bad_input, "host.bad-array", std::string(host_.name), thing + " " + cause, remedy);
  }

  // Returns `count` vectors of `N` floats that are `stride` bytes apart.
  template <std::size_t N, typename Vector>
  std::vector<Vector> read_vectors(const float* from, std::size_t stride, std::size_t count, const std::string& thing,
                                   const char* what) const {
    constexpr std::size_t packed = N * sizeof(float);
    if (stride == 0) stride = packed;
    if (stride < packed || stride % sizeof(float) != 0)
      refuse(thing, fmt::format("has a {} stride of {} bytes", what, stride),
             fmt::format("give {} or more, a multiple of 4", packed));
    static_assert(sizeof(Vector) == packed);
    std::vector<Vector> out(count);
    const auto* bytes = reinterpret_cast<const std::byte*>(from);
    for (std::size_t i = 0; i < count; ++i) std::memcpy(&out[i], bytes + i * stride, packed);
    return out;
  }

  static std::vector<std::uint32_t> read_indices(const host_mesh& mesh) {
    if (mesh.indices == nullptr) {
      std::vector<std::uint32_t> out(mesh.vertex_count);
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<std::uint32_t>(i);
      return out;
    }
    std::vector<std::uint32_t> out(mesh.index_count);
    const auto* bytes = static_cast<const std::byte*>(mesh.indices);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (mesh.index_type == index_format::u16) {
        std::uint16_t index = 0;
        std::memcpy(&index, bytes + i * sizeof index, sizeof index);
        out[i] = index;
      } else {
        std::memcpy(&out[i], bytes + i * sizeof(std::uint32_t), sizeof(std::uint32_t));
      }
    }
    return out;
  }

  // Does not check indices: scene::finish does.
  void add_mesh(std::size_t number) {
    const host_mesh& mesh = host_.meshes[number];
    const std::string thing = fmt::format("mesh {}", number);
    if (mesh.vertex_count > 0 && mesh.positions == nullptr)
      refuse(thing, fmt::format("has {} vertices and no positions", mesh.vertex_count), "give its positions");
    constexpr std::size_t limit = std::numeric_limits<std::uint32_t>::max();
    if (mesh.vertex_count >= limit || (mesh.indices != nullptr && mesh.index_count >= limit))
      refuse(thing, "has 2^32 - 1 vertices or indices or more", "split it");
    scene::geometry& g = out_.geometries.emplace_back();
    g.positions =
        read_vectors<3, glm::vec3>(mesh.positions, mesh.position_stride, mesh.vertex_count, thing, "position");
    if (mesh.uvs != nullptr)
      g.uvs = read_vectors<2, glm::vec2>(mesh.uvs, mesh.uv_stride, mesh.vertex_count, thing, "uv");
    g.indices = read_indices(mesh);
  }

  void check_sides(const std::string& thing, std::uint32_t width, std::uint32_t height) const {
    if (width < 1 || height < 1 || width > side_limit || height > side_limit)
      refuse(thing, fmt::format("has an alpha of {} x {} texels", width, height),
             fmt::format("give 1 to {} on each side", side_limit));
  }

  void add_material(std::size_t number) {
    const host_material& from = host_.materials[number];
    const std::string thing = fmt::format("material {}", number);
    scene::material& m = out_.materials.emplace_back();
    m.name = from.name;
    m.alpha = from.alpha;
    m.double_sided = from.double_sided;
    if (from.alpha != scene::alpha_mode::mask) return;
    if (!std::isfinite(from.cutoff) || !std::isfinite(from.constant_alpha))
      refuse(thing, "has a cutoff or constant alpha that is not finite", "give numbers from 0 to 1");
    m.alpha_cutoff = from.cutoff;
    m.base_color.a = from.constant_alpha;
    const bool has_texture = from.texture.alpha != nullptr;
    if (has_texture && from.alpha_function) refuse(thing, "has both a texture and an alpha function", "give one");
    if (!has_texture && !from.alpha_function) return;
    if (has_texture) m.wrap_u = from.texture.wrap_u, m.wrap_v = from.texture.wrap_v;
    m.alpha_map = static_cast<std::uint32_t>(out_.alpha_maps.size());
    out_.alpha_maps.push_back(has_texture ? read_texture(from.texture, thing) : sample_function(from, thing));
  }

  scene::alpha_map read_texture(const host_texture& texture, const std::string& thing) const {
    check_sides(thing, texture.width, texture.height);
    const std::size_t row = texture.row_stride != 0 ? texture.row_stride : texture.width * texture.texel_stride;
    if (texture.texel_stride < 1 || row < texture.width * texture.texel_stride)
      refuse(thing, fmt::format("has rows of {} bytes for {} texels of {}", row, texture.width, texture.texel_stride),
             "give strides in bytes");
    scene::alpha_map map{texture.width, texture.height, {}};
    map.texels.reserve(std::size_t{map.width} * map.height);
    for (std::size_t y = 0; y < map.height; ++y)
      for (std::size_t x = 0; x < map.width; ++x)
        map.texels.push_back(texture.alpha[y * row + x * texture.texel_stride]);
    return map;
  }

  scene::alpha_map sample_function(const host_material& from, const std::string& thing) const {
    check_sides(thing, from.function_width, from.function_height);
    scene::alpha_map map{from.function_width, from.function_height, {}};
    map.texels.reserve(std::size_t{map.width} * map.height);
    for (std::uint32_t y = 0; y < map.height; ++y) {
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(map.height);
      for (std::uint32_t x = 0; x < map.width; ++x) {
        const float alpha = from.alpha_function((static_cast<float>(x) + 0.5f) / static_cast<float>(map.width), v);
        const float kept = alpha > 0.0f ? std::min(alpha, 1.0f) : 0.0f;  // a NaN becomes 0
        map.texels.push_back(static_cast<std::uint8_t>(std::lround(kept * 255.0f)));
      }
    }
    return map;
  }

  // Does not check the numbers of mesh and material: scene::finish does.
  void add_draw(std::size_t number) {
    const host_draw& from = host_.draws[number];
    for (const int k : {0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14}) {
      if (!std::isfinite(from.to_world[static_cast<std::size_t>(k)]))
        refuse(fmt::format("draw {}", number), "has a transform that is not finite", "give finite numbers");
    }
    scene::draw& d = out_.draws.emplace_back();
    d.node = static_cast<std::uint32_t>(number);
    d.mesh = d.geometry = from.mesh;
    d.material = from.material == no_material ? scene::no_index : from.material;
    d.host_tag = from.tag;
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row)
        d.to_world[column][row] = from.to_world[static_cast<std::size_t>(4 * column + row)];
    }
    d.tags = tags_of(from);
    d.moves = from.dynamic || from.animated;
    out_.node_names.emplace_back(from.name);
  }

  scene::draw_tags tags_of(const host_draw& from) {
    scene::draw_tags tags{
        .occluder = from.occluder, .dynamic = from.dynamic, .always = from.always, .never = from.never};
    if (!from.group.empty()) tags.group = group_of(std::string(from.group));
    // As with the marks of glTF: an animated draw that is in every set may move away, so it is a non-occluder.
    if (from.animated && tags.always) tags.occluder = false;
    tags.animated = from.animated && tags == scene::draw_tags{};
    return tags;
  }

  // Groups are numbered in the order of first use.
  std::uint32_t group_of(std::string name) {
    const auto [entry, added] = groups_.emplace(std::move(name), static_cast<std::uint32_t>(out_.groups.size()));
    if (added) out_.groups.push_back(entry->first);
    return entry->second;
  }

  const host_scene& host_;
  std::map<std::string, std::uint32_t> groups_;
  scene::scene out_;
};

}  // namespace

scene::scene scene_of(const host_scene& host) {
  return importer(host).run();
}

void require_no_colors(const metric_settings& how) {
  if (how.kind == metric_kind::color)
    throw error(error_kind::wrong_use, "host.no-colors", "metric", "is color, and the arrays of a host have no colors",
                "choose the metric pixel or view");
}

}  // namespace sightcell::bake
