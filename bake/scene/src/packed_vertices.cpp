#include "packed_vertices.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/mat3x3.hpp>
#include <limits>
#include <numeric>
#include <tuple>

#include "rest_attributes.h"
#include "world_point.h"

namespace sightcell::scene {
namespace {

// Returns the value of an attribute that the primitive lacks.
float missing_value(const std::string& name, std::uint32_t component) {
  if (name == "NORMAL") return any_normal[static_cast<int>(component)];
  if (name == "TANGENT") return component == 0 || component == 3 ? 1.0f : 0.0f;
  return name.starts_with("COLOR_") ? 1.0f : 0.0f;
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

attribute_values packed_vertices::at_rest(const draw& d) {
  const geometry& g = scene_.geometries[d.geometry];
  attribute_values values =
      attributes_at_rest(scene_, poses_, attributes_, d, attributes_.read(d.mesh, d.primitive, g.positions.size()));
  const bool wanted = std::any_of(columns_.begin(), columns_.end(), [](const auto& c) { return c.name == "NORMAL"; });
  if (wanted && !values.contains("NORMAL")) values["NORMAL"] = normals_of(g);  // of the rest pose
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
    if (i == 0 || key(numbers[i - 1]) != key(numbers[i])) values = at_rest(d);
    write_draw(d, numbers[i], values, into);
  }
}

}  // namespace sightcell::scene
