#include "packed_vertices.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <numeric>
#include <tuple>

#include "world_point.h"

namespace sightcell::scene {
namespace {

bool is_finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

glm::vec3 vec3_at(const std::vector<float>& values, std::size_t at) {
  return {values[at], values[at + 1], values[at + 2]};
}

void put_vec3(std::vector<float>& values, std::size_t at, const glm::vec3& v) {
  values[at] = v.x, values[at + 1] = v.y, values[at + 2] = v.z;
}

// Returns a unit vector, or `otherwise` if v has no direction: readers would reject zeros.
glm::vec3 direction(const glm::dvec3& v, const glm::vec3& otherwise) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

constexpr glm::vec3 any_normal(0, 1, 0), any_tangent(1, 0, 0);

// Normals are transformed by the inverse transpose. The matrix of cofactors equals it except for the length, and
// exists for a scale of 0 too.
struct direction_map {
  explicit direction_map(const glm::dmat3& m) : matrix(m), mirrored(glm::determinant(m) < 0.0) {
    const double sign = mirrored ? -1.0 : 1.0;
    cofactors = {sign * glm::cross(m[1], m[2]), sign * glm::cross(m[2], m[0]), sign * glm::cross(m[0], m[1])};
  }
  glm::vec3 normal(const glm::vec3& n) const { return direction(cofactors * glm::dvec3(n), any_normal); }
  glm::vec3 tangent(const glm::vec3& t) const { return direction(matrix * glm::dvec3(t), any_tangent); }

  glm::dmat3 matrix, cofactors;
  bool mirrored;
};

// Returns normals: a corner of a single polygon gets the polygon's normal, others the mean of their polygons'
// weighted by area.
std::vector<float> normals_of(const geometry& g) {
  std::vector<glm::dvec3> sums(g.positions.size(), glm::dvec3(0.0));
  for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) {
    const glm::dvec3 a(g.positions[g.indices[i]]);
    const glm::dvec3 n =
        glm::cross(glm::dvec3(g.positions[g.indices[i + 1]]) - a, glm::dvec3(g.positions[g.indices[i + 2]]) - a);
    for (std::size_t k = 0; k < 3; ++k) sums[g.indices[i + k]] += n;
  }
  std::vector<float> out(3 * sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) put_vec3(out, 3 * i, direction(sums[i], any_normal));
  return out;
}

// Returns the value of an attribute that the primitive lacks.
float missing_value(const std::string& name, std::uint32_t component) {
  if (name == "NORMAL") return any_normal[static_cast<int>(component)];
  if (name == "TANGENT") return component == 0 || component == 3 ? 1.0f : 0.0f;
  return name.starts_with("COLOR_") ? 1.0f : 0.0f;
}

void displace(std::vector<float>& values, std::uint32_t width, const std::vector<float>& by, double weight) {
  for (std::size_t i = 0; 3 * i + 2 < by.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      values[width * i + k] =
          static_cast<float>(static_cast<double>(values[width * i + k]) + weight * static_cast<double>(by[3 * i + k]));
}

void turn_normal(const direction_map& map, std::vector<float>& normals, std::size_t vertex) {
  put_vec3(normals, 3 * vertex, map.normal(vec3_at(normals, 3 * vertex)));
}

void turn_tangent(const direction_map& map, std::vector<float>& tangents, std::size_t vertex) {
  put_vec3(tangents, 4 * vertex, map.tangent(vec3_at(tangents, 4 * vertex)));
  if (map.mirrored) tangents[4 * vertex + 3] = -tangents[4 * vertex + 3];
}

}  // namespace

packed_vertices::packed_vertices(const scene& s, const pose_list& poses, const std::vector<bool>& moves,
                                 gltf_attributes& attributes)
    : scene_(s), poses_(poses), moves_(moves), attributes_(attributes) {
  if (!s.draws.empty())
    count_ =
        s.draws.back().base_vertex + static_cast<std::uint32_t>(s.geometries[s.draws.back().geometry].positions.size());
  list_columns();
}

void packed_vertices::list_columns() {
  attribute_widths all;
  for (const draw& d : scene_.draws) {
    const auto [known, added] = widths_.try_emplace({d.mesh, d.primitive});
    if (added) {
      known->second = attributes_.widths(d.mesh, d.primitive);
      for (const auto& [name, width] : known->second) all[name] = std::max(all[name], width);
    }
    widths_of_draw_.push_back(&known->second);
  }
  columns_.push_back({"POSITION", 3, 0});
  for (const auto& [name, width] : all) columns_.push_back({name, width, 0});
  for (vertex_column& column : columns_) {
    column.offset = bytes_;
    bytes_ += std::uint64_t{count_} * column.width * sizeof(float);
  }
}

const attribute_widths& packed_vertices::attributes_of(std::uint32_t draw) const {
  return *widths_of_draw_[draw];
}

glm::vec3 packed_vertices::place(const draw& d, std::size_t number, const glm::vec3& local) const {
  return moves_[number] ? local : world_point(d.to_world, local);
}

void packed_vertices::find_bounds() {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  min_ = glm::vec3(infinity), max_ = glm::vec3(-infinity);
  for (std::size_t number = 0; number < scene_.draws.size(); ++number) {
    const draw& d = scene_.draws[number];
    const std::vector<glm::vec3>& positions = scene_.geometries[d.geometry].positions;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      glm::vec3 p = place(d, number, positions[i]);
      if (!is_finite(p)) {
        broken_.push_back(d.base_vertex + static_cast<std::uint32_t>(i));
        p = glm::vec3(0.0f);
      }
      min_ = glm::min(min_, p);
      max_ = glm::max(max_, p);
    }
  }
}

