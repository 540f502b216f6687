#include "engine_scene.h"

#include <algorithm>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <tuple>

namespace engine_hook {
namespace {

namespace scene = sightcell::scene;
using sightcell::error;
using sightcell::error_kind;

error other_scene(const std::string& file, const std::string& cause) {
  return error(error_kind::bad_input, "hook.other-scene", file, cause, "name the scene and the files of one bake");
}

void require(bool ok, const std::string& file) {
  if (ok) return;
  throw error(error_kind::bad_input, "hook.runtime", file, "its tables cannot be read", "bake the scene again");
}

std::vector<sightcell_draw> draw_table(const sightcell::db& db, const std::string& file) {
  const auto info = db.info();
  require(static_cast<bool>(info), file);
  std::vector<sightcell_draw> draws(info->draw_count);
  require(static_cast<bool>(db.draws(draws)), file);
  return draws;
}

// The scene's number of a draw of the file.
std::uint32_t scene_draw_of(const scene::scene& s, const sightcell_draw& d, const std::string& file) {
  if (d.first_source < s.polygon_count) {
    const std::uint32_t number = scene::draw_of(s, d.first_source);
    const scene::draw& own = s.draws[number];
    if (own.first_source == d.first_source && own.polygon_count == d.polygon_count) return number;
  }
  throw other_scene(file, "has a draw that the scene lacks");
}

bool drawn_here(const scene::draw& d) {
  return !d.tags.dynamic && !d.tags.never && (d.lod_object == scene::no_index || d.lod_level == 0);
}

}  // namespace

// ---- instanced ----

engine_scene::engine_scene(const scene::scene& s, const sightcell::db& db, const std::string& pvs_file)
    : scene_(s), merged_(false), textures_(s), batch_of_draw_(s.draws.size()) {
  // Of one primitive there are several geometries where the file poses them: skins, morph targets.
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> batch_of_primitive;
  for (std::size_t i = 0; i < s.draws.size(); ++i) {
    const scene::draw& d = s.draws[i];
    const auto [found, is_new] = batch_of_primitive.try_emplace({d.mesh, d.primitive, d.geometry}, batches_.size());
    batch_of_draw_[i] = found->second;
    if (!is_new) continue;
    const scene::geometry& g = s.geometries[d.geometry];
    gl_buffer& vertices = buffers_.emplace_back();
    vertices.upload(std::span<const glm::vec3>(g.positions));
    add_batch(g, d.material, vertices.id(), buffers_.emplace_back().id());
  }
  follow(db, pvs_file);
}

// All that depends on the file. The index buffer of each primitive gets its polygons in stored order, once: then a
// range of the runtime is a piece of it.
void engine_scene::follow(const sightcell::db& db, const std::string& pvs_file) {
  std::vector<std::uint32_t> source_of_stored(db.polygon_count());
  require(static_cast<bool>(db.order(source_of_stored)), pvs_file);
  const std::vector<sightcell_draw> draws = draw_table(db, pvs_file);
  units_.assign(draws.size(), {});
  stored_indices_.resize(3 * source_of_stored.size());
  std::vector<const scene::draw*> draw_of_unit(draws.size(), nullptr);
  std::vector<std::span<const std::uint32_t>> in_batch(batches_.size());
  for (std::size_t i = 0; i < draws.size(); ++i) {
    if (draws[i].polygon_count == 0) continue;
    const std::uint32_t number = scene_draw_of(scene_, draws[i], pvs_file);
    const scene::draw& d = scene_.draws[number];
    const std::vector<std::uint32_t>& own = scene_.geometries[d.geometry].indices;
    const std::uint32_t first = draws[i].first_stored, count = draws[i].polygon_count;
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::size_t polygon = source_of_stored[first + k] - d.first_source;  // of its primitive
      if (polygon >= count) throw other_scene(pvs_file, "orders polygons across draws");
      std::copy_n(&own[3 * polygon], 3, &stored_indices_[3 * std::size_t{first + k}]);
    }
    units_[i] = {batch_of_draw_[number], 0, 3 * count, drawn_here(d)};
    draw_of_unit[i] = &d;
    // All instances of a primitive are ordered alike, so its index buffer is that of any of them.
    const auto here = std::span(stored_indices_).subspan(3 * std::size_t{first}, 3 * std::size_t{count});
    std::span<const std::uint32_t>& shared = in_batch[units_[i].batch];
    if (!shared.empty() && !std::equal(shared.begin(), shared.end(), here.begin(), here.end())) {
      throw error(error_kind::bad_input, "hook.per-instance", pvs_file,
                  "orders the polygons of each instance by themselves, and index buffers here are shared",
                  "bake it with --order per-mesh");
    }
    shared = here;
  }
  for (std::size_t b = 0; b < batches_.size(); ++b) {
    glNamedBufferData(batches_[b].indices, static_cast<GLsizeiptr>(in_batch[b].size_bytes()), in_batch[b].data(),
                      GL_STATIC_DRAW);
  }
  fill_instances(draw_of_unit);
}

