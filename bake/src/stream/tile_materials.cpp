#include "stream/tile_materials.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "sightcell/base/json_text.h"

namespace sightcell::bake {
namespace {

using nlohmann::ordered_json;

// Returns the element of a section that `holder[key]` names; null: there is none.
const ordered_json* element_of(const ordered_json& sections, const char* section, const ordered_json& holder,
                               const char* key) {
  const auto list = sections.find(section);
  const auto number = holder.find(key);
  if (list == sections.end() || !list->is_array() || number == holder.end() || !number->is_number_unsigned())
    return nullptr;
  const auto index = number->get<std::uint64_t>();
  return index < list->size() ? &(*list)[static_cast<std::size_t>(index)] : nullptr;
}

// Copies elements of the sections, each once, and numbers them anew.
class renumbered_sections {
 public:
  renumbered_sections(const ordered_json& from, const std::vector<std::string>& image_uris)
      : from_(from), image_uris_(image_uris) {}

  // Extensions of materials have textures, too.
  void renumber_textures(ordered_json& value) {
    std::vector<std::string> without_file;
    for (auto& [key, child] : value.items()) {
      if (!child.is_object()) continue;
      if (!std::string_view(key).ends_with("Texture")) {
        renumber_textures(child);
      } else if (const auto number = texture(child)) {
        child["index"] = *number;
      } else {
        without_file.push_back(key);
      }
    }
    for (const std::string& key : without_file) value.erase(key);
  }

  void put(ordered_json& document) {
    if (!textures_.empty()) document["textures"] = std::move(textures_);
    if (!samplers_.empty()) document["samplers"] = std::move(samplers_);
    if (!images_.empty()) document["images"] = std::move(images_);
  }

 private:
  using numbers = std::map<std::uint64_t, std::optional<std::size_t>>;

  std::optional<std::size_t> texture(const ordered_json& info) {
    const ordered_json* const found = element_of(from_, "textures", info, "index");
    if (!found || !found->is_object()) return std::nullopt;
    const auto [known, is_new] = texture_of_.try_emplace(info["index"].get<std::uint64_t>());
    if (!is_new) return known->second;
    ordered_json made = *found;
    bool has_image = renumber_image(made);
    if (const auto extensions = made.find("extensions"); extensions != made.end() && extensions->is_object()) {
      // EXT_texture_webp and others name an image in place of that of the texture.
      std::vector<std::string> without_file;
      for (auto& [name, extension] : extensions->items()) {
        if (!extension.is_object() || !extension.contains("source")) continue;
        if (renumber_image(extension))
          has_image = true;
        else
          without_file.push_back(name);
      }
      for (const std::string& name : without_file) extensions->erase(name);
      if (extensions->empty()) made.erase("extensions");
    }
    if (!has_image) return std::nullopt;
    if (made.contains("sampler")) {
      if (const ordered_json* const sampler = element_of(from_, "samplers", made, "sampler"))
        made["sampler"] = number_of(made["sampler"].get<std::uint64_t>(), *sampler, sampler_of_, samplers_);
      else
        made.erase("sampler");
    }
    known->second = textures_.size();
    textures_.push_back(std::move(made));
    return known->second;
  }

  // Returns whether the image has a file; without one its number is removed.
  bool renumber_image(ordered_json& holder) {
    const ordered_json* const found = element_of(from_, "images", holder, "source");
    const std::uint64_t number = found ? holder["source"].get<std::uint64_t>() : 0;
    if (!found || number >= image_uris_.size() || image_uris_[number].empty()) {
      holder.erase("source");
      return false;
    }
    ordered_json made = *found;
    made.erase("bufferView");
    made["uri"] = image_uris_[number];
    holder["source"] = number_of(number, made, image_of_, images_);
    return true;
  }

  static std::size_t number_of(std::uint64_t old_number, const ordered_json& element, numbers& known,
                               ordered_json& list) {
    std::optional<std::size_t>& number = known[old_number];
    if (!number) {
      number = list.size();
      list.push_back(element);
    }
    return *number;
  }

  const ordered_json& from_;
  const std::vector<std::string>& image_uris_;
  numbers texture_of_, sampler_of_, image_of_;
  ordered_json textures_ = ordered_json::array(), samplers_ = ordered_json::array(), images_ = ordered_json::array();
};

void collect_extensions(const ordered_json& value, std::vector<std::string>& names) {
  if (!value.is_structured()) return;
  if (value.is_object())
    if (const auto found = value.find("extensions"); found != value.end() && found->is_object())
      for (const auto& extension : found->items()) names.push_back(extension.key());
  for (const ordered_json& inner : value) collect_extensions(inner, names);
}

}  // namespace

tile_materials::tile_materials(const std::string& sections, std::vector<std::string> image_uris)
    : sections_(scene::parse_ordered_json(sections)), image_uris_(std::move(image_uris)) {}

void tile_materials::put(std::span<const std::uint32_t> materials, ordered_json& document) const {
  renumbered_sections made(sections_, image_uris_);
  ordered_json list = ordered_json::array();
  for (const std::uint32_t number : materials) {
    list.push_back(sections_.at("materials").at(number));
    made.renumber_textures(list.back());
  }
  ordered_json sections = ordered_json::object();
  if (!list.empty()) sections["materials"] = std::move(list);
  made.put(sections);
  std::vector<std::string> used;
  collect_extensions(sections, used);
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    const auto declared = sections_.find(key);
    if (declared == sections_.end()) continue;
    for (const ordered_json& name : *declared)
      if (name.is_string() && std::find(used.begin(), used.end(), name.get_ref<const std::string&>()) != used.end())
        document[key].push_back(name);
  }
  document.update(sections);
}

}  // namespace sightcell::bake
