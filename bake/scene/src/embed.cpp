#include "sightcell/scene/embed.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "glb_bytes.h"
#include "gltf_file.h"
#include "json_object.h"
#include "sightcell/base/json_text.h"
#include "sightcell/scene/named_files.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* view_name = "sightcell-pvs";

// A scene file and its JSON.
struct container {
  gltf_source source;
  gltf_file file;
  bool is_glb = false;

  explicit container(const std::filesystem::path& path) : source(source_of(path)) {
    const std::vector<std::uint8_t> bytes = read_scene_bytes(path);
    file = split_gltf(bytes, source.name);
    is_glb = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
  }

  ordered_json document() const {
    ordered_json parsed = parse_ordered_json(file.json, false);
    if (!parsed.is_object())
      refuse(source.name, "scene.bad-json", "its JSON cannot be parsed",
             "the file is damaged: copy or export it again");
    return parsed;
  }
};

// Returns a member that has to be of one kind, and makes it if it is missing.
ordered_json& member(ordered_json& parent, const char* key, ordered_json empty, const container& of) {
  ordered_json& found = parent[key];
  if (found.is_null()) found = std::move(empty);
  if (found.type() != (std::string_view(key) == "bufferViews" || std::string_view(key) == "buffers"
                           ? ordered_json::value_t::array
                           : ordered_json::value_t::object))
    refuse(of.source.name, "scene.bad-field", std::string(key) + " is not what glTF requires",
           "remove it or export the file again");
  return found;
}

std::uint64_t whole_number(const ordered_json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
}

// Returns where the bytes of other views of the first buffer end.
std::uint64_t end_of_others(const ordered_json& views, std::size_t own) {
  std::uint64_t end = 0;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (i != own && whole_number(views[i], "buffer") == 0)
      end = std::max(end, whole_number(views[i], "byteOffset") + whole_number(views[i], "byteLength"));
  return end;
}

std::vector<std::byte> glb_with(const container& scene_file, std::span<const std::byte> pvs) {
  ordered_json document = scene_file.document();
  // A new member moves the others of its object, so all are made before the first is referred to.
  member(document, "buffers", ordered_json::array(), scene_file);
  member(document, "bufferViews", ordered_json::array(), scene_file);
  ordered_json& marks = member(member(document, "extras", ordered_json::object(), scene_file), "sightcell",
                               ordered_json::object(), scene_file);
  ordered_json& buffers = document["buffers"];
  ordered_json& views = document["bufferViews"];
  const std::vector<std::uint8_t> nothing;
  const std::vector<std::uint8_t>& before = scene_file.file.binary ? *scene_file.file.binary : nothing;
  if (!buffers.empty() && (!scene_file.file.binary || !buffers[0].is_object() || buffers[0].contains("uri")))
    refuse(scene_file.source.name, "embed.separate-buffers", "its first buffer is not in the .glb",
           "export the scene as one .glb, or as .gltf");
  if (buffers.empty()) buffers.push_back(ordered_json::object());
  const ordered_json named = marks.contains("pvs") ? marks["pvs"] : ordered_json();
  std::size_t number = named.is_object() && named.contains("bufferView")
                           ? static_cast<std::size_t>(whole_number(named, "bufferView"))
                           : views.size();
  number = std::min(number, views.size());
  std::uint64_t begin = std::min<std::uint64_t>(whole_number(buffers[0], "byteLength"), before.size());
  if (number < views.size()) {
    // The file that was there before goes, if nothing is behind it.
    const std::uint64_t old = whole_number(views[number], "byteOffset");
    if (old + whole_number(views[number], "byteLength") == begin && end_of_others(views, number) <= old) begin = old;
  } else {
    views.push_back(ordered_json::object());
  }
  const std::uint64_t at = (begin + 3) / 4 * 4, end = at + pvs.size();
  views[number] = {{"buffer", 0}, {"byteOffset", at}, {"byteLength", pvs.size()}, {"name", view_name}};
  buffers[0]["byteLength"] = end;
  marks["pvs"] = {{"bufferView", number}};
  std::string text = document.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  const std::uint64_t binary = (end + 3) / 4 * 4;
  if (glb_size(text, binary) > longest_glb)
    refuse(scene_file.source.name, "embed.too-large", "would be a .glb of more than 4 GiB with the .pvs file",
           "keep the .pvs file beside it");
  std::vector<std::byte> out = glb_with_room(std::move(text), binary);
  const std::span<std::byte> room = std::span(out).last(binary);
  if (begin > 0) std::memcpy(room.data(), before.data(), begin);
  std::memcpy(room.data() + at, pvs.data(), pvs.size());
  return out;
}

