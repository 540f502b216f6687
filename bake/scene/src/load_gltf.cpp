// Converts glTF to plain arrays. The only file that includes tinygltf.
#include <algorithm>
#include <cmath>
#include <fstream>  // tiny_gltf.h does not include it when its own file access is off
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <new>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "accessor.h"
#include "gltf_document.h"
#include "import_scene.h"
#include "joined_tree.h"
#include "json_object.h"
#include "lod_levels.h"
#include "marked_cells.h"
#include "node_transform.h"
#include "pose.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"
#include "triangle_modes.h"

// Files, buffers and images are read elsewhere, with checks. tinygltf gets text only.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

namespace sightcell::scene {
namespace {

constexpr std::uint64_t posed_vertex_limit = std::uint64_t{1} << 30;  // with each of their targets
constexpr std::size_t draw_limit = std::size_t{1} << 23;  // a small file can request very many draws of one triangle
// Very many primitives may refer to a few bytes of vertices, and each geometry has its own copy.
constexpr std::size_t vertex_limit = std::size_t{1} << 27;

tinygltf::Model parse(gltf_document& document, const std::string& name) {
  tinygltf::TinyGLTF reader;
  tinygltf::Model model;
  std::string problem;
  std::string warning;
  if (document.json.size() > std::numeric_limits<unsigned int>::max() ||
      !reader.LoadASCIIFromString(&model, &problem, &warning, document.json.data(),
                                  static_cast<unsigned int>(document.json.size()), "", tinygltf::NO_REQUIRE)) {
    refuse(name, "scene.bad-json", "tinygltf rejects it: " + printable(problem, 160), "export the file again");
  }
  document.json = std::string();
  return model;
}

constexpr double no_translation[] = {0, 0, 0};
constexpr double no_rotation[] = {0, 0, 0, 1};
constexpr double no_scale[] = {1, 1, 1};

glm::dmat4 local_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) {
    glm::dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    return m;
  }
  return from_trs(node.translation.size() == 3 ? node.translation.data() : no_translation,
                  node.rotation.size() == 4 ? node.rotation.data() : no_rotation,
                  node.scale.size() == 3 ? node.scale.data() : no_scale);
}

class importer {
 public:
  // poses, switches: may be null.
  importer(const tinygltf::Model& model, const gltf_document& document, const std::string& file, scene& out,
           pose_list* poses, std::vector<object_switches>* switches, bool outside)
      : model_(model),
        accessors_(document.accessors),
        coordinates_(document.coordinates),
        nodes_(document.nodes),
        lights_(document.lights),
        file_(file),
        out_(out),
        poses_(poses),
        switches_(switches),
        outside_(outside) {
    group_numbers_.resize(nodes_.groups.size(), no_index);
  }

  // Walks the nodes depth-first in array order, with its own stack: a chain of a million nodes must not overflow the
  // program's stack.
  void walk(const std::vector<int>& roots);

 private:
  // What a node inherits.
  struct from_above {
    glm::dmat4 to_world{1.0};
    node_marks marks;
    bool moves = false;
    lod_place lod;
  };

  // How a node changes the vertices of one of its primitives. Vertices of a skinned primitive are then in world
  // space.
  struct pose {
    int skin = -1;
    bool mirrored = false;        // with a skin: by its node, whose transform has no other effect
    std::vector<double> weights;  // of morph targets
    bool rests() const { return skin < 0 && weights.empty(); }
    auto operator<=>(const pose&) const = default;
  };

