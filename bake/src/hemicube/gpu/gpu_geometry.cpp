#include "hemicube/gpu/gpu_geometry.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <utility>

#include "shared/hemicube_layout.h"

namespace sightcell::bake {
namespace {

// Maximum number of polygons per cluster. Smaller clusters are culled more tightly but need more commands.
constexpr std::size_t cluster_size = shaders::hemicube_cluster_size;

struct placed_polygon {
  glm::vec3 center;
  std::uint32_t id;
};

glm::vec3 corner(const scene::world_geometry& world, std::uint32_t id, std::uint32_t k) {
  return world.positions[world.indices[3 * std::size_t{id} + k]];
}

polygon_class class_of(scene::polygon_kind kind) {
  const polygon_class single = kind.alpha_tested
                                   ? (kind.occludes() ? masked_single_sided : see_through_masked_single_sided)
                               : kind.occludes() ? opaque_single_sided
                                                 : see_through_single_sided;
  return static_cast<polygon_class>(single + (kind.double_sided ? 1 : 0));
}

// Splits the polygons at the median of the longest side of their centers' box until the parts are small enough; calls
// leaf(first, last) in a fixed order. Ids break ties, so the result depends on the scene alone.
template <class Leaf>
void split_in_space(std::vector<placed_polygon>& polygons, const Leaf& leaf) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, polygons.size()}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    if (last - first <= cluster_size) {
      if (first != last) leaf(first, last);
      continue;
    }
    glm::vec3 low = polygons[first].center, high = low;
    for (std::size_t i = first; i < last; ++i) {
      low = glm::min(low, polygons[i].center);
      high = glm::max(high, polygons[i].center);
    }
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = first + (last - first) / 2;
    const auto at = [&](std::size_t i) { return polygons.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(middle), at(last), [axis](const placed_polygon& a, const placed_polygon& b) {
      return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.id < b.id;
    });
    open.emplace_back(middle, last);
    open.emplace_back(first, middle);
  }
}

struct device_vertex {
  glm::vec3 position;
  std::uint32_t source_id;  // of the polygon whose last corner this is, or no_index
};
static_assert(sizeof(device_vertex) == 16);

// Further attributes of the corners of masked polygons.
struct mask_vertex {
  glm::vec2 uv;
  std::uint32_t mask;
  float alpha;
};
static_assert(sizeof(mask_vertex) == 16);

// Collects the corners of polygons. Equal positions become one vertex, numbered in order of first use, except that no
// two polygons have the same last vertex.
class vertex_welder {
 public:
  explicit vertex_welder(std::size_t expected) : slots_(std::bit_ceil(expected * 2 + 16), scene::no_index) {}

  // Returns the three indices of a polygon, rotated so that the last vertex carries the id. Keeps the winding.
  std::array<std::uint32_t, 3> add(std::uint32_t source_id, const std::array<glm::vec3, 3>& corners) {
    std::array<std::uint32_t, 3> v{};
    for (std::size_t k = 0; k < 3; ++k) v[k] = number_of(corners[k]);
    for (std::size_t k = 0; k < 3; ++k) {
      if (vertices_[v[k]].source_id != scene::no_index) continue;
      vertices_[v[k]].source_id = source_id;
      return {v[(k + 1) % 3], v[(k + 2) % 3], v[k]};
    }
    vertices_.push_back({vertices_[v[2]].position, source_id});
    return {v[0], v[1], static_cast<std::uint32_t>(vertices_.size() - 1)};
  }
  // The same with three new vertices of consecutive numbers.
  std::array<std::uint32_t, 3> add_apart(std::uint32_t source_id, const std::array<glm::vec3, 3>& corners) {
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    for (const glm::vec3& p : corners) vertices_.push_back({p, source_id});
    return {first, first + 1, first + 2};
  }
  const std::vector<device_vertex>& vertices() const { return vertices_; }

 private:
  std::uint32_t number_of(glm::vec3 p) {
    p += 0.0f;  // -0 becomes +0
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t at = hash(p) & mask;; at = (at + 1) & mask) {
      if (slots_[at] == scene::no_index) {
        slots_[at] = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back({p, scene::no_index});
        return slots_[at];
      }
      if (vertices_[slots_[at]].position == p) return slots_[at];
    }
  }
  static std::size_t hash(glm::vec3 p) {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis) h = (h ^ std::bit_cast<std::uint32_t>(p[axis])) * 0x9E3779B97F4A7C15u;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
  std::vector<std::uint32_t> slots_;
  std::vector<device_vertex> vertices_;
};

}  // namespace

