// Transforms the scene to world space and makes the masks of MASK materials.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <string>

#include "opposite_pairs.h"
#include "sightcell/scene/scene.h"
#include "world_point.h"

namespace sightcell::scene {
namespace {

// Of all masks together: fits one buffer on every device.
constexpr std::size_t mask_texel_limit = std::size_t{64} << 20;
constexpr std::uint32_t image_side_limit = 16384;

// What alpha decides for all polygons of a material.
enum class presence : std::uint8_t { everywhere, nowhere, where_mask_passes };

// For polygons of a material without vertex colors. With them a mask is needed if there is any alpha.
struct material_presence {
  presence where = presence::everywhere;
  std::uint32_t mask = 0;
  bool unknown = false;  // the image is missing
};

// Returns whether a polygon has an area. Differences of floats and their products are exact or nearly so in double
// precision, so only a polygon whose rounded corners are on one line has none.
bool has_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 n = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
  return n.x != 0.0 || n.y != 0.0 || n.z != 0.0;
}

class flattener {
 public:
  flattener(const scene& s, animated_as animated, std::span<const std::string> closed)
      : scene_(s), animated_(animated) {
    for (const std::string& name : s.groups)
      is_closed_.push_back(std::find(closed.begin(), closed.end(), name) != closed.end());
  }

  world_geometry run() {
    make_masks();
    std::size_t vertices = 0;
    if (!scene_.draws.empty()) {
      const draw& last = scene_.draws.back();
      vertices = last.base_vertex + scene_.geometries[last.geometry].positions.size();
    }
    out_.positions.reserve(vertices);
    out_.indices.reserve(std::size_t{scene_.polygon_count} * 3);
    out_.kinds.reserve(scene_.polygon_count);
    constexpr float infinity = std::numeric_limits<float>::infinity();
    out_.min = glm::vec3(infinity);
    out_.max = glm::vec3(-infinity);
    for (const draw& d : scene_.draws) append_draw(d);
    warn_of_texels();
    list_lods();
    out_.starts = scene_.starts;
    out_.cells = scene_.cells;
    warn_of_broken_polygons();
    if (out_.min.x > out_.max.x) out_.min = out_.max = glm::vec3(0.0f);
    // Every polygon at a corner that is not finite is absent already, so any value will do. A NaN must not reach a
    // ray tracer or a GPU that gets the whole array.
    for (glm::vec3& p : out_.positions) {
      if (!is_finite(p)) p = glm::vec3(0.0f);
    }
    join_opposite_pairs(out_);
    out_.opacity = make_opacity_maps(out_.masked, out_.masks);
    return std::move(out_);
  }

 private:
  // Materials that share texels get a mask each, because the cutoff may differ.
  void make_masks() {
    presences_.resize(scene_.materials.size());
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      if (scene_.materials[i].alpha == alpha_mode::mask) presences_[i] = presence_of(scene_.materials[i]);
    }
  }

  // Halves the largest masks as soon as the limit is passed, so that memory never contains more than the limit.
  std::uint32_t add_mask(alpha_mask mask) {
    texels_ += mask.texels.size();
    out_.masks.push_back(std::move(mask));
    while (texels_ > mask_texel_limit) {
      const auto largest =
          std::max_element(out_.masks.begin(), out_.masks.end(),
                           [](const alpha_mask& a, const alpha_mask& b) { return a.texels.size() < b.texels.size(); });
      texels_ -= largest->texels.size();
      *largest = halved(*largest);
      texels_ += largest->texels.size();
      too_many_texels_ = true;
    }
    return static_cast<std::uint32_t>(out_.masks.size() - 1);
  }

  void warn_of_texels() {
    if (!too_many_texels_) return;
    out_.warnings.push_back(scene_.name + ": the alpha of its MASK materials has more than " +
                            std::to_string(mask_texel_limit) + " texels; the largest are used at lower resolution");
  }

  material_presence presence_of(const material& m) {
    const float constant = m.base_color.a;
    const auto constantly = [](bool there) {
      return material_presence{there ? presence::everywhere : presence::nowhere, 0};
    };
    alpha_mask mask = texels_of(m);
    mask.wrap_u = m.wrap_u, mask.wrap_v = m.wrap_v;
    if (mask.texels.empty() || !(constant > 0.0f)) {
      material_presence there = constantly(constant >= m.alpha_cutoff);
      there.unknown = m.alpha_unknown || (mask.texels.empty() && m.base_color_image != no_index);
      return there;
    }
    mask.cutoff = m.alpha_cutoff / constant;
    const auto [least, most] = std::minmax_element(mask.texels.begin(), mask.texels.end());
    if (static_cast<float>(*least) / 255.0f >= mask.cutoff) return constantly(true);
    if (!(static_cast<float>(*most) / 255.0f >= mask.cutoff)) return constantly(false);
    return {presence::where_mask_passes, add_mask(std::move(mask))};
  }