  void add_node(std::size_t node, const from_above& here);
  void add_start(std::size_t node, const glm::dmat4& to_world, bool marked);
  bool moves(std::size_t node, const from_above& here) const;
  draw_tags tags_of_node(std::size_t node, const from_above& here);
  void warn_of_movement();
  void check_draws(std::size_t more) const;
  std::vector<glm::dmat4> instance_transforms(const tinygltf::Node& node) const;
  std::optional<std::uint32_t> geometry_of(std::size_t mesh, std::size_t primitive, const pose& posed);
  pose pose_of(const tinygltf::Node& node, const tinygltf::Primitive& primitive, const from_above& here) const;
  void take_pose(geometry& g, const tinygltf::Primitive& primitive, const std::string& where, const pose& posed,
                 rest_pose* rest);
  const std::vector<glm::dmat4>& joint_matrices(int skin);
  const glm::dmat4& world_of(int node);
  void count_vertices(int positions);
  geometry read_geometry(const tinygltf::Primitive& primitive, const std::string& where) const;
  std::vector<std::uint32_t> read_clusters(int accessor, std::size_t triangles, const std::string& where) const;
  template <typename T>
  std::vector<T> numbers(int accessor) const;

  // Returns the first material with the same texture coordinates, so that materials that differ otherwise share their
  // geometry.
  int coordinates_of(int material) const;
  std::vector<glm::u8vec4> read_colors(int accessor) const;

  const tinygltf::Model& model_;
  const std::vector<accessor_view>& accessors_;
  const std::vector<texture_coordinates>& coordinates_;  // by material
  const node_list& nodes_;
  const light_list& lights_;
  std::vector<std::uint32_t> group_numbers_;  // in the scene, by number in nodes_; no_index: not used yet
  const std::string& file_;                   // for messages
  scene& out_;
  pose_list* poses_;
  std::vector<object_switches>* switches_;
  bool outside_;  // levels outside the tree are read too
  // Keys of shared geometries. Primitives that differ in material only share one: (positions, texture coordinates,
  // their transform, colors, indices, mode, clusters). Posed ones: mesh, primitive, pose.
  std::map<std::tuple<int, int, int, int, int, int, int>, std::uint32_t> geometries_;
  std::size_t vertices_ = 0;  // of all geometries
  std::map<std::tuple<std::size_t, std::size_t, pose>, std::uint32_t> posed_;
  std::uint64_t posed_vertices_ = 0;
  std::pair<int, std::vector<glm::dmat4>> joints_{-1, {}};  // of the skin requested last
  std::vector<int> parents_;                                // by node, in the scene or not; empty until needed
  std::vector<std::optional<glm::dmat4>> worlds_;           // likewise
};

template <typename T>
std::vector<T> importer::numbers(int accessor) const {
  std::vector<T> out;
  if (!read_numbers(accessors_[static_cast<std::size_t>(accessor)], out)) {
    refuse(file_, "scene.index-out-of-range",
           "accessors[" + std::to_string(accessor) + "] has a sparse index beyond its count", "export the file again");
  }
  return out;
}

geometry importer::read_geometry(const tinygltf::Primitive& primitive, const std::string& where) const {
  geometry out;
  const std::vector<float> positions = numbers<float>(primitive.attributes.at("POSITION"));
  out.positions.reserve(positions.size() / 3);
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    out.positions.emplace_back(positions[i], positions[i + 1], positions[i + 2]);
  }
  const auto uv = primitive.attributes.find("TEXCOORD_0");
  if (uv != primitive.attributes.end()) {
    const std::vector<float> values = numbers<float>(uv->second);
    out.uvs.reserve(values.size() / 2);
    const int with = coordinates_of(primitive.material);
    const texture_coordinates c = with < 0 ? texture_coordinates{} : coordinates_[static_cast<std::size_t>(with)];
    for (std::size_t i = 0; i + 1 < values.size(); i += 2)
      out.uvs.push_back(values[i] * c.across + values[i + 1] * c.down + c.offset);
  }
  const auto color = primitive.attributes.find("COLOR_0");
  if (color != primitive.attributes.end()) out.colors = read_colors(color->second);
  std::vector<std::uint32_t> corners;
  if (primitive.indices >= 0) {
    if (!read_indices(accessors_[static_cast<std::size_t>(primitive.indices)], corners)) {
      refuse(file_, "scene.index-out-of-range", where + " has a sparse index beyond its count",
             "export the file again");
    }
    const auto largest = std::max_element(corners.begin(), corners.end());
    if (largest != corners.end() && *largest >= out.positions.size()) {
      refuse(file_, "scene.index-out-of-range",
             where + " has index " + std::to_string(*largest) + " but " + std::to_string(out.positions.size()) +
                 " vertices",
             "export the file again");
    }
  } else {
    corners.resize(out.positions.size());
    std::iota(corners.begin(), corners.end(), 0u);
  }
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0) {
    out_.warnings.push_back(where + " has " + std::to_string(corners.size()) +
                            " corners, not whole triangles: the last ones are left out");
  }
  out.indices = to_triangles(std::move(corners), primitive.mode);
  const auto clusters = primitive.attributes.find(clusters_attribute);
  if (clusters != primitive.attributes.end())
    out.clusters = read_clusters(clusters->second, out.indices.size() / 3, where);
  return out;
}

