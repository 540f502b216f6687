#include "sightcell/scene/strip.h"

#include <algorithm>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "carried_materials.h"
#include "glb_bytes.h"
#include "gltf_accessors.h"
#include "gltf_attributes.h"
#include "gltf_file.h"
#include "import_scene.h"
#include "json_object.h"
#include "leftovers.h"
#include "rebuilt_buffers.h"
#include "sightcell/base/json_text.h"
#include "stripped_meshes.h"
#include "triangle_users.h"
#include "used_extensions.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

// Finds which triangles stay.
class triangle_choice {
 public:
  triangle_choice(const scene& s, const json_object& root, const accessor_table& table) : scene_(s), table_(table) {
    for (const json_object& mesh : root.objects("meshes")) {
      meshes_.push_back(mesh);
      primitives_.push_back(mesh.objects("primitives"));
    }
    whole_meshes_.resize(meshes_.size(), false);
    keep_meshes_of_nodes(root);
    keep_meshes_of_pointers(root);
  }

  kept_triangles choose(const std::vector<bool>& unwanted, std::vector<std::string>& warnings) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<bool>> all;
    std::map<std::pair<std::uint32_t, std::uint32_t>, const std::vector<std::uint32_t>*> clusters_of_primitive;
    for (const draw& d : scene_.draws) {
      clusters_of_primitive[{d.mesh, d.primitive}] = &scene_.geometries[d.geometry].clusters;
      std::vector<bool>& stays = all[{d.mesh, d.primitive}];
      stays.resize(d.polygon_count, false);
      for (std::uint32_t t = 0; t < d.polygon_count; ++t) stays[t] = stays[t] || !unwanted[d.first_source + t];
    }
    kept_triangles kept;
    for (const auto& [key, stays] : all) {
      if (std::find(stays.begin(), stays.end(), false) == stays.end() || is_whole(key.first, key.second)) continue;
      chosen_triangles& chosen = kept[key];
      chosen.count = static_cast<std::uint32_t>(stays.size());
      const std::vector<std::uint32_t>& clusters = *clusters_of_primitive.at(key);
      for (std::uint32_t t = 0; t < chosen.count; ++t) {
        if (!stays[t]) continue;
        chosen.order.push_back(t);
        if (!clusters.empty()) chosen.clusters.push_back(clusters[t]);
      }
    }
    for (const std::string& name : kept_for_)
      warnings.push_back("primitives with the extension " + printable(name) + " stay whole");
    return kept;
  }

 private:
  // A node that is in no draw is of another scene of the file, or has no instance. What it shows is unknown.
  void keep_meshes_of_nodes(const json_object& root) {
    std::set<std::uint32_t> drawn;
    for (const draw& d : scene_.draws) drawn.insert(d.node);
    const std::vector<json_object> nodes = root.objects("nodes");
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      const auto mesh = nodes[i].index("mesh", "meshes", meshes_.size());
      if (mesh && (!drawn.contains(i) || nodes[i].has("skin"))) whole_meshes_[*mesh] = true;
    }
  }

  void keep_meshes_of_pointers(const json_object& root) {
    for (const json_object& animation : root.objects("animations")) {
      for (const json_object& channel : animation.objects("channels")) {
        const auto target = channel.object("target");
        const auto extensions = target ? target->object("extensions") : std::nullopt;
        const auto pointer = extensions ? extensions->object("KHR_animation_pointer") : std::nullopt;
        if (!pointer || !pointer->has("pointer")) continue;
        const auto mesh = mesh_of_pointer(*pointer->raw("pointer"));
        if (mesh && mesh->first < whole_meshes_.size()) whole_meshes_[mesh->first] = true;
      }
    }
  }

  bool is_whole(std::uint32_t mesh, std::uint32_t number) {
    const json_object& primitive = primitives_[mesh][number];
    if (whole_meshes_[mesh] || primitive.has("targets")) return true;
    return refers_to_triangles(meshes_[mesh], primitive, table_, kept_for_);
  }

  const scene& scene_;
  const accessor_table& table_;
  std::vector<json_object> meshes_;
  std::vector<std::vector<json_object>> primitives_;
  std::vector<bool> whole_meshes_;
  std::set<std::string> kept_for_;  // extensions
};

}  // namespace

