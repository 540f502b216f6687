#include "sightcell/scene/meshlets.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "carried_materials.h"
#include "glb_bytes.h"
#include "leftovers.h"
#include "meshlet_levels.h"
#include "meshlet_table.h"
#include "opened_gltf.h"
#include "rebuilt_buffers.h"
#include "sightcell/base/json_text.h"
#include "sightcell/scene/clusters.h"
#include "stripped_meshes.h"
#include "triangle_users.h"
#include "used_extensions.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

struct chosen_meshlets {
  kept_triangles triangles;
  std::vector<meshlet_group> groups;
};

// Puts the triangles of a primitive in the order of their clusters.
chosen_triangles order_by_cluster(const mesh_clusters& clusters) {
  chosen_triangles chosen;
  chosen.count = static_cast<std::uint32_t>(clusters.of_triangle.size());
  chosen.order.resize(chosen.count);
  std::iota(chosen.order.begin(), chosen.order.end(), 0u);
  std::stable_sort(chosen.order.begin(), chosen.order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return clusters.of_triangle[a] < clusters.of_triangle[b]; });
  for (const std::uint32_t triangle : chosen.order) chosen.clusters.push_back(clusters.of_triangle[triangle]);
  return chosen;
}

class meshlet_choice {
 public:
  meshlet_choice(const scene& s, const json_object& root, const accessor_table& table) : scene_(s), table_(table) {
    for (const json_object& mesh : root.objects("meshes")) {
      meshes_.push_back(mesh);
      primitives_.push_back(mesh.objects("primitives"));
    }
  }

  chosen_meshlets choose(const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                         std::vector<std::string>& warnings) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> geometries;  // of their first draws
    for (const draw& d : scene_.draws)
      if (d.polygon_count > 0) geometries.try_emplace({d.mesh, d.primitive}, d.geometry);
    std::uint64_t total = 0, done = 0;
    for (const auto& [key, number] : geometries) total += scene_.geometries[number].indices.size() / 3;
    chosen_meshlets out;
    for (const auto& [key, number] : geometries) {
      const geometry& g = scene_.geometries[number];
      add(key, g, out);
      done += g.indices.size() / 3;
      if (progress) progress(done, total);
    }
    for (const std::string& name : kept_for_)
      warnings.push_back("primitives with the extension " + printable(name) + " have no meshlets");
    return out;
  }

 private:
  void add(std::pair<std::uint32_t, std::uint32_t> key, const geometry& g, chosen_meshlets& out) {
    const json_object& primitive = primitives_[key.first][key.second];
    if (refers_to_triangles(meshes_[key.first], primitive, table_, kept_for_)) return;
    const mesh_clusters clusters = clusters_of(g);
    meshlet_group group{.mesh = key.first, .primitive = key.second, .triangle_counts = {}};
    group.triangle_counts.resize(clusters.count, 0);
    for (const std::uint32_t cluster : clusters.of_triangle) ++group.triangle_counts[cluster];
    group.deforms = primitive.has("targets") || primitive.required_object("attributes").has("JOINTS_0");
    out.groups.push_back(std::move(group));
    out.triangles.emplace(key, order_by_cluster(clusters));
  }

  const scene& scene_;
  const accessor_table& table_;
  std::vector<json_object> meshes_;
  std::vector<std::vector<json_object>> primitives_;
  std::set<std::string> kept_for_;  // extensions
};

// A .glb with room for a table.
struct meshlet_file {
  std::vector<std::byte> glb;
  std::size_t room_offset = 0;  // in glb
};

// document: of the packed file, without the numbers of its new buffer.
meshlet_file lay_out(opened_gltf& file, json document, const added_accessors& added, const carried_images& images,
                     std::uint64_t room_bytes, std::uint32_t version) {
  const rebuilt_buffers buffer(document, *file.root, *file.table, added, images, file.source.name, room_bytes);
  drop_extensions(document, used_extensions(file.document));
  json& extras = document["extras"];
  if (!extras.is_object()) extras = json::object();
  json& marks = extras["sightcell"];
  if (!marks.is_object()) marks = json::object();
  marks["meshlets"] = {{"bufferView", buffer.room_view()}, {"version", version}};
  std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  const std::uint64_t size = glb_size(text, buffer.bytes());
  if (size > longest_glb)
    refuse(file.source.name, "pack.too-large",
           "would be a .glb of " + std::to_string(size) + " bytes, and lengths in one have 32 bits",
           "export it in parts, and pack each");
  meshlet_file out;
  out.glb = glb_with_room(std::move(text), buffer.bytes());
  buffer.write(std::span(out.glb).last(buffer.bytes()));
  out.room_offset = out.glb.size() - buffer.bytes() + buffer.room_offset();
  return out;
}

}  // namespace

struct gltf_meshlet_packer::state {
  opened_gltf file;
  int scene_index;
  state(const std::filesystem::path& path, int index) : file(path, index), scene_index(index) {}
};

gltf_meshlet_packer::gltf_meshlet_packer(const std::filesystem::path& path, int scene_index)
    : state_(std::make_unique<state>(path, scene_index)) {}

gltf_meshlet_packer::~gltf_meshlet_packer() = default;

const scene& gltf_meshlet_packer::content() const {
  return state_->file.content;
}

meshlet_scene gltf_meshlet_packer::pack(const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                                        std::vector<std::string>& warnings, bool with_levels) {
  opened_gltf& file = state_->file;
  const chosen_meshlets chosen = meshlet_choice(file.content, *file.root, *file.table).choose(progress, warnings);
  json document = file.document;
  drop_embedded_pvs(document);
  const added_accessors added = strip_meshes(document, *file.root, *file.table, chosen.triangles);
  carried_materials materials = carry_materials(file.document, *file.root, file.source, *file.table, warnings);
  if (materials.sections.contains("images")) document["images"] = std::move(materials.sections["images"]);
  std::uint64_t table_bytes = meshlet_table_bytes(chosen.groups);
  const std::uint32_t version = meshlet_table_version(with_levels);
  meshlet_file made = lay_out(file, document, added, materials.images, table_bytes, version);
  const scene packed = load_gltf(made.glb, file.source.name, {}, state_->scene_index);
  // Levels refer to the vertices of the packed file, and take room in it.
  std::optional<meshlet_levels> levels;
  meshlet_scene out;
  if (with_levels) {
    levels.emplace(chosen.groups, packed, progress);
    table_bytes += levels->bytes();
    made = lay_out(file, document, added, materials.images, table_bytes, version);
    out.coarse_meshlets = levels->coarse_meshlets();
  }
  write_meshlet_table(chosen.groups, packed, levels ? &*levels : nullptr,
                      std::span(made.glb).subspan(made.room_offset, table_bytes));
  out.glb = std::move(made.glb);

  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> counts;
  for (const meshlet_group& group : chosen.groups) {
    const auto count = static_cast<std::uint32_t>(group.triangle_counts.size());
    counts[{group.mesh, group.primitive}] = count;
    out.meshlets += count;
    out.triangles += std::accumulate(group.triangle_counts.begin(), group.triangle_counts.end(), std::uint64_t{0});
  }
  for (const draw& d : packed.draws)
    if (const auto found = counts.find({d.mesh, d.primitive}); found != counts.end())
      out.drawn_meshlets += found->second;
  out.primitives = static_cast<std::uint32_t>(chosen.groups.size());
  out.table_bytes = table_bytes;
  return out;
}

}  // namespace sightcell::scene