std::vector<std::uint32_t> importer::read_clusters(int accessor, std::size_t triangles,
                                                   const std::string& where) const {
  std::vector<std::uint32_t> out;
  if (!read_indices(accessors_[static_cast<std::size_t>(accessor)], out)) {
    refuse(file_, "scene.index-out-of-range",
           "accessors[" + std::to_string(accessor) + "] has a sparse index beyond its count", "export the file again");
  }
  if (out.size() != triangles) {
    refuse(file_, "scene.bad-field",
           where + " has clusters for " + std::to_string(out.size()) + " triangles but " + std::to_string(triangles) +
               " triangles",
           "give the number of a cluster for each triangle");
  }
  return out;
}

int importer::coordinates_of(int material) const {
  if (material < 0) return -1;
  const texture_coordinates& wanted = coordinates_[static_cast<std::size_t>(material)];
  if (wanted == texture_coordinates{.set = wanted.set}) return -1;  // the set is in the accessor already
  return static_cast<int>(std::find(coordinates_.begin(), coordinates_.end(), wanted) - coordinates_.begin());
}

std::vector<glm::u8vec4> importer::read_colors(int accessor) const {
  const std::vector<float> values = numbers<float>(accessor);
  const std::size_t width = accessors_[static_cast<std::size_t>(accessor)].width;
  const auto byte = [](float v) {
    return static_cast<std::uint8_t>(std::lround((v > 0.0f ? std::min(v, 1.0f) : 0.0f) * 255.0f));
  };
  std::vector<glm::u8vec4> out(values.size() / width, glm::u8vec4(255));
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t k = 0; k < width; ++k) out[i][static_cast<int>(k)] = byte(values[i * width + k]);
  }
  return out;
}

importer::pose importer::pose_of(const tinygltf::Node& node, const tinygltf::Primitive& primitive,
                                 const from_above& here) const {
  pose out;
  const std::size_t targets = std::min(node.weights.size(), primitive.targets.size());
  for (std::size_t i = 0; i < targets; ++i)
    out.weights.push_back(primitive.targets[i].contains("POSITION") ? node.weights[i] : 0.0);
  while (!out.weights.empty() && out.weights.back() == 0.0) out.weights.pop_back();
  if (node.skin >= 0 && primitive.attributes.contains("JOINTS_0")) {
    out.skin = node.skin;
    out.mirrored = glm::determinant(glm::dmat3(here.to_world)) < 0.0;
  }
  return out;
}