// values: as in the file.
attribute_values packed_vertices::at_rest(const draw& d, attribute_values values) {
  const geometry& g = scene_.geometries[d.geometry];
  const bool wanted = std::any_of(columns_.begin(), columns_.end(), [](const auto& c) { return c.name == "NORMAL"; });
  const bool from_file = values.contains("NORMAL");
  if (wanted && !from_file) values["NORMAL"] = normals_of(g);  // of the rest pose
  const auto posed = poses_.find(d.geometry);
  if (posed == poses_.end()) return values;
  const rest_pose& rest = posed->second;
  const auto normal = from_file ? values.find("NORMAL") : values.end();
  const auto tangent = values.find("TANGENT");
  for (std::size_t i = 0; i < rest.weights.size(); ++i) {
    if (rest.weights[i] == 0.0) continue;
    const auto add = [&](const char* name, std::uint32_t width, std::vector<float>& to) {
      displace(to, width, attributes_.displacements(d.mesh, d.primitive, i, name, g.positions.size()), rest.weights[i]);
    };
    if (normal != values.end()) add("NORMAL", 3, normal->second);
    if (tangent != values.end()) add("TANGENT", 4, tangent->second);
  }
  for (std::size_t i = 0; i < rest.frames.size(); ++i) {
    const direction_map frame(rest.frames[i]);
    if (normal != values.end()) turn_normal(frame, normal->second, i);
    if (tangent != values.end()) turn_tangent(frame, tangent->second, i);
  }
  return values;
}

void packed_vertices::write_draw(const draw& d, std::size_t number, const attribute_values& values,
                                 std::span<std::byte> into) const {
  const geometry& g = scene_.geometries[d.geometry];
  const direction_map to_world{glm::dmat3(moves_[number] ? glm::dmat4(1.0) : d.to_world)};
  std::vector<float> row;
  for (const vertex_column& column : columns_) {
    row.resize(g.positions.size() * column.width);
    const auto found = values.find(column.name);
    // Colors may have three numbers here and four in other primitives.
    const std::size_t has =
        found == values.end() || g.positions.empty() ? 0 : found->second.size() / g.positions.size();
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::size_t vertex = i / column.width, component = i % column.width;
      row[i] = component < has ? found->second[vertex * has + component]
                               : missing_value(column.name, static_cast<std::uint32_t>(component));
    }
    for (std::size_t i = 0; i < g.positions.size(); ++i) {
      if (column.name == "POSITION") {
        const glm::vec3 p = place(d, number, g.positions[i]);
        put_vec3(row, 3 * i, is_finite(p) ? p : glm::vec3(0.0f));
      } else if (column.name == "NORMAL" && has > 0) {
        turn_normal(to_world, row, i);
      } else if (column.name == "TANGENT" && has > 0) {
        turn_tangent(to_world, row, i);
      }
    }
    if (!row.empty())
      std::memcpy(&into[column.offset + std::uint64_t{d.base_vertex} * column.width * sizeof(float)], row.data(),
                  row.size() * sizeof(float));
  }
}

void packed_vertices::write(std::span<std::byte> into) {
  std::vector<std::uint32_t> numbers(scene_.draws.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  // The attributes of a primitive are read once for all its draws, and only those of one primitive are in memory.
  const auto key = [this](std::uint32_t number) {
    const draw& d = scene_.draws[number];
    return std::tuple(d.mesh, d.primitive, d.geometry);
  };
  std::stable_sort(numbers.begin(), numbers.end(), [&](auto a, auto b) { return key(a) < key(b); });
  attribute_values values;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const draw& d = scene_.draws[numbers[i]];
    if (i == 0 || key(numbers[i - 1]) != key(numbers[i]))
      values = at_rest(d, attributes_.read(d.mesh, d.primitive, scene_.geometries[d.geometry].positions.size()));
    write_draw(d, numbers[i], values, into);
  }
}

}  // namespace sightcell::scene