  // Returns an empty mask if the material has only its constant alpha.
  alpha_mask texels_of(const material& m) {
    alpha_mask mask;
    if (m.alpha_map != no_index) {
      const alpha_map& map = scene_.alpha_maps[m.alpha_map];
      mask.width = map.width, mask.height = map.height, mask.texels = map.texels;
      return mask;
    }
    if (m.base_color_image == no_index) return mask;
    const auto known = decoded_.find(m.base_color_image);
    if (known != decoded_.end()) return known->second;
    const image& source = scene_.images[m.base_color_image];
    const auto pixels = decode(source, image_side_limit);
    if (!pixels) {
      out_.warnings.push_back(scene_.name + ": image \"" + source.name + "\" of the MASK material \"" + m.name +
                              "\" cannot be decoded; its polygons occlude nothing");
      return decoded_[m.base_color_image] = mask;
    }
    mask.width = pixels->width, mask.height = pixels->height;
    mask.texels.resize(std::size_t{mask.width} * mask.height);
    for (std::size_t i = 0; i < mask.texels.size(); ++i) mask.texels[i] = pixels->rgba[4 * i + 3];
    for (; mask.texels.size() > mask_texel_limit; too_many_texels_ = true) mask = halved(mask);
    decoded_texels_ += mask.texels.size();
    if (decoded_texels_ > mask_texel_limit) {
      decoded_.clear();
      decoded_texels_ = mask.texels.size();
    }
    return decoded_[m.base_color_image] = std::move(mask);
  }