bool is_masked(polygon_class which) {
  return which == masked_single_sided || which == masked_double_sided || which == see_through_masked_single_sided ||
         which == see_through_masked_double_sided;
}

gpu_geometry::gpu_geometry(const scene::world_geometry& world)
    : polygon_count_(static_cast<std::uint32_t>(world.kinds.size())) {
  std::array<std::vector<placed_polygon>, polygon_class_count> by_class;
  for (std::uint32_t id = 0; id < polygon_count_; ++id) {
    // A non-occluder that is in every set need not be drawn.
    const scene::polygon_kind kind = world.kinds[id];
    if (kind.absent || (kind.always && !kind.occludes())) continue;
    const glm::vec3 center = (corner(world, id, 0) + corner(world, id, 1) + corner(world, id, 2)) / 3.0f;
    by_class[class_of(kind)].push_back({center, id});
  }

  for (std::uint32_t c = 0; c < polygon_class_count; ++c) {
    std::vector<placed_polygon>& polygons = by_class[c];
    clusters_of_class_[c].first = static_cast<std::uint32_t>(clusters_.size());
    split_in_space(polygons, [&](std::size_t first, std::size_t last) {
      cluster added{};
      added.first_polygon = static_cast<std::uint32_t>(source_ids_.size());
      added.polygon_count = static_cast<std::uint32_t>(last - first);
      glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
      for (std::size_t i = first; i < last; ++i) {
        source_ids_.push_back(polygons[i].id);
        for (std::uint32_t k = 0; k < 3; ++k) {
          low = glm::min(low, corner(world, polygons[i].id, k));
          high = glm::max(high, corner(world, polygons[i].id, k));
        }
      }
      // Halved before adding: the sum of two large numbers could overflow.
      added.center = low * 0.5f + high * 0.5f;
      added.extent = high * 0.5f - low * 0.5f;
      // Polygons that are adjacent in the file mostly share vertices.
      std::sort(source_ids_.begin() + added.first_polygon, source_ids_.end());
      clusters_.push_back(added);
    });
    clusters_of_class_[c].count = static_cast<std::uint32_t>(clusters_.size()) - clusters_of_class_[c].first;
    polygons = {};
  }
  upload(world);
}

void gpu_geometry::upload(const scene::world_geometry& world) {
  vertex_welder welder(world.positions.size());
  std::vector<mask_vertex> masked;
  std::vector<std::uint32_t> indices(3 * source_ids_.size());
  // Masked polygons first, so that their vertices come first. Indices stay in device order.
  for (const bool want_masked : {true, false}) {
    for (std::size_t i = 0; i < source_ids_.size(); ++i) {
      const std::uint32_t id = source_ids_[i];
      if (world.kinds[id].alpha_tested != want_masked) continue;
      const std::array<glm::vec3, 3> corners{corner(world, id, 0), corner(world, id, 1), corner(world, id, 2)};
      const auto numbers = want_masked ? welder.add_apart(id, corners) : welder.add(id, corners);
      std::copy(numbers.begin(), numbers.end(), indices.begin() + static_cast<std::ptrdiff_t>(3 * i));
      if (!want_masked) continue;
      const scene::masked_polygon& test = world.masked[scene::masked_index(world, id)];
      for (std::size_t k = 0; k < 3; ++k) masked.push_back({test.uvs[k], test.mask, test.alphas[k]});
    }
  }
  vertex_bytes_ = welder.vertices().size() * sizeof(device_vertex);
  vertices_.emplace(vertex_bytes_, welder.vertices().data());
  indices_.emplace(indices.size() * sizeof(std::uint32_t), indices.data());
  vertex_array_ = make_vertex_array(opaque_single_sided, indices_->id());
  if (!masked.empty()) {
    mask_vertices_.emplace(masked.size() * sizeof(mask_vertex), masked.data());
    upload_masks(world);
    masked_array_ = make_vertex_array(masked_single_sided, indices_->id());
  }
}

