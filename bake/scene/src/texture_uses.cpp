#include "sightcell/scene/texture_uses.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>

#include "gltf_accessors.h"
#include "gltf_attributes.h"
#include "gltf_file.h"
#include "image_header.h"
#include "import_scene.h"
#include "json_object.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

constexpr std::uint32_t longest_side = 65536;  // texels, the limit of the format

// A texture of a material, before its image is known to be readable.
struct named_use {
  std::uint32_t image = 0;
  texture_use use;
};

class use_reader {
 public:
  use_reader(const json_object& root, const gltf_source& source, accessor_table& table)
      : root_(root),
        source_(source),
        table_(table),
        attributes_(root, table),
        textures_(root.objects("textures")),
        images_(root.objects("images")) {}

  texture_uses read(const scene& of) {
    std::vector<bool> drawn(of.materials.size(), false);
    for (const draw& d : of.draws)
      if (d.material != no_index) drawn[d.material] = true;
    const std::vector<json_object> materials = root_.objects("materials");
    std::vector<std::vector<named_use>> found(of.materials.size());
    std::set<std::uint32_t> images;
    for (std::size_t i = 0; i < std::min(materials.size(), found.size()); ++i) {
      if (drawn[i]) collect(materials[i], found[i]);
      for (const named_use& one : found[i]) images.insert(one.image);
    }
    std::map<std::uint32_t, std::uint32_t> number_of;  // by image
    for (const std::uint32_t image : images) {
      const std::optional<image_size> size = size_of_image(images_[image]);
      if (!size) continue;
      number_of.emplace(image, static_cast<std::uint32_t>(out_.textures.size()));
      out_.textures.push_back({image, size->width, size->height});
    }
    for (const std::vector<named_use>& uses : found) {
      std::vector<texture_use>& own = out_.of_material.emplace_back();
      for (const named_use& one : uses) {
        const auto number = number_of.find(one.image);
        if (number == number_of.end()) continue;
        own.push_back(one.use);
        own.back().texture = number->second;
      }
    }
    read_coordinates(of);
    return std::move(out_);
  }

 private:
  // Appends the textures at any depth of a material: those of extensions too.
  void collect(const json_object& holder, std::vector<named_use>& out) {
    for (const std::string& key : holder.keys()) {
      const nlohmann::json* value = holder.raw(key.c_str());
      if (!value->is_object()) continue;
      const json_object child = holder.required_object(key.c_str());
      if (std::string_view(key).ends_with("Texture") && child.has("index"))
        add(child, out);
      else if (key != "extras")
        collect(child, out);
    }
  }

  void add(const json_object& info, std::vector<named_use>& out) {
    constexpr std::uint64_t set_limit = 1000;
    texture_use use;
    use.set = static_cast<std::uint32_t>(info.number("texCoord", set_limit).value_or(0));
    const auto extensions = info.object("extensions");
    const auto transform = extensions ? extensions->object("KHR_texture_transform") : std::nullopt;
    if (transform) {
      const std::vector<double> scale = transform->reals("scale", 2);
      const double angle = transform->real("rotation").value_or(0.0);
      const double c = std::cos(angle), s = std::sin(angle);
      const double sx = scale.empty() ? 1.0 : scale[0], sy = scale.empty() ? 1.0 : scale[1];
      use.transform = glm::dmat2(sx * c, -sx * s, sy * s, sy * c);  // columns
      if (const auto set = transform->number("texCoord", set_limit)) use.set = static_cast<std::uint32_t>(*set);
    }
    const json_object& texture = textures_[info.required_index("index", "textures", textures_.size())];
    if (const auto image = texture.index("source", "images", images_.size())) out.push_back({*image, use});
    // KHR_texture_basisu and others name an image in place of this one; the host decides.
    const auto others = texture.object("extensions");
    for (const std::string& key : others ? others->keys() : std::vector<std::string>()) {
      if (!others->raw(key.c_str())->is_object()) continue;
      const auto image = others->required_object(key.c_str()).index("source", "images", images_.size());
      if (image) out.push_back({*image, use});
    }
  }

  std::optional<image_size> size_of_image(const json_object& image) {
    try {
      const auto view = image.index("bufferView", "bufferViews", table_.view_count());
      const std::optional<image_size> size =
          view ? size_in_header(table_.bytes_of_view(*view))
               : size_in_header(read_resource(source_, image.required_text("uri"), image.where(), std::nullopt));
      if (size && std::max(size->width, size->height) <= longest_side) return size;
      out_.warnings.push_back(image.where() + " has no known size: it is left out of the texture residency");
    } catch (const error& e) {
      out_.warnings.push_back(std::string("image left out of the texture residency: ") + e.what());
    }
    return std::nullopt;
  }

  void read_coordinates(const scene& of) {
    for (const draw& d : of.draws) {
      if (d.material == no_index || out_.of_material[d.material].empty()) continue;
      std::map<std::uint32_t, std::vector<glm::vec2>>& own = out_.coordinates[{d.mesh, d.primitive}];
      std::optional<attribute_values> values;
      for (const texture_use& use : out_.of_material[d.material]) {
        if (own.contains(use.set)) continue;
        if (!values) values = attributes_.read(d.mesh, d.primitive, of.geometries[d.geometry].positions.size());
        std::vector<glm::vec2>& uvs = own[use.set];  // stays empty where the file has none
        const auto found = values->find("TEXCOORD_" + std::to_string(use.set));
        if (found == values->end()) continue;
        uvs.resize(found->second.size() / 2);
        for (std::size_t i = 0; i < uvs.size(); ++i) uvs[i] = {found->second[2 * i], found->second[2 * i + 1]};
      }
    }
  }

  const json_object& root_;
  const gltf_source& source_;
  accessor_table& table_;
  gltf_attributes attributes_;
  std::vector<json_object> textures_, images_;
  texture_uses out_;
};

}  // namespace

texture_uses read_texture_uses(const std::filesystem::path& path, const scene& of) {
  const gltf_source source = source_of(path);
  try {
    gltf_file file = split_gltf(read_scene_bytes(path), source.name);
    const nlohmann::json document = parse_json(file.json);
    const json_object root(document, "", source.name);
    accessor_table table(root, source, std::move(file.binary));
    return use_reader(root, source, table).read(of);
  } catch (const std::bad_alloc&) {
    refuse_for_memory(source.name);
  }
}

}  // namespace sightcell::scene