void importer::take_pose(geometry& g, const tinygltf::Primitive& primitive, const std::string& where, const pose& posed,
                         rest_pose* rest) {
  // Many nodes may pose one mesh, and many targets may be one accessor, with very few bytes in the file.
  posed_vertices_ += g.positions.size() * (2 + posed.weights.size());
  if (posed_vertices_ > posed_vertex_limit) {
    refuse(file_, "scene.too-large",
           "its morph targets and skins change more than " + std::to_string(posed_vertex_limit) + " vertices",
           "bake it in parts");
  }
  std::vector<glm::dvec3> positions(g.positions.begin(), g.positions.end());
  for (std::size_t i = 0; i < posed.weights.size(); ++i) {
    if (posed.weights[i] != 0.0)
      displace(positions, numbers<float>(primitive.targets[i].at("POSITION")), posed.weights[i]);
  }
  if (posed.skin >= 0) {
    std::vector<influence_set> sets;
    for (const auto& [joints, weights] : {std::pair{"JOINTS_0", "WEIGHTS_0"}, std::pair{"JOINTS_1", "WEIGHTS_1"}}) {
      const auto found = primitive.attributes.find(joints);
      if (found == primitive.attributes.end()) break;
      sets.push_back({numbers<float>(found->second), numbers<float>(primitive.attributes.at(weights))});
    }
    const std::vector<glm::dmat4>& matrices = joint_matrices(posed.skin);
    if (const auto missing = bend(positions, sets, matrices, rest == nullptr ? nullptr : &rest->frames)) {
      refuse(file_, "scene.index-out-of-range",
             where + " attaches vertex " + std::to_string(*missing) + " to a joint that is none of the " +
                 std::to_string(matrices.size()) + " of skins[" + std::to_string(posed.skin) + "]",
             "export the file again");
    }
  }
  for (std::size_t i = 0; i < positions.size(); ++i) g.positions[i] = glm::vec3(positions[i]);
  if (!posed.mirrored) return;
  for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) std::swap(g.indices[i + 1], g.indices[i + 2]);
}

const std::vector<glm::dmat4>& importer::joint_matrices(int skin) {
  if (joints_.first == skin) return joints_.second;
  const tinygltf::Skin& source = model_.skins[static_cast<std::size_t>(skin)];
  std::vector<double> bind;
  if (source.inverseBindMatrices >= 0) bind = numbers<double>(source.inverseBindMatrices);
  joints_ = {skin, {}};
  for (std::size_t j = 0; j < source.joints.size(); ++j) {
    const glm::dmat4& world = world_of(source.joints[j]);
    joints_.second.push_back(bind.empty() ? world : world * glm::make_mat4(&bind[16 * j]));
  }
  return joints_.second;
}

// Joints need not be in the scene that is loaded.
const glm::dmat4& importer::world_of(int node) {
  if (parents_.empty()) {
    parents_.assign(model_.nodes.size(), -1);
    worlds_.resize(model_.nodes.size());
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
      for (const int child : model_.nodes[i].children) {
        int& parent = parents_[static_cast<std::size_t>(child)];
        if (parent < 0) parent = static_cast<int>(i);
      }
    }
  }
  std::vector<std::size_t> chain;  // from the node up to the first one with a known transform
  for (int at = node; at >= 0 && !worlds_[static_cast<std::size_t>(at)]; at = parents_[static_cast<std::size_t>(at)]) {
    chain.push_back(static_cast<std::size_t>(at));
    if (chain.size() > model_.nodes.size()) {
      refuse(file_, "scene.node-cycle", "the joint nodes[" + std::to_string(node) + "] is in or below a cycle of nodes",
             "export the file again");
    }
  }
  for (auto it = chain.rbegin(); it != chain.rend(); ++it) {
    const glm::dmat4 local = local_transform(model_.nodes[*it]);
    worlds_[*it] = parents_[*it] < 0 ? local : *worlds_[static_cast<std::size_t>(parents_[*it])] * local;
  }
  return *worlds_[static_cast<std::size_t>(node)];
}

void importer::count_vertices(int positions) {
  vertices_ += accessors_[static_cast<std::size_t>(positions)].count;
  if (vertices_ > vertex_limit) {
    refuse(file_, "scene.too-large",
           "the primitives of the scene have more than " + std::to_string(vertex_limit) + " vertices",
           "export it with separate vertices for each primitive");
  }
}

