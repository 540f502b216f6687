#include "gltf_materials.h"

#include <cmath>
#include <unordered_map>

#include "sightcell/base/error.h"

namespace sightcell::scene {
namespace {

class material_reader {
 public:
  material_reader(const json_object& root, const gltf_source& source,
                  const std::function<std::span<const std::uint8_t>(std::uint32_t)>& bytes_of_view,
                  std::size_t view_count, std::vector<std::string>& warnings)
      : source_(source),
        bytes_of_view_(bytes_of_view),
        view_count_(view_count),
        warnings_(warnings),
        textures_(root.objects("textures")),
        samplers_(root.objects("samplers")),
        images_(root.objects("images")) {}

  material_set read(const json_object& root) {
    for (const json_object& source : root.objects("materials")) {
      out_.coordinates.emplace_back();
      out_.materials.push_back(read_material(source));
    }
    return std::move(out_);
  }

 private:
  material read_material(const json_object& source) {
    material m;
    m.name = printable(source.text("name").value_or(""));
    const std::string mode = source.text("alphaMode").value_or("OPAQUE");
    if (mode == "MASK") {
      m.alpha = alpha_mode::mask;
    } else if (mode == "BLEND") {
      m.alpha = alpha_mode::blend;
    } else if (mode != "OPAQUE") {
      warnings_.push_back(source.where() + " has the unknown alphaMode \"" + printable(mode) + "\", taken as OPAQUE");
    }
    m.alpha_cutoff = static_cast<float>(source.real("alphaCutoff").value_or(0.5));
    m.double_sided = source.boolean("doubleSided").value_or(false);
    // KHR_materials_pbrSpecularGlossiness replaces the core's model: alpha is that of its diffuse color.
    const auto extensions = source.object("extensions");
    const auto diffuse = extensions ? extensions->object("KHR_materials_pbrSpecularGlossiness") : std::nullopt;
    if (diffuse) {
      read_color(*diffuse, "diffuseFactor", "diffuseTexture", m);
    } else if (const auto pbr = source.object("pbrMetallicRoughness")) {
      read_color(*pbr, "baseColorFactor", "baseColorTexture", m);
    }
    // A transmissive material is a non-occluder, whatever its alpha mode (KHR_materials_transmission).
    const auto transmission = extensions ? extensions->object("KHR_materials_transmission") : std::nullopt;
    if (transmission && transmission->real("transmissionFactor").value_or(0.0) > 0.0) {
      m.alpha = alpha_mode::blend;
      m.alpha_unknown = false;
    }
    return m;
  }

  void read_color(const json_object& from, const char* factor_key, const char* texture_key, material& m) {
    const std::vector<double> factor = from.reals(factor_key, 4);
    if (!factor.empty()) m.base_color = glm::vec4(factor[0], factor[1], factor[2], factor[3]);
    const auto texture = from.object(texture_key);
    if (texture) read_texture(*texture, m);
  }

  void read_texture(const json_object& info, material& m) {
    texture_coordinates& coordinates = out_.coordinates.back();
    constexpr std::uint64_t set_limit = 1000;
    coordinates.set = static_cast<std::uint32_t>(info.number("texCoord", set_limit).value_or(0));
    const auto extensions = info.object("extensions");
    const auto transform = extensions ? extensions->object("KHR_texture_transform") : std::nullopt;
    if (transform) {
      const std::vector<double> offset = transform->reals("offset", 2), scale = transform->reals("scale", 2);
      const double angle = transform->real("rotation").value_or(0.0);
      const double c = std::cos(angle), s = std::sin(angle);
      const double sx = scale.empty() ? 1.0 : scale[0], sy = scale.empty() ? 1.0 : scale[1];
      // The extension's matrix: translation x rotation x scale, the rotation turns from v toward u.
      coordinates.across = glm::vec2(sx * c, -sx * s);
      coordinates.down = glm::vec2(sy * s, sy * c);
      if (!offset.empty()) coordinates.offset = glm::vec2(offset[0], offset[1]);
      if (const auto set = transform->number("texCoord", set_limit)) coordinates.set = static_cast<std::uint32_t>(*set);
    }
    const std::uint32_t texture = info.required_index("index", "textures", textures_.size());
    m.base_color_image = image_of(texture);
    m.alpha_unknown = m.alpha == alpha_mode::mask && m.base_color_image == no_index;
    const auto sampler = textures_[texture].index("sampler", "samplers", samplers_.size());
    if (!sampler) return;
    m.wrap_u = wrap_of(samplers_[*sampler], "wrapS");
    m.wrap_v = wrap_of(samplers_[*sampler], "wrapT");
  }

  wrap wrap_of(const json_object& sampler, const char* key) {
    const std::uint64_t mode = sampler.number(key, UINT32_MAX).value_or(10497);
    if (mode == 33071) return wrap::clamp;
    if (mode == 33648) return wrap::mirror;
    if (mode != 10497)
      warnings_.push_back(sampler.where() + " has the unknown " + key + " " + std::to_string(mode) +
                          ", taken as repeat");
    return wrap::repeat;
  }

  std::uint32_t image_of(std::uint32_t texture) {
    const auto source = textures_[texture].index("source", "images", images_.size());
    if (!source) {
      warnings_.push_back(textures_[texture].where() + " has no PNG or JPEG image; the base color alone is used");
      return no_index;
    }
    const auto known = scene_image_.find(*source);
    if (known != scene_image_.end()) return known->second;
    const std::uint32_t number = read_image(images_[*source]);
    scene_image_.emplace(*source, number);
    return number;
  }

  std::uint32_t read_image(const json_object& source) {
    image out;
    out.name = printable(source.text("name").value_or(source.where()));
    const auto view = source.index("bufferView", "bufferViews", view_count_);
    try {
      if (view) {
        const std::span<const std::uint8_t> bytes = bytes_of_view_(*view);
        out.encoded.assign(bytes.begin(), bytes.end());
      } else {
        out.encoded = read_resource(source_, source.required_text("uri"), source.where(), std::nullopt);
      }
    } catch (const error& e) {
      warnings_.push_back(std::string("image left out: ") + e.what());
      return no_index;
    }
    out_.images.push_back(std::move(out));
    return static_cast<std::uint32_t>(out_.images.size() - 1);
  }

  const gltf_source& source_;
  const std::function<std::span<const std::uint8_t>(std::uint32_t)>& bytes_of_view_;
  std::size_t view_count_;
  std::vector<std::string>& warnings_;
  std::vector<json_object> textures_;
  std::vector<json_object> samplers_;
  std::vector<json_object> images_;
  std::unordered_map<std::uint32_t, std::uint32_t> scene_image_;
  material_set out_;
};

}  // namespace

material_set read_materials(const json_object& root, const gltf_source& source,
                            const std::function<std::span<const std::uint8_t>(std::uint32_t)>& bytes_of_view,
                            std::size_t view_count, std::vector<std::string>& warnings) {
  return material_reader(root, source, bytes_of_view, view_count, warnings).read(root);
}

}  // namespace sightcell::scene
