#include "gltf_materials.h"

#include <unordered_map>

#include "gltf_file.h"
#include "sightcell/scene/error.h"

namespace sightcell::scene {
namespace {

class material_reader {
 public:
  material_reader(const json_object& root, const std::filesystem::path& scene_path,
                  const std::function<std::span<const std::uint8_t>(std::uint32_t)>& bytes_of_view,
                  std::size_t view_count, std::vector<std::string>& warnings)
      : scene_path_(scene_path),
        bytes_of_view_(bytes_of_view),
        view_count_(view_count),
        warnings_(warnings),
        textures_(root.objects("textures")),
        images_(root.objects("images")) {}

  material_set read(const json_object& root) {
    for (const json_object& source : root.objects("materials")) out_.materials.push_back(read_material(source));
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
    const auto pbr = source.object("pbrMetallicRoughness");
    if (!pbr) return m;
    const std::vector<double> factor = pbr->reals("baseColorFactor", 4);
    if (!factor.empty()) m.base_color = glm::vec4(factor[0], factor[1], factor[2], factor[3]);
    const auto texture = pbr->object("baseColorTexture");
    if (texture) m.base_color_image = image_of(*texture);
    return m;
  }

  std::uint32_t image_of(const json_object& texture_info) {
    if (texture_info.number("texCoord", UINT32_MAX).value_or(0) != 0) {
      warnings_.push_back(texture_info.where() + " uses another set than TEXCOORD_0; its picture may look wrong");
    }
    const std::uint32_t texture = texture_info.required_index("index", "textures", textures_.size());
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
        out.encoded = read_resource(scene_path_, source.required_text("uri"), source.where(), std::nullopt);
      }
    } catch (const error& e) {
      warnings_.push_back(std::string("image left out: ") + e.what());
      return no_index;
    }
    out_.images.push_back(std::move(out));
    return static_cast<std::uint32_t>(out_.images.size() - 1);
  }

  const std::filesystem::path& scene_path_;
  const std::function<std::span<const std::uint8_t>(std::uint32_t)>& bytes_of_view_;
  std::size_t view_count_;
  std::vector<std::string>& warnings_;
  std::vector<json_object> textures_;
  std::vector<json_object> images_;
  std::unordered_map<std::uint32_t, std::uint32_t> scene_image_;
  material_set out_;
};

}  // namespace

material_set read_materials(const json_object& root, const std::filesystem::path& scene_path,
                            const std::function<std::span<const std::uint8_t>(std::uint32_t)>& bytes_of_view,
                            std::size_t view_count, std::vector<std::string>& warnings) {
  return material_reader(root, scene_path, bytes_of_view, view_count, warnings).read(root);
}

}  // namespace sightcell::scene