std::optional<std::uint32_t> importer::geometry_of(std::size_t mesh, std::size_t primitive, const pose& posed) {
  const tinygltf::Primitive& source = model_.meshes[mesh].primitives[primitive];
  const auto position = source.attributes.find("POSITION");
  if (position == source.attributes.end()) return std::nullopt;
  const std::string where = "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
  if (!posed.rests()) {
    const auto [entry, added] =
        posed_.try_emplace({mesh, primitive, posed}, static_cast<std::uint32_t>(out_.geometries.size()));
    if (!added) return entry->second;
    count_vertices(position->second);
    geometry g = read_geometry(source, where);
    rest_pose* const rest = poses_ == nullptr ? nullptr : &(*poses_)[entry->second];
    if (rest != nullptr) rest->weights = posed.weights;
    take_pose(g, source, where, posed, rest);
    out_.geometries.push_back(std::move(g));
    return entry->second;
  }
  const auto uv = source.attributes.find("TEXCOORD_0");
  const auto color = source.attributes.find("COLOR_0");
  const auto clusters = source.attributes.find(clusters_attribute);
  const bool has_uv = uv != source.attributes.end();
  const std::tuple key(position->second, has_uv ? uv->second : -1, has_uv ? coordinates_of(source.material) : -1,
                       color == source.attributes.end() ? -1 : color->second, source.indices, source.mode,
                       clusters == source.attributes.end() ? -1 : clusters->second);
  const auto known = geometries_.find(key);
  if (known != geometries_.end()) return known->second;
  count_vertices(position->second);
  out_.geometries.push_back(read_geometry(source, where));
  const auto number = static_cast<std::uint32_t>(out_.geometries.size() - 1);
  geometries_.emplace(key, number);
  return number;
}

void importer::check_draws(std::size_t more) const {
  if (more > draw_limit - out_.draws.size()) {
    refuse(file_, "scene.too-large", "the scene has more than " + std::to_string(draw_limit) + " draws",
           "bake it in parts");
  }
}

std::vector<glm::dmat4> importer::instance_transforms(const tinygltf::Node& node) const {
  const auto found = node.extensions.find("EXT_mesh_gpu_instancing");
  if (found == node.extensions.end()) return {glm::dmat4(1.0)};
  const tinygltf::Value& attributes = found->second.Get("attributes");
  // Checked before anything is read: instances that are all zero take no bytes in the file.
  for (const std::string& key : attributes.Keys()) {
    check_draws(accessors_[static_cast<std::size_t>(attributes.Get(key).GetNumberAsInt())].count);
  }
  std::vector<double> translations, rotations, scales;
  if (attributes.Has("TRANSLATION")) translations = numbers<double>(attributes.Get("TRANSLATION").GetNumberAsInt());
  if (attributes.Has("ROTATION")) rotations = numbers<double>(attributes.Get("ROTATION").GetNumberAsInt());
  if (attributes.Has("SCALE")) scales = numbers<double>(attributes.Get("SCALE").GetNumberAsInt());
  const std::size_t count = std::max({translations.size() / 3, rotations.size() / 4, scales.size() / 3});
  std::vector<glm::dmat4> out;
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(from_trs(translations.empty() ? no_translation : &translations[3 * i],
                           rotations.empty() ? no_rotation : &rotations[4 * i],
                           scales.empty() ? no_scale : &scales[3 * i]));
  }
  return out;
}

bool importer::moves(std::size_t node, const from_above& here) const {
  return here.moves || nodes_.nodes[node].morphs || model_.nodes[node].skin >= 0;
}

// Only groups that have draws are added to the scene.
draw_tags importer::tags_of_node(std::size_t node, const from_above& here) {
  draw_tags tags = tags_of(here.marks, moves(node, here));
  if (tags.group == no_index) return tags;
  std::uint32_t& number = group_numbers_[tags.group];
  if (number == no_index) {
    number = static_cast<std::uint32_t>(out_.groups.size());
    out_.groups.push_back(nodes_.groups[tags.group]);
  }
  tags.group = number;
  return tags;
}

