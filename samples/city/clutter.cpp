#include "clutter.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "clutter_parts.h"
#include "shapes.h"

namespace sightcell::city {
namespace {

// On walls: x along the wall, y up, z away from it; the frame's place lies on the wall's plane.

void dentils(mesh& m, const frame& f, double size, random_stream&) {
  for (int i = 0; i < 8; ++i) {
    const double s = size * ((i + 0.5) / 8.0 - 0.5);
    crate(m, surface::stone, f.moved({s, -0.07, 0.06}), {0.055, 0.07, 0.08});
  }
}

void shutters(mesh& m, const frame& f, double size, random_stream& random) {
  const surface paint = random.chance(0.5) ? surface::wood : surface::plaster_green;
  const double half = size * 0.5;  // of the window
  for (const double side : {-1.0, 1.0}) {
    // Opened by about half a turn, seldom quite flat on the wall.
    frame leaf = f.moved({side * (half + 0.04), 0, 0.07});
    leaf = turned(leaf, side * random.range(0.02, 0.3));
    crate(m, paint, leaf.moved({side * half * 0.5, 0, 0.0}), {half * 0.48, 0.82, 0.02});
    for (const double y : {-0.6, 0.6}) crate(m, surface::metal, f.moved({side * half, y, 0.03}), {0.03, 0.05, 0.05});
  }
}

void flower_box(mesh& m, const frame& f, double size, random_stream& random) {
  crate(m, surface::wood, tumbled(f.moved({0, -0.09, 0.16}), 0.02, random), {size * 0.5, 0.09, 0.11});
  for (int i = 0; i < 7; ++i) {
    const frame at =
        f.moved({size * ((i + 0.5) / 7.0 - 0.5), random.range(0.08, 0.2), 0.16 + random.range(-0.05, 0.08)});
    const surface color = random.chance(0.6) ? surface::flower : surface::fruit;
    const double radius = random.range(0.05, 0.085);
    m.blob(color, at.at, glm::dvec3(radius), false, random.next());
    card(m, surface::foliage, tumbled(at.moved({0.04, -0.06, 0.05}), 1.2, random), 0.08, 0.06);
  }
}

void door_things(mesh& m, const frame& f, double, random_stream& random) {
  crate(m, surface::stone, f.moved({0, -0.5, 0.25}), {0.9, 0.45, 0.26});
  crate(m, surface::stone, f.moved({0, -0.75, 0.6}), {1.0, 0.45, 0.3});
  crate(m, surface::metal, tumbled(f.moved({0.45, 1.05, -0.2}), 0.1, random), {0.07, 0.02, 0.03});
  crate(m, surface::metal, tumbled(f.moved({0.0, 1.25, -0.25}), 0.03, random), {0.13, 0.03, 0.02});
  crate(m, surface::paint, f.moved({0.95, 1.4, 0.02}), {0.05, 0.09, 0.02});
  crate(m, surface::sign_blue, tumbled(f.moved({-0.95, 1.9, 0.015}), 0.05, random), {0.1, 0.07, 0.015});
  crate(m, surface::metal, f.moved({0.95, 1.15, 0.03}), {0.11, 0.09, 0.04});
}

void wall_lamp(mesh& m, const frame& f, double, random_stream& random) {
  const frame lantern = tumbled(f.moved({0, -0.05, 0.6}), 0.08, random);
  pillar(m, surface::metal, f.at, f.point({0, 0.1, 0.6}), 0.012, 0.012, 3);
  pillar(m, surface::metal, f.point({0, -0.4, 0}), f.point({0, 0.05, 0.45}), 0.01, 0.01, 3);
  pillar(m, surface::window, lantern.point({0, -0.22, 0}), lantern.at, 0.06, 0.09, 6);
  pillar(m, surface::metal, lantern.at, lantern.point({0, 0.12, 0}), 0.11, 0, 6);
}

// size: how far it goes down.
void downpipe(mesh& m, const frame& f, double size, random_stream& random) {
  const double sway = random.range(-0.03, 0.03);
  pillar(m, surface::metal, f.point({sway, -size, 0.09}), f.point({0, 0, 0.09}), 0.05, 0.05, 6);
  for (int i = 0; i < 6; ++i) {
    crate(m, surface::metal, tumbled(f.moved({0, -size * (i + 0.5) / 6.0, 0.07}), 0.05, random), {0.07, 0.02, 0.07});
  }
}

void gutter(mesh& m, const frame& f, double size, random_stream& random) {
  const double slope = random.range(-0.03, 0.03);
  pillar(m, surface::metal, f.point({-size * 0.5, -0.04 - slope, 0.1}), f.point({size * 0.5, -0.04 + slope, 0.1}), 0.07,
         0.07, 6);
}

void hanging_sign(mesh& m, const frame& f, double, random_stream& random) {
  pillar(m, surface::metal, f.at, f.point({0, 0, 1.0}), 0.015, 0.015, 3);
  const frame board = tumbled(f.moved({0, -0.4, 0.6}), 0.12, random);
  crate(m, random.chance(0.5) ? surface::sign_red : surface::sign_blue, board, {0.025, 0.28, 0.36});
  for (const double z : {0.35, 0.85})
    pillar(m, surface::metal, f.point({0, -0.14, z}), f.point({0, 0, z}), 0.006, 0.006, 3);
}

void awning(mesh& m, const frame& f, double size, random_stream& random) {
  const surface stripes = random.chance(0.5) ? surface::sign_red : surface::plaster_green;
  const double drop = random.range(0.35, 0.6), reach = 1.15, half = size * 0.5;
  const double length = std::sqrt(drop * drop + reach * reach);
  const frame sheet = {f.point({0, -drop * 0.5, reach * 0.5 + 0.01}), f.x, (f.y * reach + f.z * drop) / length,
                       (f.z * reach - f.y * drop) / length};
  crate(m, stripes, sheet, {half, 0.015, length * 0.5});
  for (const double side : {-1.0, 1.0}) {
    pillar(m, surface::metal, f.point({side * half * 0.96, -0.75, 0}), f.point({side * half * 0.96, -drop, reach}),
           0.012, 0.012, 3);
  }
  for (int i = 0; i < 8; ++i) {
    const double s = size * ((i + 0.5) / 8.0 - 0.5);
    card(m, surface::cloth, tumbled(f.moved({s, -drop - 0.09, reach}), 0.2, random), size / 18.0, 0.08);
  }
}

void wall_cable(mesh& m, const frame& f, double size, random_stream& random) {
  const double drop = random.range(-0.5, 0.5);
  double y = 0;
  for (int i = 0; i < 4; ++i) {
    const double next = y + drop * 0.25 + random.range(-0.06, 0.06);
    pillar(m, surface::metal, f.point({size * (i * 0.25 - 0.5), y, 0.03}),
           f.point({size * ((i + 1) * 0.25 - 0.5), next, 0.03}), 0.012, 0.012, 3);
    crate(m, surface::metal, tumbled(f.moved({size * (i * 0.25 - 0.5), y, 0.02}), 0.2, random), {0.03, 0.02, 0.03});
    y = next;
  }
}

// On roofs: x along the ridge, y away from the roof, z down the slope.
void loose_tiles(mesh& m, const frame& f, double size, random_stream& random) {
  const surface tile = size > 0.5 ? surface::roof_tile : surface::roof_slate;
  for (int i = 0; i < 12; ++i) {
    const frame at = f.moved({(i % 4) * 0.28 - 0.42 + random.range(-0.02, 0.02), 0.03, (i / 4) * 0.3 - 0.3});
    crate(m, tile, tumbled(at, 0.09, random), {0.11, 0.018, 0.14});
  }
}

void ridge_tiles(mesh& m, const frame& f, double size, random_stream& random) {
  const auto tile = random.chance(0.7) ? surface::roof_tile : surface::roof_slate;
  for (int i = 0; i < 10; ++i) {
    const frame at = f.moved({(i + 0.5 - 5.0) * 0.29, 0.02, 0});
    crate(m, size > 0.5 ? tile : surface::stone, tumbled(at, 0.06, random), {0.135, 0.05, 0.1});
  }
}

void antenna(mesh& m, const frame& f, double, random_stream& random) {
  const frame mast = tumbled(f, 0.05, random);
  pillar(m, surface::metal, f.point({0, -0.4, 0}), mast.point({0, 2.6, 0}), 0.018, 0.018, 3);
  const frame boom = turned(mast.moved({0, 2.4, 0}), random.range(-0.9, 0.9));
  pillar(m, surface::metal, boom.point({-0.7, 0, 0}), boom.point({0.7, 0, 0}), 0.01, 0.01, 3);
  for (int i = 0; i < 6; ++i) {
    const double x = i * 0.24 - 0.6;
    pillar(m, surface::metal, boom.point({x, 0, -0.4}), boom.point({x, 0, 0.4}), 0.006, 0.006, 3);
  }
}

void chimney_pots(mesh& m, const frame& f, double, random_stream& random) {
  for (int i = 0; i < 3; ++i) {
    const frame pot = tumbled(f.moved({i * 0.26 - 0.26, -0.01, 0}), 0.03, random);
    pillar(m, surface::roof_tile, pot.at, pot.point({0, random.range(0.2, 0.24), 0}), 0.1, 0.08, 6);
  }
}

void rosettes(mesh& m, const frame& f, double size, random_stream& random) {
  for (int i = 0; i < 6; ++i) {
    const frame at = f.moved({size * ((i + 0.5) / 6.0 - 0.5), 0, 0});
    const frame lean = tumbled(at, 0.03, random);
    pillar(m, surface::stone, lean.point({0, 0, -0.02}), lean.point({0, 0, 0.06}), 0.12, 0.07, 6);
  }
}

void grille(mesh& m, const frame& f, double size, random_stream& random) {
  for (int i = 0; i < 9; ++i) {
    const double x = size * ((i + 0.5) / 9.0 - 0.5), lean = random.range(-0.02, 0.02);
    pillar(m, surface::metal, f.point({x, -0.85, 0.05}), f.point({x + lean, 0.85, 0.05}), 0.009, 0.009, 3);
  }
  for (const double y : {-0.7, 0.7}) {
    pillar(m, surface::metal, f.point({-size * 0.5, y, 0.06}), f.point({size * 0.5, y, 0.06}), 0.009, 0.009, 3);
  }
}

// size: the height of the house.
void scaffold(mesh& m, const frame& f, double size, random_stream& random) {
  for (const double x : {-1.2, 1.2}) {
    for (const double z : {0.35, 1.05}) {
      const double sway = random.range(-0.04, 0.04);
      pillar(m, surface::metal, f.point({x, -1.5, z}), f.point({x + sway, size, z}), 0.025, 0.025, 6);
    }
  }
  for (int i = 1; i <= 4; ++i) {
    const double y = size * i / 4.4;
    crate(m, surface::wood, tumbled(f.moved({0, y, 0.7}), 0.008, random), {1.35, 0.025, 0.3});
    for (const double z : {0.35, 1.05}) {
      pillar(m, surface::metal, f.point({-1.3, y + 1.0, z}), f.point({1.3, y + 1.0 + random.range(-0.04, 0.04), z}),
             0.02, 0.02, 3);
    }
    pillar(m, surface::metal, f.point({-1.2, y - size / 4.4, 1.08}), f.point({1.2, y, 1.08}), 0.018, 0.018, 3);
    for (int k = 0; k < 3; ++k) {
      crate(m, surface::rust, tumbled(f.moved({k - 1.0, y + 0.05, 1.05}), 0.3, random), {0.05, 0.05, 0.05});
    }
  }
}

using builder = void (*)(mesh&, const frame&, double, random_stream&);

struct entry {
  builder build;
  double reach;
};

// In the order of `clutter`.
constexpr std::array<entry, static_cast<std::size_t>(clutter::count)> entries = {{
    {dentils, 0.3},
    {shutters, 0.8},
    {flower_box, 0.6},
    {door_things, 1.3},
    {wall_lamp, 0.8},
    {downpipe, 0.2},
    {gutter, 0.2},
    {hanging_sign, 1.2},
    {awning, 1.8},
    {wall_cable, 0.1},
    {loose_tiles, 0.6},
    {ridge_tiles, 1.5},
    {antenna, 0.8},
    {chimney_pots, 0.5},
    {rosettes, 0.2},
    {grille, 0.2},
    {scaffold, 1.9},
    {parts::wire, 0.2},
    {parts::fruit_crate, 0.5},
    {parts::litter, 0.8},
    {parts::stones, 0.7},
    {parts::fallen_leaves, 0.9},
    {parts::leaf, 0.2},
    {parts::pigeons, 0.8},
    {parts::railing, 0.2},
    {parts::planks, 1.2},
    {parts::bottles, 0.4},
    {parts::drain, 0.4},
    {parts::bay_panels, 0.1},
    {parts::bay_window, 0.2},
    {parts::air_conditioner, 0.7},
    {parts::balcony, 1.3},
    {parts::laundry, 1.2},
    {parts::pipe, 0.2},
    {parts::stain, 0.1},
    {parts::vent, 0.3},
    {parts::cage, 0.5},
    {parts::shop_sign, 1.9},
    {parts::ledge, 0.4},
}};

}  // namespace

std::uint64_t clutter_cost(clutter kind) {
  static const auto costs = [] {
    std::array<std::uint64_t, entries.size()> out{};
    for (std::size_t i = 0; i < out.size(); ++i) {
      mesh scratch("");
      build_clutter(scratch, {static_cast<clutter>(i), {0, 0, 0}, {1, 0}, 2.0, 1});
      out[i] = scratch.polygon_count();
    }
    return out;
  }();
  return costs[static_cast<std::size_t>(kind)];
}

double clutter_reach(clutter kind) {
  return entries[static_cast<std::size_t>(kind)].reach;
}

void build_clutter(mesh& m, const clutter_place& place) {
  random_stream random{place.seed, static_cast<std::uint64_t>(place.kind)};
  entries[static_cast<std::size_t>(place.kind)].build(m, upright_frame(place.at, place.along), place.size, random);
}

}  // namespace sightcell::city
