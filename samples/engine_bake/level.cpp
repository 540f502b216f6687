#include "level.h"

#include <cmath>
#include <numbers>

namespace museum {
namespace {

constexpr double size = 8.0;       // of a room, in both directions
constexpr double height = 3.5;     // of a room
constexpr double thickness = 0.3;  // of a wall
constexpr double door_width = 1.4, door_height = 2.2;

enum : std::uint32_t { mesh_cube = 0, mesh_pane, mesh_statue };
enum class opening { none, door, lattice };

void add_quad(mesh& m, const std::array<std::array<float, 3>, 4>& corners, const std::array<float, 3>& normal) {
  const auto first = static_cast<std::uint16_t>(m.vertices.size());
  constexpr float uvs[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (std::size_t k = 0; k < 4; ++k)
    m.vertices.push_back(
        {{corners[k][0], corners[k][1], corners[k][2]}, {normal[0], normal[1], normal[2]}, {uvs[k][0], uvs[k][1]}});
  for (const int k : {0, 1, 2, 0, 2, 3}) m.indices.push_back(static_cast<std::uint16_t>(first + k));
}

mesh cube() {
  mesh m;
  add_quad(m, {{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}}, {0, 0, 1});
  add_quad(m, {{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 1, 0}}}, {0, 0, -1});
  add_quad(m, {{{1, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}}, {1, 0, 0});
  add_quad(m, {{{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}}}, {-1, 0, 0});
  add_quad(m, {{{0, 1, 1}, {1, 1, 1}, {1, 1, 0}, {0, 1, 0}}}, {0, 1, 0});
  add_quad(m, {{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}}, {0, -1, 0});
  return m;
}

mesh pane() {
  mesh m;
  add_quad(m, {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, {0, 0, 1});
  return m;
}

// A vase: rings of 24 around +Y, closed above and below.
mesh statue() {
  constexpr std::uint16_t around = 24;
  constexpr float profile[][2] = {{0.0f, 0.0f},  {0.35f, 0.0f}, {0.3f, 0.2f},  {0.12f, 0.5f}, {0.25f, 1.0f},
                                  {0.32f, 1.4f}, {0.2f, 1.7f},  {0.26f, 1.8f}, {0.0f, 1.85f}};
  mesh m;
  for (const auto& [radius, y] : profile) {
    for (std::uint16_t i = 0; i < around; ++i) {
      const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / around;
      const float c = std::cos(angle), s = std::sin(angle);
      m.vertices.push_back({{radius * c, y, radius * s}, {c, 0, s}, {static_cast<float>(i) / around, y}});
    }
  }
  const auto rings = static_cast<std::uint16_t>(std::size(profile));
  for (std::uint16_t ring = 0; ring + 1 < rings; ++ring) {
    for (std::uint16_t i = 0; i < around; ++i) {
      const int low = ring * around + i, next = ring * around + (i + 1) % around;
      for (const int k : {low, low + around, next, next, low + around, next + around})
        m.indices.push_back(static_cast<std::uint16_t>(k));
    }
  }
  return m;
}

class builder {
 public:
  level build() {
    out_.meshes = {cube(), pane(), statue()};
    box(kind::floor, "floor", 0, -0.2, 0, 3 * size, 0, 2 * size);
    box(kind::ceiling, "ceiling", 0, height, 0, 3 * size, height + 0.2, 2 * size);
    for (int column = 0; column < 3; ++column) {
      wall_along_x(0, column, opening::none);
      wall_along_x(1, column, column == 0 ? opening::lattice : opening::door);  // A1-B1, A2-B2, A3-B3
      wall_along_x(2, column, opening::none);
    }
    for (int row = 0; row < 2; ++row) {
      wall_along_z(0, row, opening::none);
      wall_along_z(1, row, row == 0 ? opening::door : opening::none);  // A1-A2
      wall_along_z(2, row, row == 1 ? opening::door : opening::none);  // B2-B3
      wall_along_z(3, row, opening::none);
    }
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < 3; ++column) furnish(row, column);
    }
    return std::move(out_);
  }

 private:
  void add(kind what, const std::string& name, std::uint32_t mesh, const std::array<double, 16>& to_world) {
    out_.entities.push_back({what, counts_[static_cast<std::size_t>(what)]++, mesh, to_world, name});
  }

  void box(kind what, const std::string& name, double x0, double y0, double z0, double x1, double y1, double z1) {
    add(what, name, mesh_cube, {x1 - x0, 0, 0, 0, 0, y1 - y0, 0, 0, 0, 0, z1 - z0, 0, x0, y0, z0, 1});
  }

  // A wall on the line z = line x size, from x = column x size on.
  void wall_along_x(int line, int column, opening in_it) {
    const double z0 = line * size - thickness / 2, z1 = z0 + thickness, x0 = column * size, x1 = x0 + size;
    const double left = x0 + (size - door_width) / 2, right = left + door_width;
    if (in_it == opening::none) return box(kind::wall, "wall", x0, 0, z0, x1, height, z1);
    box(kind::wall, "wall", x0, 0, z0, left, height, z1);
    box(kind::wall, "wall", right, 0, z0, x1, height, z1);
    box(kind::wall, "lintel", left, door_height, z0, right, height, z1);
    if (in_it == opening::door) return;
    box(kind::wall, "parapet", left, 0, z0, right, 1.0, z1);
    add(kind::lattice, "lattice", mesh_pane,
        {door_width, 0, 0, 0, 0, door_height - 1.0, 0, 0, 0, 0, 1, 0, left, 1.0, line * size, 1});
  }

  void wall_along_z(int line, int row, opening in_it) {
    const double x0 = line * size - thickness / 2, x1 = x0 + thickness, z0 = row * size, z1 = z0 + size;
    const double near = z0 + (size - door_width) / 2, far = near + door_width;
    if (in_it == opening::none) return box(kind::wall, "wall", x0, 0, z0, x1, height, z1);
    box(kind::wall, "wall", x0, 0, z0, x1, height, near);
    box(kind::wall, "wall", x0, 0, far, x1, height, z1);
    box(kind::wall, "lintel", x0, door_height, near, x1, height, far);
  }

  void furnish(int row, int column) {
    const std::string name = std::string(1, static_cast<char>('A' + row)) + static_cast<char>('1' + column);
    const double x = column * size, z = row * size;
    const auto turned = [](double angle, double scale, double px, double pz) {
      const double c = scale * std::cos(angle), s = scale * std::sin(angle);
      return std::array<double, 16>{c, 0, -s, 0, 0, scale, 0, 0, s, 0, c, 0, px, 0, pz, 1};
    };
    add(kind::statue, "statue " + name, mesh_statue, turned(0.3 * column, 1.0, x + 4.0, z + 2.2));
    for (int i = 0; i < 3; ++i)
      add(kind::crate, "crate " + name, mesh_cube, turned(0.5 * i + 0.2 * column, 0.7, x + 1.0 + 2.0 * i, z + 6.4));
    const auto corner = [](double a, double b, double c) {
      return std::array<float, 3>{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
    };
    out_.rooms.push_back({name, corner(x + 0.5, 1.2, z + 3.2), corner(x + size - 0.5, 2.0, z + 5.4)});
  }

  level out_;
  std::array<std::uint32_t, 6> counts_{};
};

}  // namespace

level make_level() {
  return builder().build();
}

float lattice_alpha(float u, float v) {
  const auto bar = [](float x) { return x * 8.0f - std::floor(x * 8.0f) < 0.25f; };
  return bar(u) || bar(v) ? 1.0f : 0.0f;
}

}  // namespace museum