// Returns a path as a relative URI.
std::string uri_of(const std::filesystem::path& relative) {
  constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string uri;
  for (const char c : relative.generic_string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (plain.find(c) != std::string_view::npos)
      uri += c;
    else
      uri += {'%', digits[byte >> 4], digits[byte & 15]};
  }
  return uri;
}

std::filesystem::path folder_of_file(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(std::filesystem::absolute(file).parent_path(), ignored);
}

std::vector<std::byte> gltf_with(const container& scene_file, const std::filesystem::path& pvs_file,
                                 const std::filesystem::path& output) {
  const std::filesystem::path relative =
      (folder_of_file(pvs_file) / pvs_file.filename()).lexically_relative(folder_of_file(output));
  if (relative.empty() || *relative.begin() == "..")
    refuse(printable(pvs_file.string(), 1000), "embed.outside-folder",
           "is outside of the folder of " + printable(output.string(), 1000) + ", which has to name it",
           "write it beside the scene");
  ordered_json document = scene_file.document();
  member(member(document, "extras", ordered_json::object(), scene_file), "sightcell", ordered_json::object(),
         scene_file)["pvs"] = {{"uri", uri_of(relative)}};
  const std::string& before = scene_file.file.json;
  const bool has_lines = before.find('\n') < before.find_last_not_of(" \t\r\n");
  const std::string text = document.dump(has_lines ? 2 : -1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

}  // namespace

std::optional<embedded_pvs> read_embedded(const std::filesystem::path& path) {
  const container scene_file(path);
  const json document = scene_file.document();
  const json_object root(document, "", scene_file.source.name);
  const json* place = root.raw("extras");
  for (const char* key : {"sightcell", "pvs"})
    place = place != nullptr && place->is_object() && place->contains(key) ? &(*place)[key] : nullptr;
  if (place == nullptr) return std::nullopt;
  const json_object named(*place, "extras.sightcell.pvs", scene_file.source.name);
  embedded_pvs found;
  if (const auto uri = named.text("uri")) {
    const std::vector<std::uint8_t> bytes = read_resource(scene_file.source, *uri, named.where(), std::nullopt);
    const auto* first = reinterpret_cast<const std::byte*>(bytes.data());
    found.uri = *uri;
    found.bytes.assign(first, first + bytes.size());
    return found;
  }
  const std::vector<json_object> views = root.objects("bufferViews");
  found.buffer_view = named.required_index("bufferView", "bufferViews", views.size());
  const json_object& view = views[found.buffer_view];
  const std::size_t available = scene_file.file.binary ? scene_file.file.binary->size() : 0;
  const std::uint64_t offset = view.number("byteOffset", longest_glb).value_or(0);
  const std::uint64_t length = view.required_number("byteLength", longest_glb);
  if (view.required_number("buffer", longest_glb) != 0 || offset > available || length > available - offset)
    view.fail("scene.buffer-size", "has the .pvs file, but is not within the .glb", "bake again with --embed");
  const auto* first = reinterpret_cast<const std::byte*>(scene_file.file.binary->data()) + offset;
  found.bytes.assign(first, first + length);
  return found;
}

std::vector<std::byte> with_embedded(const std::filesystem::path& path, std::span<const std::byte> pvs,
                                     const std::filesystem::path& pvs_file, const std::filesystem::path& output) {
  const container scene_file(path);
  if (folder_of_file(path) != folder_of_file(output) && !named_files(path).empty())
    refuse(scene_file.source.name, "embed.outside-folder",
           "names other files, which " + printable(output.string(), 1000) + " would not find",
           "write it beside the scene");
  return scene_file.is_glb ? glb_with(scene_file, pvs) : gltf_with(scene_file, pvs_file, output);
}

}  // namespace sightcell::scene
