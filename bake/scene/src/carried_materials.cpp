#include "carried_materials.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string_view>

#include "sightcell/base/error.h"
#include "used_extensions.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

// Returns the media type of an image; empty if unknown.
std::string media_type(const std::vector<std::uint8_t>& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 16));
  if (text.starts_with("\x89PNG")) return "image/png";
  if (text.starts_with("\xFF\xD8\xFF")) return "image/jpeg";
  if (text.starts_with("RIFF") && text.substr(8).starts_with("WEBP")) return "image/webp";
  if (text.starts_with("\xABKTX 20")) return "image/ktx2";
  return "";
}

std::vector<std::uint8_t> image_bytes(const json_object& image, const gltf_source& source, accessor_table& table) {
  const auto view = image.index("bufferView", "bufferViews", table.view_count());
  if (!view) return read_resource(source, image.required_text("uri"), image.where(), std::nullopt);
  const std::span<const std::uint8_t> bytes = table.bytes_of_view(*view);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

carried_materials carry_materials(const json& document, const json_object& root, const gltf_source& source,
                                  accessor_table& table, std::vector<std::string>& warnings) {
  carried_materials out;
  if (const auto asset = root.object("asset")) out.copyright = asset->text("copyright").value_or("");
  std::set<std::string> used;
  for (const char* section : {"materials", "textures", "samplers", "images"}) {
    const auto found = document.find(section);
    if (found == document.end() || !found->is_array() || found->empty()) continue;
    out.sections[section] = *found;
    used.merge(used_extensions(*found));
  }
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    json kept = json::array();
    for (const std::string& name : root.texts(list))
      if (used.contains(name)) kept.push_back(name);
    if (!kept.empty()) out.sections[list] = std::move(kept);
  }
  const std::vector<json_object> images = root.objects("images");
  for (std::size_t i = 0; i < images.size(); ++i) {
    json& image = out.sections["images"][i];
    try {
      std::vector<std::uint8_t> bytes = image_bytes(images[i], source, table);
      const std::string type = media_type(bytes);
      if (!type.empty()) image["mimeType"] = type;
      image.erase("uri");
      out.images.emplace_back(i, std::move(bytes));
    } catch (const error& e) {
      warnings.push_back(std::string("image left out: ") + e.what());
      // An index of a view of the other file is not valid in this one.
      if (image.erase("bufferView") > 0) image["uri"] = "missing-" + std::to_string(i);
    }
  }
  return out;
}

}  // namespace sightcell::scene