void gpu_geometry::upload_masks(const scene::world_geometry& world) {
  std::vector<shaders::hemicube_mask> masks;
  std::vector<std::uint8_t> texels;
  for (const scene::alpha_mask& mask : world.masks) {
    masks.push_back({static_cast<std::uint32_t>(texels.size()), mask.width, mask.height, mask.cutoff,
                     static_cast<std::uint32_t>(mask.wrap_u), static_cast<std::uint32_t>(mask.wrap_v), 0, 0});
    texels.insert(texels.end(), mask.texels.begin(), mask.texels.end());
  }
  static_assert(std::endian::native == std::endian::little, "the shader takes the lowest byte of a word first");
  texels.resize((texels.size() + 3) / 4 * 4);
  masks_.emplace(masks.size() * sizeof(shaders::hemicube_mask), masks.data());
  texels_.emplace(texels.size(), texels.data());
}

GLuint gpu_geometry::make_vertex_array(polygon_class which, GLuint indices) const {
  GLuint made = 0;
  glCreateVertexArrays(1, &made);
  glVertexArrayElementBuffer(made, indices);
  glVertexArrayVertexBuffer(made, 0, vertices_->id(), 0, sizeof(device_vertex));
  glVertexArrayAttribFormat(made, shaders::hemicube_attribute_position, 3, GL_FLOAT, GL_FALSE,
                            offsetof(device_vertex, position));
  glVertexArrayAttribIFormat(made, shaders::hemicube_attribute_source_id, 1, GL_UNSIGNED_INT,
                             offsetof(device_vertex, source_id));
  for (const GLuint attribute : {shaders::hemicube_attribute_position, shaders::hemicube_attribute_source_id}) {
    glEnableVertexArrayAttrib(made, attribute);
    glVertexArrayAttribBinding(made, attribute, 0);
  }
  if (is_masked(which) && mask_vertices_) add_mask_attributes(made);
  return made;
}

void gpu_geometry::add_mask_attributes(GLuint vertex_array) const {
  glVertexArrayVertexBuffer(vertex_array, 1, mask_vertices_->id(), 0, sizeof(mask_vertex));
  glVertexArrayAttribFormat(vertex_array, shaders::hemicube_attribute_uv, 2, GL_FLOAT, GL_FALSE,
                            offsetof(mask_vertex, uv));
  glVertexArrayAttribIFormat(vertex_array, shaders::hemicube_attribute_mask, 1, GL_UNSIGNED_INT,
                             offsetof(mask_vertex, mask));
  glVertexArrayAttribFormat(vertex_array, shaders::hemicube_attribute_alpha, 1, GL_FLOAT, GL_FALSE,
                            offsetof(mask_vertex, alpha));
  for (const GLuint attribute :
       {shaders::hemicube_attribute_uv, shaders::hemicube_attribute_mask, shaders::hemicube_attribute_alpha}) {
    glEnableVertexArrayAttrib(vertex_array, attribute);
    glVertexArrayAttribBinding(vertex_array, attribute, 1);
  }
}

gpu_geometry::~gpu_geometry() {
  glDeleteVertexArrays(1, &vertex_array_);
  glDeleteVertexArrays(1, &masked_array_);  // 0 is ignored
}

bool gpu_geometry::has(polygon_class single_sided, polygon_class double_sided) const {
  return clusters_of_class_[single_sided].count + clusters_of_class_[double_sided].count > 0;
}

bool gpu_geometry::has_see_through() const {
  return has(see_through_single_sided, see_through_double_sided) ||
         has(see_through_masked_single_sided, see_through_masked_double_sided);
}

std::uint32_t gpu_geometry::see_through_polygons() const {
  const std::uint32_t first = clusters_of_class_[see_through_single_sided].first;  // and all classes after it
  std::uint32_t sum = 0;
  for (std::size_t i = first; i < clusters_.size(); ++i) sum += clusters_[i].polygon_count;
  return sum;
}

std::vector<std::uint32_t> gpu_geometry::cluster_of_polygons() const {
  std::vector<std::uint32_t> found(polygon_count_, 0);
  for (std::size_t c = 0; c < clusters_.size(); ++c) {
    for (std::uint32_t i = 0; i < clusters_[c].polygon_count; ++i)
      found[source_ids_[clusters_[c].first_polygon + i]] = static_cast<std::uint32_t>(c);
  }
  return found;
}

void gpu_geometry::bind() const {
  glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
  if (!masks_) return;
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_masks, masks_->id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_texels, texels_->id());
}

void gpu_geometry::bind_vertices(polygon_class which) const {
  glBindVertexArray(is_masked(which) ? masked_array_ : vertex_array_);
}

}  // namespace sightcell::bake