struct gltf_stripper::state {
  gltf_source source;
  json document;
  std::optional<json_object> root;
  std::optional<accessor_table> table;
  scene content;
  std::uint64_t file_bytes = 0;

  state(const std::filesystem::path& path, int scene_index) : source(source_of(path)) {
    try {
      const std::vector<std::uint8_t> bytes = read_scene_bytes(path);
      file_bytes = bytes.size();
      gltf_file file = split_gltf(bytes, source.name);
      content = import_gltf(file, source, printable(path.filename().string(), 1000), scene_index);
      document = parse_json(file.json);
      root.emplace(document, "", source.name);
      table.emplace(*root, source, std::move(file.binary));
    } catch (const std::bad_alloc&) {
      refuse_for_memory(source.name);
    }
  }

  // Returns the bytes of the source with all files that it names.
  std::uint64_t source_bytes(const carried_materials& materials) const {
    std::map<std::string, std::uint64_t> files;
    const auto add = [&files](const json_object& user, std::uint64_t bytes) {
      const auto uri = user.text("uri");
      if (uri && !uri->starts_with("data:")) files[*uri] = bytes;
    };
    for (const json_object& buffer : root->objects("buffers"))
      add(buffer, buffer.number("byteLength", std::uint64_t{1} << 40).value_or(0));
    const std::vector<json_object> images = root->objects("images");
    for (const auto& [number, image] : materials.images) add(images[number], image.size());
    return std::accumulate(files.begin(), files.end(), file_bytes,
                           [](std::uint64_t sum, const auto& file) { return sum + file.second; });
  }
};

gltf_stripper::gltf_stripper(const std::filesystem::path& path, int scene_index)
    : state_(std::make_unique<state>(path, scene_index)) {}

gltf_stripper::~gltf_stripper() = default;

const scene& gltf_stripper::content() const {
  return state_->content;
}

stripped_scene gltf_stripper::strip(const std::vector<bool>& unwanted, std::vector<std::string>& warnings) {
  const scene& s = state_->content;
  const kept_triangles kept = triangle_choice(s, *state_->root, *state_->table).choose(unwanted, warnings);
  json document = state_->document;
  drop_embedded_pvs(document);
  const added_accessors added = strip_meshes(document, *state_->root, *state_->table, kept);
  carried_materials materials =
      carry_materials(state_->document, *state_->root, state_->source, *state_->table, warnings);
  if (materials.sections.contains("images")) document["images"] = std::move(materials.sections["images"]);
  const rebuilt_buffers buffer(document, *state_->root, *state_->table, added, materials.images, state_->source.name);
  drop_extensions(document, used_extensions(state_->document));
  if (const auto meshes = document.find("meshes"); meshes != document.end() && meshes->empty()) document.erase(meshes);

  stripped_scene out;
  for (const draw& d : s.draws) {
    const auto found = kept.find({d.mesh, d.primitive});
    out.polygons += found == kept.end() ? d.polygon_count : static_cast<std::uint32_t>(found->second.order.size());
  }
  out.source_bytes = state_->source_bytes(materials);
  std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  const std::uint64_t size = glb_size(text, buffer.bytes());
  if (size > longest_glb)
    refuse(state_->source.name, "strip.too-large",
           "would be a .glb of " + std::to_string(size) + " bytes, and lengths in one have 32 bits",
           "export it in parts, and bake and strip each");
  out.glb = glb_with_room(std::move(text), buffer.bytes());
  buffer.write(std::span(out.glb).last(buffer.bytes()));
  return out;
}

}  // namespace sightcell::scene
