#include "rich_props.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "shapes.h"

namespace sightcell::city {
namespace {

// A crown of single leaves, each a card of its own below 0.3 m, on branches.
void crown(mesh& m, const glm::dvec3& center, const glm::dvec3& radius, int leaves, random_stream& random) {
  for (int i = 0; i < leaves; ++i) {
    glm::dvec3 d;
    double length = 0;
    do {
      d = {random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
      length = std::sqrt(glm::dot(d, d));
    } while (length > 1.0 || length < 0.3);
    const frame leaf = {center + d * radius};
    card(m, surface::foliage, tumbled(leaf, 2.0, random), 0.09, 0.11);
  }
}

mesh tree(const char* name, double height, double spread, int leaves, std::uint64_t seed) {
  random_stream random{seed};
  mesh m(name);
  const glm::dvec3 top{random.range(-0.15, 0.15), height * 0.55, random.range(-0.15, 0.15)};
  const glm::dvec3 middle(0, height * 0.7, 0);
  pillar(m, surface::bark, {0, -0.2, 0}, top, height * 0.028, height * 0.016, 6);
  for (int i = 0; i < 7; ++i) {
    const glm::dvec3 end = middle + glm::dvec3{random.range(-0.7, 0.7) * spread, random.range(0.0, 0.25) * height,
                                               random.range(-0.7, 0.7) * spread};
    pillar(m, surface::bark, top - glm::dvec3(0, random.range(0.0, 0.8), 0), end, height * 0.01, height * 0.003, 3);
  }
  m.blob(surface::leaves_dark, middle + glm::dvec3(0, height * 0.08, 0),
         glm::dvec3{spread * 0.55, height * 0.17, spread * 0.55}, true, random.next());
  crown(m, middle + glm::dvec3(0, height * 0.08, 0), {spread, height * 0.27, spread}, leaves, random);
  return m;
}

mesh bush(std::uint64_t seed) {
  random_stream random{seed};
  mesh m("bush");
  m.blob(surface::leaves_light, {0, 0.35, 0}, {0.5, 0.45, 0.5}, false, random.next());
  crown(m, {0, 0.45, 0}, {0.75, 0.5, 0.75}, 40, random);
  return m;
}

void wheel(mesh& m, const glm::dvec3& center, double radius) {
  // Twelve corners of a circle from the hexagon's and the ones between.
  static constexpr double c[12][2] = {{1, 0},  {0.8660254037844386, 0.5},   {0.5, 0.8660254037844386},
                                      {0, 1},  {-0.5, 0.8660254037844386},  {-0.8660254037844386, 0.5},
                                      {-1, 0}, {-0.8660254037844386, -0.5}, {-0.5, -0.8660254037844386},
                                      {0, -1}, {0.5, -0.8660254037844386},  {0.8660254037844386, -0.5}};
  const auto at = [&](int k) { return center + glm::dvec3(0, c[k % 12][0] * radius, c[k % 12][1] * radius); };
  for (int k = 0; k < 12; ++k) pillar(m, surface::metal, at(k), at(k + 1), 0.018, 0.018, 3);
  for (int k = 0; k < 3; ++k) pillar(m, surface::metal, at(k * 2), at(k * 2 + 6), 0.004, 0.004, 3);
}

mesh bicycle() {
  mesh m("bicycle");
  wheel(m, {0, 0.34, -0.52}, 0.33);
  wheel(m, {0, 0.34, 0.52}, 0.33);
  const glm::dvec3 back(0, 0.34, -0.52), front(0, 0.34, 0.52), pedals(0, 0.3, -0.08), seat(0, 0.85, -0.22),
      head(0, 0.82, 0.36);
  const glm::dvec3 pairs[][2] = {{back, pedals}, {pedals, seat}, {seat, back},          {seat, head},
                                 {pedals, head}, {head, front},  {head, {0, 1.0, 0.32}}};
  for (const auto& pair : pairs) pillar(m, surface::sign_red, pair[0], pair[1], 0.016, 0.016, 3);
  pillar(m, surface::metal, {-0.28, 1.0, 0.3}, {0.28, 1.0, 0.3}, 0.012, 0.012, 3);
  m.upright_box(surface::wood, {-0.07, 0.85, -0.36}, {0.07, 0.9, -0.1});
  m.upright_box(surface::metal, {-0.14, 0.28, -0.12}, {-0.06, 0.31, -0.02});
  m.upright_box(surface::metal, {0.06, 0.28, -0.14}, {0.14, 0.31, -0.04});
  return m;
}

mesh cafe_table(std::uint64_t seed) {
  random_stream random{seed};
  mesh m("cafe table");
  pillar(m, surface::metal, {0, 0, 0}, {0, 0.72, 0}, 0.03, 0.03, 6);
  pillar(m, surface::wood, {0, 0.71, 0}, {0, 0.75, 0}, 0.4, 0.4, 6);
  for (int i = 0; i < 3; ++i) {
    const double x = random.range(-0.2, 0.2), z = random.range(-0.2, 0.2);
    pillar(m, surface::paint, {x, 0.749, z}, {x, 0.83, z}, 0.03, 0.04, 6);
  }
  for (const double side : {-1.0, 1.0}) {
    const double off = random.range(-0.1, 0.1);
    const frame chair = turned({{side * 0.75, 0, off}}, random.range(-0.2, 0.2));
    for (const double x : {-0.18, 0.18}) {
      for (const double z : {-0.18, 0.18}) {
        const bool is_back = x * side > 0;
        pillar(m, surface::metal, chair.point({x, 0, z}), chair.point({x, is_back ? 0.85 : 0.45, z}), 0.012, 0.012, 3);
      }
    }
    crate(m, surface::wood, chair.moved({0, 0.45, 0}), {0.2, 0.015, 0.2});
    crate(m, surface::wood, chair.moved({side * 0.19, 0.72, 0}), {0.015, 0.12, 0.19});
  }
  return m;
}

mesh motor_car() {
  mesh m("motor car");
  m.upright_box(surface::sign_blue, {-0.85, 0.3, -2.05}, {0.85, 0.85, 2.05});
  m.prism(surface::window, {{{-0.75, -1.0}, {-0.75, 1.3}, {0.75, 1.3}, {0.75, -1.0}}}, 0.8, 1.42);
  m.upright_box(surface::sign_blue, {-0.78, 1.4, -1.05}, {0.78, 1.47, 1.35});
  for (const double x : {-1.0, 1.0}) {
    for (const double z : {-1.3, 1.3}) {
      pillar(m, surface::metal, {x * 0.68, 0.3, z}, {x * 0.88, 0.3, z}, 0.3, 0.3, 6);
      pillar(m, surface::paint, {x * 0.87, 0.3, z}, {x * 0.9, 0.3, z}, 0.12, 0.1, 6);
    }
    m.upright_box(surface::sign_blue, {x * 0.92 - 0.08, 0.9, -0.95}, {x * 0.92 + 0.08, 1.05, -0.85});
    for (const double z : {-0.2, 0.9}) {
      m.upright_box(surface::metal, {x * 0.86 - 0.02, 0.7, z}, {x * 0.86 + 0.02, 0.73, z + 0.15});
    }
    for (const double z : {-2.06, 2.06}) {
      m.upright_box(z < 0 ? surface::paint : surface::sign_red, {x * 0.62 - 0.13, 0.6, z - 0.02},
                    {x * 0.62 + 0.13, 0.75, z + 0.02});
    }
  }
  for (const double z : {-2.1, 2.0}) m.upright_box(surface::metal, {-0.8, 0.32, z}, {0.8, 0.45, z + 0.1});
  m.upright_box(surface::paint, {-0.25, 0.47, -2.12}, {0.25, 0.58, -2.04});
  return m;
}

mesh street_lamp() {
  mesh m("street lamp");
  pillar(m, surface::metal, {0, -0.2, 0}, {0, 0.5, 0}, 0.11, 0.08, 6);
  pillar(m, surface::metal, {0, 0.45, 0}, {0, 4.2, 0}, 0.045, 0.03, 6);
  for (const double side : {-1.0, 1.0}) {
    const double x = side * 0.55;
    pillar(m, surface::metal, {0, 4.0, 0}, {x, 4.25, 0}, 0.015, 0.015, 3);
    pillar(m, surface::metal, {0, 3.6, 0}, {x * 0.8, 4.14, 0}, 0.01, 0.01, 3);
    pillar(m, surface::paint, {x, 3.95, 0}, {x, 4.2, 0}, 0.07, 0.11, 6);
    pillar(m, surface::metal, {x, 4.19, 0}, {x, 4.35, 0}, 0.13, 0, 6);
  }
  return m;
}

mesh fruit_stall(std::uint64_t seed) {
  random_stream random{seed};
  mesh m("fruit stall");
  for (const double x : {-1.4, 1.4}) {
    for (const double z : {-0.9, 0.9})
      pillar(m, surface::wood, {x, -0.2, z}, {x, z < 0 ? 2.3 : 2.05, z}, 0.035, 0.03, 4);
  }
  m.upright_box(surface::wood, {-1.45, 0.72, -0.85}, {1.45, 0.78, 0.95});
  const frame roof = {
      {0, 2.2, 0}, {1, 0, 0}, glm::normalize(glm::dvec3(0, 1, 0.14)), glm::normalize(glm::dvec3(0, -0.14, 1))};
  crate(m, surface::sign_red, roof, {1.6, 0.015, 1.15});
  for (int i = 0; i < 14; ++i) {
    const frame flap = roof.moved({(i - 6.5) * 0.225, -0.1, 1.152});
    card(m, surface::cloth, tumbled(flap, 0.15, random), 0.1, 0.1);
  }
  for (int tray = 0; tray < 6; ++tray) {
    const frame at = tumbled({{(tray % 3 - 1) * 0.9, 0.86, (tray / 3) * 0.8 - 0.35}}, 0.05, random);
    crate(m, surface::wood, at, {0.38, 0.06, 0.3});
    const surface kind = static_cast<surface>(static_cast<int>(surface::flower) + tray % 2);
    for (int i = 0; i < 8; ++i) {
      const double x = (i % 4 - 1.5) * 0.17, z = (i / 4 - 0.5) * 0.22;
      m.blob(kind, at.point({x, 0.1, z}), glm::dvec3(0.06), false, random.next());
    }
  }
  return m;
}

mesh barrow(std::uint64_t seed) {
  random_stream random{seed};
  mesh m("barrow");
  const frame tray = tumbled({{0, 0.55, 0}}, 0.12, random);
  crate(m, surface::wood, tray, {0.35, 0.18, 0.55});
  for (const double x : {-0.3, 0.3}) {
    pillar(m, surface::wood, tray.point({x, -0.1, -0.5}), tray.point({x, 0.0, 1.2}), 0.02, 0.02, 4);
    pillar(m, surface::wood, tray.point({x, -0.1, 0.3}), {x, 0, 0.45}, 0.02, 0.02, 4);
  }
  wheel(m, {0, 0.25, -0.75}, 0.25);
  for (int i = 0; i < 12; ++i) {
    const glm::dvec3 at = tray.point({random.range(-0.25, 0.25), 0.2, random.range(-0.45, 0.45)});
    const double radius = random.range(0.05, 0.1);
    m.blob(surface::stone, at, glm::dvec3(radius), false, random.next());
  }
  return m;
}

}  // namespace

std::vector<mesh> make_rich_props(std::uint64_t seed) {
  return {tree("leafy tree", 7.0, 2.2, 170, seed + 11),
          tree("young tree", 4.2, 1.1, 80, seed + 12),
          bush(seed + 13),
          bicycle(),
          cafe_table(seed + 14),
          motor_car(),
          street_lamp(),
          fruit_stall(seed + 15),
          barrow(seed + 16)};
}

}  // namespace sightcell::city
