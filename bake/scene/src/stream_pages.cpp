#include "sightcell/scene/stream_pages.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "carried_materials.h"
#include "material_images.h"
#include "opened_gltf.h"
#include "page_glb.h"
#include "rest_attributes.h"
#include "rounded_geometry.h"

namespace sightcell::scene {
namespace {

constexpr double steps_per_texel = 32.0;
constexpr std::uint32_t unknown_side = 2048;  // pixels: of an image whose size cannot be read
constexpr double step_without_image = 1.0 / 1024;

image_type type_of(const nlohmann::json& image) {
  const auto found = image.find("mimeType");
  if (found == image.end() || !found->is_string()) return image_type::unknown;
  const auto& type = found->get_ref<const std::string&>();
  return type == "image/png"    ? image_type::png
         : type == "image/jpeg" ? image_type::jpg
         : type == "image/webp" ? image_type::webp
         : type == "image/ktx2" ? image_type::ktx2
                                : image_type::unknown;
}

// Returns the longest image of a basis vector: by how much the transform enlarges steps.
double scale_of(const glm::dmat4& m) {
  double largest = 0.0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, glm::length(glm::dvec3(m[c])));
  return largest;
}

using content_hash = std::array<std::uint64_t, 2>;

content_hash hash_of(const rounded_geometry& g) {
  XXH3_state_t* const state = XXH3_createState();
  XXH3_128bits_reset(state);
  for (std::size_t s = 0; s < g.streams.size(); ++s) {
    for (const stream_attribute& a : g.layout[s].attributes) {
      XXH3_128bits_update(state, a.name.c_str(), a.name.size() + 1);
      XXH3_128bits_update(state, &a.component_type, sizeof a.component_type);
    }
    XXH3_128bits_update(state, g.streams[s].data(), g.streams[s].size());
  }
  XXH3_128bits_update(state, g.corners.data(), g.corners.size() * sizeof(std::uint32_t));
  const XXH128_hash_t hash = XXH3_128bits_digest(state);
  XXH3_freeState(state);
  return {hash.low64, hash.high64};
}

bool are_equal(const rounded_geometry& a, const rounded_geometry& b) {
  return a.layout == b.layout && a.streams == b.streams && a.corners == b.corners;
}

}  // namespace

struct gltf_pager::state : opened_gltf {
  using opened_gltf::opened_gltf;

  std::vector<rounded_geometry> rounded;
  std::vector<streamed_geometry> geometries;
  std::vector<std::uint32_t> geometry_of_draw;
  std::vector<std::vector<material_image>> uses;         // by material
  std::vector<std::set<std::string>> needed_attributes;  // by material
  std::vector<std::vector<std::uint32_t>> images_of;
  std::vector<std::uint32_t> no_images;
  std::vector<streamed_image> images;
  std::string materials;
  std::uint32_t image_count = 0;

  void read_materials(bool textures, std::vector<std::string>& warnings) {
    carried_materials carried = carry_materials(document, *root, source, *table, warnings);
    uses = images_by_material(carried.sections);
    needed_attributes = attributes_by_material(carried.sections);
    images_of.resize(uses.size());
    for (auto& [number, bytes] : carried.images) {
      if (bytes.empty()) continue;
      streamed_image image;
      image.number = static_cast<std::uint32_t>(number);
      const auto size = size_of(bytes);
      if (size) image.width = size->width, image.height = size->height;
      image.type = type_of(carried.sections["images"][number]);
      image.bytes = std::move(bytes);
      images.push_back(std::move(image));
    }
    for (std::size_t m = 0; m < uses.size(); ++m) {
      for (const material_image& use : uses[m]) images_of[m].push_back(use.image);
      std::sort(images_of[m].begin(), images_of[m].end());
      images_of[m].erase(std::unique(images_of[m].begin(), images_of[m].end()), images_of[m].end());
    }
    for (streamed_image& image : images) image.use = use_of(image.number);
    nlohmann::json out = std::move(carried.sections);
    if (out.contains("images")) {
      image_count = static_cast<std::uint32_t>(out["images"].size());
      for (nlohmann::json& image : out["images"]) image.erase("bufferView"), image.erase("uri");
    }
    out["asset"] = {{"version", "2.0"}};
    if (!carried.copyright.empty()) out["asset"]["copyright"] = carried.copyright;
    materials = out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (!textures) images.clear(), images_of.assign(images_of.size(), {});
    std::erase_if(images, [&](const streamed_image& image) {
      return std::none_of(images_of.begin(), images_of.end(),
                          [&](const auto& list) { return std::binary_search(list.begin(), list.end(), image.number); });
    });
  }

  // Returns what all materials together want of an image.
  image_use use_of(std::uint32_t image) const {
    image_use out;
    bool only_normals = true;
    for (std::size_t m = 0; m < uses.size(); ++m) {
      for (const material_image& use : uses[m]) {
        if (use.image != image) continue;
        out.is_color = out.is_color || use.kind == texture_kind::base_color || use.kind == texture_kind::color;
        only_normals = only_normals && use.kind == texture_kind::normals;
        if (use.kind == texture_kind::numbers) out.alpha = std::max(out.alpha, alpha_use::number);
        if (use.kind == texture_kind::base_color && m < content.materials.size()) add_alpha(content.materials[m], out);
      }
    }
    out.has_normals = only_normals;
    return out;
  }