void importer::warn_of_movement() {
  std::size_t draws = 0;
  std::uint64_t polygons = 0;
  for (const draw& d : out_.draws) {
    if (!d.tags.animated) continue;
    ++draws;
    polygons += out_.geometries[d.geometry].indices.size() / 3;
  }
  if (draws == 0) return;
  out_.warnings.push_back("animations and skins move " + std::to_string(draws) + (draws == 1 ? " draw" : " draws") +
                          " of " + std::to_string(polygons) +
                          " polygons: they are in every set and occlude nothing, unless --animated changes that");
}

void importer::add_node(std::size_t node, const from_above& here) {
  const tinygltf::Node& source = model_.nodes[node];
  if (source.mesh < 0) return;
  const auto mesh = static_cast<std::size_t>(source.mesh);
  const std::vector<glm::dmat4> instances = instance_transforms(source);
  for (std::size_t primitive = 0; primitive < model_.meshes[mesh].primitives.size(); ++primitive) {
    const pose posed = pose_of(source, model_.meshes[mesh].primitives[primitive], here);
    const auto geometry = geometry_of(mesh, primitive, posed);
    if (!geometry || out_.geometries[*geometry].indices.empty()) continue;
    check_draws(instances.size());
    const int material = model_.meshes[mesh].primitives[primitive].material;
    const bool is_cell = nodes_.nodes[node].marks.cell;
    const draw_tags tags = is_cell ? draw_tags{.never = true} : tags_of_node(node, here);
    for (std::size_t i = 0; i < instances.size(); ++i) {
      draw d;
      d.node = static_cast<std::uint32_t>(node);
      d.mesh = static_cast<std::uint32_t>(mesh);
      d.primitive = static_cast<std::uint32_t>(primitive);
      d.instance = static_cast<std::uint32_t>(i);
      d.material = material < 0 ? no_index : static_cast<std::uint32_t>(material);
      d.geometry = *geometry;
      d.to_world = posed.skin >= 0 ? instances[i] : here.to_world * instances[i];
      d.tags = tags;
      d.moves = tags.dynamic || (!is_cell && moves(node, here) && !here.marks.is_static.value_or(false));
      d.lod_object = here.lod.object;
      d.lod_level = here.lod.level;
      out_.draws.push_back(d);
    }
  }
}

void importer::add_start(std::size_t node, const glm::dmat4& to_world, bool marked) {
  const bool is_camera = !marked && model_.nodes[node].camera >= 0;
  if (!marked && !is_camera) return;
  const glm::dvec4 at = to_world[3];
  start_point start{.is_camera = is_camera};
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(at[axis])) return;
    start.position[static_cast<std::size_t>(axis)] = static_cast<float>(at[axis]);
  }
  out_.starts.push_back(start);
}

void importer::walk(const std::vector<int>& roots) {
  struct pending {
    int node;
    from_above parent;
  };
  std::vector<bool> seen(model_.nodes.size(), false);
  std::vector<pending> stack;
  const auto push = [&stack](const std::vector<int>& nodes, const from_above& parent) {
    for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) stack.push_back({*it, parent});
  };
  const std::function<const std::vector<int>&(std::size_t)> of_file =
      [this](std::size_t node) -> const std::vector<int>& { return model_.nodes[node].children; };
  joined_tree tree(roots, of_file);
  if (outside_) tree.join(nodes_);
  const auto children = [&tree](std::size_t node) -> const std::vector<int>& { return tree.children(node); };
  lod_levels levels(nodes_, tree.roots(), children, out_.warnings);
  push(tree.roots(), {});
  while (!stack.empty()) {
    const pending next = stack.back();
    stack.pop_back();
    const auto node = static_cast<std::size_t>(next.node);
    if (seen[node]) {
      refuse(file_, "scene.node-cycle",
             "nodes[" + std::to_string(node) + "] is reached twice: it is in a cycle or has two parents",
             "export the file again");
    }
    seen[node] = true;
    const node_notes& notes = nodes_.nodes[node];
    const from_above here{next.parent.to_world * local_transform(model_.nodes[node]),
                          inherited(next.parent.marks, notes.marks), next.parent.moves || notes.moves,
                          levels.below(next.parent.lod, static_cast<std::uint32_t>(node))};
    const std::size_t first_draw = out_.draws.size();
    add_node(node, here);
    add_start(node, here.to_world, notes.marks.start);
    const bool moving = here.moves && !here.marks.is_static.value_or(false);
    if (const auto& light = lights_.of_node[node])
      add_light(out_, static_cast<std::uint32_t>(node), *light, here.to_world, moving || here.marks.dynamic == true);
    if (notes.marks.cell) {
      const bool has_mesh = model_.nodes[node].mesh >= 0;
      add_marked_cells(out_, static_cast<std::uint32_t>(node), here.to_world, has_mesh ? &first_draw : nullptr);
    }
    push(children(node), here);
  }
  levels.settle(out_.draws, switches_);
  warn_of_movement();
}

