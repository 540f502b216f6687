#include "host_scene.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "cluster_bounds.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/clusters.h"
#include "sightcell/sightcell.hpp"

namespace gpu_driven {
namespace {

namespace scene = sightcell::scene;

// ---- primitives ----

// Where a primitive is in the shared buffers, and its clusters.
struct placed_geometry {
  bool is_placed = false;
  std::int32_t base_vertex = 0;
  std::uint32_t first_index = 0;
  std::vector<std::uint32_t> cluster_of_triangle{};  // by triangle of the file
  std::vector<std::uint32_t> cluster_sizes{};        // triangles
  const primitive_levels* levels = nullptr;          // their indices follow those of the clusters
};

void add_vertices(host_scene& out, const scene::geometry& g) {
  for (std::size_t v = 0; v < g.positions.size(); ++v) {
    vertex& made = out.vertices.emplace_back(vertex{g.positions[v], {}, {255, 255, 255, 255}});
    if (!g.uvs.empty()) made.uv = g.uvs[v];
    if (!g.colors.empty()) made.tint = {g.colors[v].r, g.colors[v].g, g.colors[v].b, g.colors[v].a};
  }
}

// The host's own order: triangles by cluster. An engine has this from its own mesh builder.
placed_geometry place_geometry(host_scene& out, const scene::geometry& g, const primitive_levels* levels) {
  placed_geometry place{.is_placed = true,
                        .base_vertex = static_cast<std::int32_t>(out.vertices.size()),
                        .first_index = static_cast<std::uint32_t>(out.indices.size())};
  add_vertices(out, g);
  scene::mesh_clusters clusters = scene::clusters_of(g);
  place.cluster_sizes.resize(clusters.count);
  std::vector<std::uint32_t> triangles(clusters.of_triangle.size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  std::stable_sort(triangles.begin(), triangles.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return clusters.of_triangle[a] < clusters.of_triangle[b]; });
  for (const std::uint32_t t : triangles) {
    ++place.cluster_sizes[clusters.of_triangle[t]];
    out.indices.insert(out.indices.end(), &g.indices[3 * std::size_t{t}], &g.indices[3 * std::size_t{t}] + 3);
  }
  place.cluster_of_triangle = std::move(clusters.of_triangle);
  if (levels == nullptr) return place;
  if (levels->leaves != place.cluster_sizes.size() ||
      std::any_of(levels->coarse_indices.begin(), levels->coarse_indices.end(),
                  [&](std::uint32_t vertex) { return vertex >= g.positions.size(); })) {
    throw sightcell::error(sightcell::error_kind::bad_input, "gpu-driven.levels", "the table of meshlets",
                           "is of other meshes than those of the scene", "pack the scene again");
  }
  place.levels = levels;
  out.indices.insert(out.indices.end(), levels->coarse_indices.begin(), levels->coarse_indices.end());
  return place;
}

// ---- materials ----

class material_table {
 public:
  material_table(host_scene& out, const scene::scene& s) : out_(out), scene_(s) {
    out_.textures.push_back(scene::no_index);
    for (const scene::material& m : s.materials) add(m);
    add(scene::material{});  // glTF's default material
  }

  const scene::material& of(const scene::draw& d) const {
    return d.material < scene_.materials.size() ? scene_.materials[d.material] : standard_;
  }
  std::uint32_t number_of(const scene::draw& d) const {
    return std::min<std::uint32_t>(d.material, static_cast<std::uint32_t>(scene_.materials.size()));
  }

 private:
  void add(const scene::material& m) {
    material_record record{.base_color = m.base_color};
    if (m.alpha == scene::alpha_mode::mask && !m.alpha_unknown) record.alpha_cutoff = m.alpha_cutoff;
    if (m.base_color_image != scene::no_index) {
      const auto [found, is_new] =
          layer_.try_emplace(m.base_color_image, static_cast<std::uint32_t>(out_.textures.size()));
      if (is_new) out_.textures.push_back(m.base_color_image);
      record.base_texture = found->second;
      record.wrap_u = static_cast<std::uint32_t>(m.wrap_u);
      record.wrap_v = static_cast<std::uint32_t>(m.wrap_v);
    }
    out_.materials.push_back(record);
  }

  host_scene& out_;
  const scene::scene& scene_;
  const scene::material standard_;
  std::map<std::uint32_t, std::uint32_t> layer_;  // of an image
};

// ---- draws ----

// What moves by itself, is hidden, or is a coarser level of detail is drawn by other parts of an engine.
bool is_drawn(const scene::draw& d) {
  return d.polygon_count > 0 && !d.tags.dynamic && !d.tags.never &&
         (d.lod_object == scene::no_index || d.lod_level == 0);
}

using bin_key = std::tuple<scene::alpha_mode, facing>;

bin_key key_of(const scene::draw& d, const scene::material& m) {
  const bool is_mirrored = glm::determinant(glm::dmat3(d.to_world)) < 0.0;
  return {m.alpha, m.double_sided ? facing::both : is_mirrored ? facing::mirrored : facing::front};
}

instance_record instance_of(const scene::draw& d, std::uint32_t cluster, std::uint32_t material) {
  instance_record out{.rows = {}, .cluster = cluster, .material = material};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) out.rows[row][column] = static_cast<float>(d.to_world[column][row]);
  }
  return out;
}

