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

#include "sightcell/base/error.h"
#include "sightcell/scene/clusters.h"

namespace vulkan_host {
namespace {

namespace scene = sightcell::scene;
using sightcell::error;
using sightcell::error_kind;

void require(bool ok, const std::string& file) {
  if (!ok)
    throw error(error_kind::bad_input, "vulkan.runtime", file, "its tables cannot be read", "bake the scene again");
}

// ---- spheres ----

class bounds {
 public:
  void add(const glm::vec3& p) {
    min_ = glm::min(min_, p);
    max_ = glm::max(max_, p);
  }
  glm::vec3 center() const { return 0.5f * (min_ + max_); }
  glm::vec3 half() const { return min_.x > max_.x ? glm::vec3(0.0f) : 0.5f * (max_ - min_); }

 private:
  glm::vec3 min_{1e30f}, max_{-1e30f};
};

// A sphere in world space around a box in local space: around its corners, whatever the transform does.
glm::vec4 to_world(const glm::dmat4& m, const bounds& local) {
  const glm::dmat3 axes(m);
  const glm::dvec3 half(local.half());
  double radius = 0.0;
  for (const double y : {-1.0, 1.0}) {
    for (const double z : {-1.0, 1.0}) radius = std::max(radius, glm::length(axes * (half * glm::dvec3(1.0, y, z))));
  }
  return {glm::vec3(m * glm::dvec4(local.center(), 1.0)), static_cast<float>(radius)};
}

// ---- primitives ----

// Where a primitive is in the shared buffers, and its clusters.
struct placed_geometry {
  bool is_placed = false;
  std::int32_t vertex_offset = 0;
  std::uint32_t first_index = 0;  // in both index buffers
  bounds all;
  std::vector<std::uint32_t> cluster_of_triangle;  // by triangle of the file
  std::vector<bounds> cluster_bounds;
  std::vector<std::uint32_t> cluster_sizes;  // triangles
  std::span<const std::uint32_t> order;  // stored order: triangle of the file, + first_source of the draw that set it
  std::uint32_t order_base = 0;
};

void add_vertices(host_scene& out, const scene::geometry& g, placed_geometry& place) {
  place.vertex_offset = static_cast<std::int32_t>(out.vertices.size());
  for (std::size_t v = 0; v < g.positions.size(); ++v) {
    vertex& made = out.vertices.emplace_back(vertex{g.positions[v], {}, {255, 255, 255, 255}});
    if (!g.uvs.empty()) made.uv = g.uvs[v];
    if (!g.colors.empty()) made.tint = {g.colors[v].r, g.colors[v].g, g.colors[v].b, g.colors[v].a};
  }
}

// The host's own order: triangles by cluster. An engine has this from its own mesh builder.
void add_own_indices(host_scene& out, const scene::geometry& g, placed_geometry& place) {
  scene::mesh_clusters clusters = scene::clusters_of(g);
  place.cluster_bounds.resize(clusters.count);
  place.cluster_sizes.resize(clusters.count);
  std::vector<std::uint32_t> triangles(clusters.of_triangle.size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  std::stable_sort(triangles.begin(), triangles.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return clusters.of_triangle[a] < clusters.of_triangle[b]; });
  for (const std::uint32_t t : triangles) {
    const std::uint32_t c = clusters.of_triangle[t];
    ++place.cluster_sizes[c];
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t index = g.indices[3 * std::size_t{t} + corner];
      out.own_indices.push_back(index);
      place.cluster_bounds[c].add(g.positions[index]);
      place.all.add(g.positions[index]);
    }
  }
  place.cluster_of_triangle = std::move(clusters.of_triangle);
}

placed_geometry place_geometry(host_scene& out, const scene::geometry& g) {
  placed_geometry place{.is_placed = true, .first_index = static_cast<std::uint32_t>(out.own_indices.size())};
  add_vertices(out, g, place);
  add_own_indices(out, g, place);
  out.stored_indices.resize(out.own_indices.size());
  return place;
}

// Puts the indices of a primitive into stored order, once. The order is that of all its instances: a file in which each
// has another one needs an index buffer per draw, which this host does not have.
void permute(host_scene& out, const scene::geometry& g, placed_geometry& place,
             std::span<const std::uint32_t> source_of_stored, std::uint32_t first_source, const std::string& file) {
  const bool is_first = place.order.empty();
  for (std::size_t i = 0; i < source_of_stored.size(); ++i) {
    const std::size_t triangle = source_of_stored[i] - first_source;
    if (3 * triangle >= g.indices.size())
      throw error(error_kind::bad_input, "vulkan.other-scene", file, "orders polygons across draws",
                  "name the scene and the file of one bake");
    if (!is_first && source_of_stored[i] - first_source != place.order[i] - place.order_base) {
      throw error(error_kind::bad_input, "vulkan.per-instance", file,
                  "orders the polygons of each instance by themselves, and instances share indices here",
                  "bake it with --order per-mesh");
    }
    std::copy_n(&g.indices[3 * triangle], 3, &out.stored_indices[place.first_index + 3 * i]);
  }
  place.order = source_of_stored;
  place.order_base = first_source;
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

const scene::draw& scene_draw_of(const scene::scene& s, const sightcell_draw& d, const std::string& file) {
  if (d.first_source < s.polygon_count) {
    const scene::draw& own = s.draws[scene::draw_of(s, d.first_source)];
    if (own.first_source == d.first_source && own.polygon_count == d.polygon_count) return own;
  }
  throw error(error_kind::bad_input, "vulkan.other-scene", file, "has a draw that the scene lacks",
              "name the scene and the file of one bake");
}

using bin_key = std::tuple<scene::alpha_mode, facing>;

bin_key key_of(const scene::draw& d, const scene::material& m) {
  const bool is_mirrored = glm::determinant(glm::dmat3(d.to_world)) < 0.0;
  return {m.alpha, m.double_sided ? facing::both : is_mirrored ? facing::mirrored : facing::front};
}

draw_record record_of(const scene::draw& d, const placed_geometry& place, std::uint32_t material) {
  draw_record out{.sphere = to_world(d.to_world, place.all),
                  .first_index = place.first_index,
                  .vertex_offset = place.vertex_offset,
                  .material = material};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) out.rows[row][column] = static_cast<float>(d.to_world[column][row]);
  }
  return out;
}