// ---- merged ----

engine_scene::engine_scene(const scene::scene& packed, const sightcell::db& db, const std::string& packed_file,
                           const std::string& pvs_file)
    : scene_(packed), merged_(true), textures_(packed) {
  if (packed.polygon_count != db.polygon_count()) throw other_scene(packed_file, "was not packed with " + pvs_file);
  for (const sightcell_draw& d : draw_table(db, pvs_file)) {
    if (d.group >= units_.size()) units_.resize(d.group + 1);
    unit& group = units_[d.group];
    group.first_index = 3 * d.first_stored;
    group.index_count += 3 * d.polygon_count;
  }
  // Node n of the packed mesh is draw group n. All primitives have the same vertices, and their indices are pieces of
  // one list; scene::load_gltf gives each a copy, where an engine's own loader would read each accessor once.
  gl_buffer& vertices = buffers_.emplace_back();
  gl_buffer& indices = buffers_.emplace_back();
  if (!packed.geometries.empty()) vertices.upload(std::span<const glm::vec3>(packed.geometries[0].positions));
  stored_indices_.resize(3 * std::size_t{packed.polygon_count});
  std::vector<const scene::draw*> draw_of_unit(units_.size(), nullptr);
  for (const scene::draw& d : packed.draws) {
    if (d.node >= units_.size() || units_[d.node].index_count != 3 * d.polygon_count) {
      throw other_scene(packed_file, "was not packed with " + pvs_file);
    }
    unit& group = units_[d.node];
    const scene::geometry& g = packed.geometries[d.geometry];
    std::copy(g.indices.begin(), g.indices.end(), stored_indices_.begin() + group.first_index);
    group.batch = static_cast<std::uint32_t>(batches_.size());
    group.drawn = drawn_here(d);
    draw_of_unit[d.node] = &d;
    add_batch(g, d.material, vertices.id(), indices.id());
  }
  indices.upload(stored_indices());
  fill_instances(draw_of_unit);
}

// ---- both ----

void engine_scene::add_batch(const scene::geometry& g, std::uint32_t material, GLuint vertices, GLuint indices) {
  const scene::material standard;
  const scene::material& m = material < scene_.materials.size() ? scene_.materials[material] : standard;
  batch b{vertices,
          indices,
          0,
          textures_.of_material(m),
          m.base_color.a,
          0.0f,
          m.double_sided,
          m.alpha == scene::alpha_mode::blend};
  if (m.alpha == scene::alpha_mode::mask && !m.alpha_unknown) {
    b.alpha_cutoff = m.alpha_cutoff;
    std::vector<glm::vec2> uvs = g.uvs;
    uvs.resize(g.positions.size(), glm::vec2(0.0f));
    gl_buffer& buffer = buffers_.emplace_back();
    buffer.upload(std::span<const glm::vec2>(uvs));
    b.uvs = buffer.id();
  }
  batches_.push_back(b);
}

void engine_scene::fill_instances(const std::vector<const scene::draw*>& draw_of_unit) {
  std::vector<instance_data> data(std::max<std::size_t>(draw_of_unit.size(), 1));
  for (std::uint32_t u = 0; u < draw_of_unit.size(); ++u) {
    const glm::dmat4 to_world = draw_of_unit[u] != nullptr ? draw_of_unit[u]->to_world : glm::dmat4(1.0);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column)
        data[u].to_world[4 * row + column] = static_cast<float>(to_world[column][row]);
    }
    data[u].mirrored = glm::determinant(glm::dmat3(to_world)) < 0.0 ? 1 : 0;
    data[u].unit = u;
  }
  instances_.upload(std::span<const instance_data>(data));
}

}  // namespace engine_hook