struct placed_draw {
  const scene::draw& source;
  const std::vector<glm::vec3>& positions;
  std::int32_t base_vertex = 0;
  std::uint32_t material = 0;
};

void add_cluster(host_scene& out, const placed_draw& d, std::uint32_t first_index, std::uint32_t triangles,
                 const level_links& levels) {
  cluster_record made{.first_index = first_index,
                      .index_count = 3 * triangles,
                      .base_vertex = d.base_vertex,
                      .bin = static_cast<std::uint32_t>(out.bins.size() - 1),
                      .is_blended = out.bins.back().is_blended() ? 1u : 0u,
                      .made_by = levels.made_by,
                      .member_of = levels.member_of};
  set_bounds(made, d.positions, std::span(out.indices).subspan(first_index, made.index_count), d.source.to_world,
             out.bins.back().faces == facing::both);
  out.instances.push_back(instance_of(d.source, static_cast<std::uint32_t>(out.clusters.size()), d.material));
  out.clusters.push_back(made);
  ++out.bins.back().cluster_count;
}

// Each instance has clusters of its own, since one instance may be visible and another not.
void add_clusters(host_scene& out, const placed_draw& d, const placed_geometry& place) {
  const auto first = static_cast<std::uint32_t>(out.clusters.size());
  const auto first_group = static_cast<std::uint32_t>(out.level_groups.size());
  const primitive_levels* const levels = place.levels;
  const auto links = [&](std::size_t c) {
    if (levels == nullptr) return level_links{};
    const auto placed = [&](std::uint32_t group) { return group == no_level_group ? group : first_group + group; };
    return level_links{placed(levels->links[c].made_by), placed(levels->links[c].member_of)};
  };
  std::uint32_t first_index = place.first_index;
  for (std::size_t c = 0; c < place.cluster_sizes.size(); ++c) {
    add_cluster(out, d, first_index, place.cluster_sizes[c], links(c));
    first_index += 3 * place.cluster_sizes[c];
  }
  for (std::uint32_t t = 0; t < d.source.polygon_count; ++t)
    out.cluster_of_source[d.source.first_source + t] = first + place.cluster_of_triangle[t];
  out.triangles += d.source.polygon_count;
  ++out.draws;
  if (levels == nullptr) return;
  for (std::size_t c = 0; c < levels->coarse_triangles.size(); ++c) {
    add_cluster(out, d, first_index, levels->coarse_triangles[c], links(levels->leaves + c));
    first_index += 3 * levels->coarse_triangles[c];
  }
  out.coarse_clusters += static_cast<std::uint32_t>(levels->coarse_triangles.size());
  const double scale = greatest_scale(d.source.to_world);
  for (const level_group& group : levels->groups) {
    const glm::dvec4 center = d.source.to_world * glm::dvec4(group.x, group.y, group.z, 1.0);
    out.level_groups.push_back({.sphere = glm::vec4(center.x, center.y, center.z, scale * group.radius),
                                .error = static_cast<float>(scale * group.error)});
  }
}

float size_of(const std::vector<cluster_record>& clusters) {
  glm::vec3 low(1e30f), high(-1e30f);
  for (const cluster_record& c : clusters) {
    low = glm::min(low, c.min);
    high = glm::max(high, c.max);
  }
  return clusters.empty() ? 1.0f : glm::length(high - low);
}

}  // namespace

host_scene arrange(const scene::scene& s, const level_table& levels) {
  host_scene out;
  out.cluster_of_source.assign(s.polygon_count, SIGHTCELL_NO_CLUSTER);
  const material_table materials(out, s);
  std::vector<const scene::draw*> sorted;
  for (const scene::draw& d : s.draws) {
    if (is_drawn(d)) sorted.push_back(&d);
  }
  const auto key = [&](const scene::draw* d) { return key_of(*d, materials.of(*d)); };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const scene::draw* a, const scene::draw* b) { return key(a) < key(b); });
  // By geometry, and with levels by primitive: another one with the same geometry can have none.
  std::map<std::pair<std::uint32_t, const primitive_levels*>, placed_geometry> places;
  for (const scene::draw* d : sorted) {
    const auto [alpha, faces] = key(d);
    if (out.bins.empty() || out.bins.back().alpha != alpha || out.bins.back().faces != faces)
      out.bins.push_back(
          {.alpha = alpha, .faces = faces, .first_cluster = static_cast<std::uint32_t>(out.clusters.size())});
    const auto found = levels.find({d->mesh, d->primitive});
    const primitive_levels* const own_levels = found == levels.end() ? nullptr : &found->second;
    const scene::geometry& g = s.geometries[d->geometry];
    placed_geometry& place = places[{d->geometry, own_levels}];
    if (!place.is_placed) place = place_geometry(out, g, own_levels);
    add_clusters(out, {*d, g.positions, place.base_vertex, materials.number_of(*d)}, place);
  }
  out.size = size_of(out.clusters);
  return out;
}

}  // namespace gpu_driven