// Draws of one bin follow each other, and so do their clusters.
void sort_into_bins(host_scene& out, const std::vector<bin_key>& keys) {
  std::stable_sort(out.sorted_draws.begin(), out.sorted_draws.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  for (std::uint32_t i = 0; i < out.sorted_draws.size(); ++i) {
    const std::uint32_t d = out.sorted_draws[i];
    const auto [alpha, faces] = keys[d];
    if (out.bins.empty() || out.bins.back().alpha != alpha || out.bins.back().faces != faces)
      out.bins.push_back({.alpha = alpha, .faces = faces, .first_draw = i});
    ++out.bins.back().draw_count;
    out.draws[d].bin = static_cast<std::uint32_t>(out.bins.size() - 1);
  }
}

// Each instance has clusters of its own, since one instance may be visible and another not.
void add_clusters(host_scene& out, std::uint32_t draw, const scene::draw& of, const placed_geometry& place) {
  const auto first = static_cast<std::uint32_t>(out.clusters.size());
  std::uint32_t first_index = place.first_index;
  for (std::size_t c = 0; c < place.cluster_sizes.size(); ++c) {
    out.clusters.push_back({.sphere = to_world(of.to_world, place.cluster_bounds[c]),
                            .first_index = first_index,
                            .index_count = 3 * place.cluster_sizes[c],
                            .draw = draw});
    first_index += 3 * place.cluster_sizes[c];
  }
  for (std::uint32_t t = 0; t < of.polygon_count; ++t)
    out.cluster_of_source[of.first_source + t] = first + place.cluster_of_triangle[t];
}

}  // namespace

host_scene arrange(const scene::scene& s, const sightcell::db& db, const std::string& pvs_file) {
  const auto info = db.info();
  require(static_cast<bool>(info), pvs_file);
  if (db.polygon_count() != s.polygon_count || db.same_scene(s.fingerprint) != SIGHTCELL_OK) {
    throw error(error_kind::bad_input, "vulkan.other-scene", pvs_file, "was baked from another scene than " + s.name,
                "name the scene and the file of one bake");
  }
  if (info->layout != 0) {
    throw error(error_kind::bad_input, "vulkan.layout", pvs_file, "is for a host that has merged its scene",
                "bake it without --layout merged");
  }
  std::vector<sightcell_draw> table(info->draw_count);
  std::vector<std::uint32_t> source_of_stored(db.polygon_count());
  require(db.draws(table) && db.order(source_of_stored), pvs_file);

  host_scene out;
  out.cluster_of_source.assign(s.polygon_count, SIGHTCELL_NO_CLUSTER);
  out.draws.resize(table.size());
  out.whole_draws.resize(table.size());
  const material_table materials(out, s);
  std::vector<placed_geometry> places(s.geometries.size());
  std::vector<const scene::draw*> scene_draws(table.size(), nullptr);
  std::vector<bin_key> keys(table.size());
  bounds all;
  // The draw table is not in the order of the scene: each draw is looked up by its first polygon.
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    if (table[i].polygon_count == 0) continue;
    const scene::draw& d = *(scene_draws[i] = &scene_draw_of(s, table[i], pvs_file));
    const scene::geometry& g = s.geometries[d.geometry];
    placed_geometry& place = places[d.geometry];
    if (!place.is_placed) place = place_geometry(out, g);
    permute(out, g, place, std::span(source_of_stored).subspan(table[i].first_stored, d.polygon_count), d.first_source,
            pvs_file);
    out.draws[i] = record_of(d, place, materials.number_of(d));
    out.whole_draws[i] = {place.first_index, 3 * d.polygon_count};
    keys[i] = key_of(d, materials.of(d));
    if (!is_drawn(d)) continue;
    out.sorted_draws.push_back(i);
    all.add(glm::vec3(out.draws[i].sphere) - out.draws[i].sphere.w);
    all.add(glm::vec3(out.draws[i].sphere) + out.draws[i].sphere.w);
  }
  out.size = 2.0f * glm::length(all.half());
  sort_into_bins(out, keys);
  for (bin& b : out.bins) {
    b.first_cluster = static_cast<std::uint32_t>(out.clusters.size());
    for (const std::uint32_t d : std::span(out.sorted_draws).subspan(b.first_draw, b.draw_count))
      add_clusters(out, d, *scene_draws[d], places[scene_draws[d]->geometry]);
    b.cluster_count = static_cast<std::uint32_t>(out.clusters.size()) - b.first_cluster;
  }
  return out;
}

}  // namespace vulkan_host