// Returns the roots of scene `scene_index`, else of the default scene, else of scene 0, else all nodes without a
// parent.
std::vector<int> roots_of(const tinygltf::Model& model, int scene_index, const std::string& name) {
  if (scene_index >= 0) {
    if (static_cast<std::size_t>(scene_index) >= model.scenes.size()) {
      throw error(error_kind::wrong_use, "scene.no-such-scene", name,
                  "has no scene " + std::to_string(scene_index) + ", only " + std::to_string(model.scenes.size()),
                  "choose another, or leave out the number for the default scene");
    }
    return model.scenes[static_cast<std::size_t>(scene_index)].nodes;
  }
  if (model.defaultScene >= 0) return model.scenes[static_cast<std::size_t>(model.defaultScene)].nodes;
  if (!model.scenes.empty()) return model.scenes[0].nodes;
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = true;
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  }
  if (roots.empty() && !model.nodes.empty()) {
    refuse(name, "scene.node-cycle", "has no root node: its nodes form cycles", "export the file again");
  }
  return roots;
}

}  // namespace

scene import_gltf(gltf_file file, const gltf_source& source, std::string name, int scene_index, pose_list* poses,
                  std::vector<object_switches>* switches, bool outside) {
  gltf_document document = read_gltf_document(std::move(file), source);
  scene out;
  out.name = std::move(name);
  const tinygltf::Model model = parse(document, source.name);
  out.materials = std::move(document.materials);
  out.images = std::move(document.images);
  out.extensions = std::move(document.extensions);
  out.warnings = std::move(document.warnings);
  out.light_warnings = std::move(document.lights.warnings);
  for (const tinygltf::Node& node : model.nodes) out.node_names.push_back(node.name);
  for (const tinygltf::Mesh& mesh : model.meshes) out.mesh_names.push_back(mesh.name);
  importer(model, document, source.name, out, poses, switches, outside).walk(roots_of(model, scene_index, source.name));
  if (out.draws.empty()) out.warnings.push_back("the scene has no triangles");
  finish(out);
  return out;
}

void refuse_for_memory(const std::string& file) {
  throw error(error_kind::failed, "scene.out-of-memory", file, "there is not enough memory to load it",
              "close other programs or use a machine with more memory");
}

scene load_gltf(const std::filesystem::path& path, int scene_index) {
  const gltf_source source = source_of(path);
  try {
    // The bytes are freed, so that they are not in memory twice.
    gltf_file file = split_gltf(read_scene_bytes(path), source.name);
    return import_gltf(std::move(file), source, printable(path.filename().string(), 1000), scene_index);
  } catch (const std::bad_alloc&) {
    refuse_for_memory(source.name);
  }
}

scene load_gltf(std::span<const std::byte> bytes, const std::string& name, const std::filesystem::path& folder,
                int scene_index) {
  gltf_source source{printable(name, 1000), std::nullopt};
  if (!folder.empty()) source.folder = folder;
  try {
    const std::span octets(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    return import_gltf(split_gltf(octets, source.name), source, source.name, scene_index);
  } catch (const std::bad_alloc&) {
    refuse_for_memory(source.name);
  }
}

}  // namespace sightcell::scene
