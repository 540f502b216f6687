#include "props.h"

#include "rich_props.h"

namespace sightcell::city {
namespace {

mesh small_tree(std::uint64_t seed) {
  mesh m("small tree");
  m.column(surface::bark, {0, -0.1, 0}, 0.11, 0.07, 2.0);
  m.blob(surface::leaves_light, {0, 2.9, 0}, {1.1, 1.3, 1.1}, false, seed + 1);
  return m;
}

mesh round_tree(std::uint64_t seed) {
  mesh m("round tree");
  m.column(surface::bark, {0, -0.1, 0}, 0.18, 0.12, 2.6);
  m.blob(surface::leaves_dark, {0, 4.1, 0}, {1.9, 2.0, 1.9}, true, seed + 2);
  return m;
}

mesh broad_tree(std::uint64_t seed) {
  mesh m("broad tree");
  m.column(surface::bark, {0, -0.1, 0}, 0.26, 0.18, 3.2);
  m.blob(surface::leaves_light, {-0.9, 4.9, 0.5}, {2.0, 1.7, 2.0}, true, seed + 3);
  m.blob(surface::leaves_light, {1.0, 5.2, 0.4}, {1.9, 1.8, 1.9}, true, seed + 4);
  m.blob(surface::leaves_light, {0.1, 6.1, -0.8}, {2.1, 2.0, 2.1}, true, seed + 5);
  return m;
}

mesh conifer() {
  mesh m("conifer");
  m.column(surface::bark, {0, -0.1, 0}, 0.16, 0.1, 1.6);
  m.column(surface::leaves_dark, {0, 1.2, 0}, 1.7, 0, 2.6);
  m.column(surface::leaves_dark, {0, 2.7, 0}, 1.35, 0, 2.4);
  m.column(surface::leaves_dark, {0, 4.1, 0}, 0.95, 0, 2.2);
  return m;
}

mesh lamp() {
  mesh m("lamp");
  m.upright_box(surface::metal, {-0.06, -0.1, -0.06}, {0.06, 3.9, 0.06});
  m.upright_box(surface::paint, {-0.2, 3.8, -0.2}, {0.2, 4.3, 0.2});
  return m;
}

mesh bench() {
  mesh m("bench");
  m.upright_box(surface::stone, {-0.8, -0.1, -0.2}, {-0.65, 0.42, 0.2});
  m.upright_box(surface::stone, {0.65, -0.1, -0.2}, {0.8, 0.42, 0.2});
  m.upright_box(surface::wood, {-0.95, 0.4, -0.25}, {0.95, 0.48, 0.25});
  m.upright_box(surface::wood, {-0.95, 0.47, 0.18}, {0.95, 0.9, 0.25});
  return m;
}

mesh car() {
  mesh m("car");
  m.upright_box(surface::paint, {-0.85, 0.3, -2.05}, {0.85, 0.85, 2.05});
  m.prism(surface::window, {{{-0.75, -1.0}, {-0.75, 1.3}, {0.75, 1.3}, {0.75, -1.0}}}, 0.8, 1.42);
  m.upright_box(surface::paint, {-0.78, 1.4, -1.05}, {0.78, 1.47, 1.35});
  for (const double x : {-0.86, 0.66}) {
    for (const double z : {-1.6, 1.0}) m.upright_box(surface::metal, {x, 0.0, z}, {x + 0.2, 0.6, z + 0.6});
  }
  return m;
}

mesh stall() {
  mesh m("stall");
  for (const double x : {-1.45, 1.35}) {
    for (const double z : {-1.05, 0.95}) m.upright_box(surface::wood, {x, -0.1, z}, {x + 0.1, 2.1, z + 0.1});
  }
  m.upright_box(surface::wood, {-1.4, 0.75, -1.0}, {1.4, 0.9, 1.0});
  m.column(surface::plaster_rose, {0, 2.05, 0}, 2.1, 0, 0.9);
  return m;
}

mesh fountain() {
  mesh m("fountain");
  m.column(surface::stone, {0, -0.1, 0}, 2.6, 2.5, 0.7);
  m.column(surface::stone, {0, 0.5, 0}, 0.35, 0.25, 1.6);
  m.column(surface::stone, {0, 2.0, 0}, 0.4, 0.9, 0.35);
  m.blob(surface::stone, {0, 2.7, 0}, {0.4, 0.5, 0.4}, true, 7);
  return m;
}

mesh crate() {
  mesh m("crate");
  m.upright_box(surface::wood, {-0.4, -0.05, -0.4}, {0.4, 0.7, 0.4});
  return m;
}

}  // namespace

std::vector<mesh> make_prop_meshes(std::uint64_t seed) {
  return {small_tree(seed), round_tree(seed), broad_tree(seed), conifer(), lamp(), bench(), car(),
          stall(),          fountain(),       crate()};
}

std::vector<mesh> make_town_prop_meshes(std::uint64_t seed) {
  std::vector<mesh> out = make_prop_meshes(seed);
  for (mesh& m : make_rich_props(seed)) out.push_back(std::move(m));
  return out;
}

double prop_radius(prop kind) {
  switch (kind) {
    case prop::leafy_tree:
    case prop::fruit_stall:
      return 2.3;
    case prop::young_tree:
    case prop::cafe_table:
      return 1.2;
    case prop::bush:
    case prop::bicycle:
      return 1.0;
    case prop::motor_car:
      return 2.3;
    case prop::barrow:
      return 1.3;
    case prop::car:
      return 2.3;
    case prop::stall:
      return 2.2;
    case prop::fountain:
      return 2.7;
    case prop::small_tree:
      return 1.1;  // crowns hang down to the height of a head
    case prop::round_tree:
      return 1.9;
    case prop::broad_tree:
      return 3.2;
    case prop::conifer:
      return 1.7;
    case prop::bench:
      return 1.0;
    case prop::crate:
      return 0.6;
    default:
      return 0.4;
  }
}

}  // namespace sightcell::city