  void append_draw(const draw& d) {
    const geometry& g = scene_.geometries[d.geometry];
    for (const glm::vec3& local : g.positions) out_.positions.push_back(world_point(d.to_world, local));
    const bool mirrored = is_mirrored(d.to_world);
    polygon_kind kind = kind_of(d);
    material_presence there;
    if (d.material != no_index) {
      kind.alpha = scene_.materials[d.material].alpha;
      kind.double_sided = scene_.materials[d.material].double_sided;
      there = presences_[d.material];
      kind.non_occluder |= there.unknown;
    }
    for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) {
      const std::array<std::uint32_t, 3> local = {g.indices[i], g.indices[i + (mirrored ? 2 : 1)],
                                                  g.indices[i + (mirrored ? 1 : 2)]};
      append_polygon(d, local, kind, there);
    }
  }

  // Returns what the tags alone decide.
  polygon_kind kind_of(const draw& d) const {
    polygon_kind kind;
    const bool left_alone = !d.tags.animated || animated_ == animated_as::rest;
    kind.absent = d.tags.dynamic || d.tags.never || (!left_alone && animated_ == animated_as::dynamic) ||
                  (d.lod_object != no_index && d.lod_level > 0);
    kind.always = !kind.absent && (d.tags.always || !left_alone);
    const bool may_hide = d.tags.group != no_index && !is_closed_[d.tags.group];
    kind.non_occluder = !d.tags.occluder || may_hide || !left_alone;
    return kind;
  }

  void count_absent(const draw& d, const polygon_kind& kind, bool finite, bool area) {
    absent_counts& counts = out_.absent;
    ++(!finite                                       ? counts.not_finite
       : !area                                       ? counts.no_area
       : !kind.absent                                ? counts.cut_away
       : d.lod_object != no_index && d.lod_level > 0 ? counts.coarser_level
                                                     : counts.tagged);
  }

  void warn_of_broken_polygons() {
    const absent_counts& a = out_.absent;
    if (a.no_area + a.not_finite == 0) return;
    out_.warnings.push_back(scene_.name + ": " + std::to_string(a.no_area) + " polygons have no area and " +
                            std::to_string(a.not_finite) +
                            " a corner that is not finite; they keep their source ids and are never visible");
  }

  // A coarser level whose tags keep it out of all sets stays out.
  void list_lods() {
    std::map<std::uint32_t, lod_object> objects;
    for (const draw& d : scene_.draws) {
      if (d.lod_object == no_index || d.polygon_count == 0) continue;
      lod_object& object = objects[d.lod_object];
      const polygon_range range{d.first_source, d.polygon_count};
      if (d.lod_level == 0)
        object.finest.push_back(range);
      else if (!d.tags.dynamic && !d.tags.never)
        object.coarser.push_back(range);
    }
    for (auto& [number, object] : objects)
      if (!object.finest.empty() && !object.coarser.empty()) out_.lods.push_back(std::move(object));
  }

  void append_polygon(const draw& d, const std::array<std::uint32_t, 3>& local, polygon_kind kind,
                      const material_presence& there) {
    for (const std::uint32_t vertex : local) out_.indices.push_back(d.base_vertex + vertex);
    const glm::vec3& a = out_.positions[d.base_vertex + local[0]];
    const glm::vec3& b = out_.positions[d.base_vertex + local[1]];
    const glm::vec3& c = out_.positions[d.base_vertex + local[2]];
    const bool fades = kind.alpha == alpha_mode::mask && has_alpha(d, local);
    const bool finite = is_finite(a) && is_finite(b) && is_finite(c), area = finite && has_area(a, b, c);
    if (kind.absent || !area || there.where == presence::nowhere) {
      count_absent(d, kind, finite, area);
      kind.absent = true;
      kind.always = false;
    } else {
      out_.min = glm::min(out_.min, glm::min(a, glm::min(b, c)));
      out_.max = glm::max(out_.max, glm::max(a, glm::max(b, c)));
      kind.alpha_tested = there.where == presence::where_mask_passes || fades;
    }
    const auto id = static_cast<std::uint32_t>(out_.kinds.size());
    out_.kinds.push_back(kind);
    if (!kind.alpha_tested) return;
    masked_polygon& tested = out_.masked.emplace_back();
    tested.id = id;
    tested.mask = there.where == presence::where_mask_passes ? there.mask : full_mask(d.material);
    if (fades) {
      const std::vector<glm::u8vec4>& colors = scene_.geometries[d.geometry].colors;
      for (std::size_t k = 0; k < 3; ++k) tested.alphas[k] = static_cast<float>(colors[local[k]].a) / 255.0f;
    }
    // Corners without texture coordinates, or with invalid ones, get those of the origin, as in pictures.
    const std::vector<glm::vec2>& uvs = scene_.geometries[d.geometry].uvs;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec2 uv = local[k] < uvs.size() ? uvs[local[k]] : glm::vec2(0.0f);
      tested.uvs[k] = is_finite(uv) ? uv : glm::vec2(0.0f);
    }
  }

  bool has_alpha(const draw& d, const std::array<std::uint32_t, 3>& local) const {
    const std::vector<glm::u8vec4>& colors = scene_.geometries[d.geometry].colors;
    return !colors.empty() &&
           std::any_of(local.begin(), local.end(), [&](std::uint32_t vertex) { return colors[vertex].a != 255; });
  }

  // Returns the mask of a material that is present everywhere except for the alpha of vertex colors. Texels that all
  // pass alone may fail with a factor, so they are kept.
  std::uint32_t full_mask(std::uint32_t material_number) {
    const auto known = full_masks_.find(material_number);
    if (known != full_masks_.end()) return known->second;
    const material& m = scene_.materials[material_number];
    alpha_mask mask = texels_of(m);
    mask.wrap_u = m.wrap_u, mask.wrap_v = m.wrap_v;
    if (mask.texels.empty()) mask.width = mask.height = 1, mask.texels = {255};
    // If a constant alpha of 0 passes, it passes with every factor.
    mask.cutoff = m.base_color.a > 0.0f ? m.alpha_cutoff / m.base_color.a : -1.0f;
    const std::uint32_t number = add_mask(std::move(mask));
    full_masks_.emplace(material_number, number);
    return number;
  }

  const scene& scene_;
  animated_as animated_;
  std::vector<bool> is_closed_;  // by named group
  world_geometry out_;
  std::map<std::uint32_t, std::uint32_t> full_masks_;  // by material
  std::map<std::uint32_t, alpha_mask> decoded_;        // by image: many materials use one atlas
  std::size_t texels_ = 0, decoded_texels_ = 0;        // of all masks; of decoded_
  bool too_many_texels_ = false;
  std::vector<material_presence> presences_;
};

}  // namespace

world_geometry flatten(const scene& s, animated_as animated, std::span<const std::string> closed) {
  return flattener(s, animated, closed).run();
}

}  // namespace sightcell::scene