  static void add_alpha(const material& m, image_use& out) {
    if (m.alpha == alpha_mode::mask && out.alpha != alpha_use::tested) {
      out.alpha = alpha_use::tested;
      out.cutoff = m.alpha_cutoff / m.base_color.a;
    } else if (m.alpha == alpha_mode::blend) {
      out.alpha = std::max(out.alpha, alpha_use::blended);
    }
  }

  // Returns the largest step of texture coordinates for a material.
  double step_of(std::uint32_t material) const {
    if (material >= uses.size()) return step_without_image;
    double step = step_without_image;
    for (const material_image& use : uses[material]) {
      const auto found =
          std::find_if(images.begin(), images.end(), [&](const auto& i) { return i.number == use.image; });
      const std::uint32_t side =
          found == images.end() || found->width == 0 ? unknown_side : std::max(found->width, found->height);
      step = std::min(step, 1.0 / (steps_per_texel * use.scale * side));
    }
    return step;
  }

  // Draws of one primitive in one pose share vertices and attributes.
  using primitive_key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
  struct primitive_use {
    std::vector<std::uint32_t> draws;
    double scale = 0.0, step = 1.0;
  };

  void leave_out_unneeded(const std::vector<std::uint32_t>& draws, attribute_values& values) const {
    std::erase_if(values, [&](const auto& attribute) {
      const std::string& name = attribute.first;
      if (!name.starts_with("TEXCOORD_") && name != "TANGENT") return false;
      return std::none_of(draws.begin(), draws.end(), [&](std::uint32_t number) {
        const std::uint32_t material = content.draws[number].material;
        return material < needed_attributes.size() && needed_attributes[material].contains(name);
      });
    });
  }

  void round(const page_settings& how) {
    std::map<primitive_key, primitive_use> primitives;
    for (std::uint32_t number = 0; number < content.draws.size(); ++number) {
      const draw& d = content.draws[number];
      primitive_use& use = primitives[{d.mesh, d.primitive, d.geometry}];
      use.draws.push_back(number);
      const double scale = scale_of(d.to_world);
      if (std::isfinite(scale)) use.scale = std::max(use.scale, scale);
      use.step = std::min(use.step, step_of(d.material));
    }
    geometry_of_draw.assign(content.draws.size(), 0);
    std::map<content_hash, std::vector<std::uint32_t>> known;
    for (const auto& [key, use] : primitives) {
      const draw& d = content.draws[use.draws.front()];
      const geometry& g = content.geometries[d.geometry];
      attribute_values values =
          attributes_at_rest(content, poses, *attributes, d, attributes->read(d.mesh, d.primitive, g.positions.size()));
      if (!how.all_attributes) leave_out_unneeded(use.draws, values);
      rounded_geometry made = round_geometry(
          g, values, {exponent_of(use.scale > 0.0 ? how.grid / use.scale : how.grid), exponent_of(use.step)});
      const std::uint32_t number = number_of(std::move(made), known);
      for (const std::uint32_t one : use.draws) geometry_of_draw[one] = number;
    }
  }

  std::uint32_t number_of(rounded_geometry made, std::map<content_hash, std::vector<std::uint32_t>>& known) {
    std::vector<std::uint32_t>& same = known[hash_of(made)];
    for (const std::uint32_t number : same)
      if (are_equal(rounded[number], made)) return number;
    const auto number = static_cast<std::uint32_t>(rounded.size());
    same.push_back(number);
    geometries.push_back({static_cast<std::uint32_t>(made.corners.size() / 3), made.min, made.max});
    rounded.push_back(std::move(made));
    return number;
  }
};

gltf_pager::gltf_pager(const std::filesystem::path& path, int scene_index)
    : state_(std::make_unique<state>(path, scene_index)) {}

gltf_pager::~gltf_pager() = default;

const scene& gltf_pager::content() const {
  return state_->content;
}

void gltf_pager::prepare(const page_settings& how, std::vector<std::string>& warnings) {
  state_->read_materials(how.textures, warnings);
  state_->round(how);
}

const std::vector<streamed_geometry>& gltf_pager::geometries() const {
  return state_->geometries;
}

const std::vector<std::uint32_t>& gltf_pager::geometry_of_draw() const {
  return state_->geometry_of_draw;
}

bool gltf_pager::is_drawn(std::uint32_t geometry, std::uint32_t polygon) const {
  return state_->rounded[geometry].is_drawn(polygon);
}

glm::vec3 gltf_pager::corner(std::uint32_t geometry, std::uint32_t number) const {
  const rounded_geometry& g = state_->rounded[geometry];
  return position_of(g, g.corners[number]);
}

std::uint32_t gltf_pager::coded_size(const page_part& part) const {
  return stream_bytes(state_->rounded[part.geometry], part);
}

std::vector<std::byte> gltf_pager::page(std::span<const page_part> parts) const {
  return page_glb(state_->rounded, parts);
}

const std::string& gltf_pager::materials() const {
  return state_->materials;
}

std::uint32_t gltf_pager::image_count() const {
  return state_->image_count;
}

const std::vector<streamed_image>& gltf_pager::images() const {
  return state_->images;
}

const std::vector<std::uint32_t>& gltf_pager::images_of(std::uint32_t material) const {
  return material < state_->images_of.size() ? state_->images_of[material] : state_->no_images;
}

}  // namespace sightcell::scene
