// What hangs on towers: loose sheets a few millimeters to centimeters in front of each other, overlapping, as in a city
// merged from many drawings. The frame is the middle of a bay on the tower's wall; bays are 3 m high.
#include "clutter_parts.h"

namespace sightcell::city::parts {
namespace {

constexpr double half_storey = 1.5;

surface wall_sheet(random_stream& random) {
  switch (random.below(4)) {
    case 0:
      return surface::panel_grey;
    case 1:
      return surface::panel_rose;
    default:
      return surface::panel_light;
  }
}

}  // namespace

void bay_panels(mesh& m, const frame& f, double size, random_stream& random) {
  const surface sheet = wall_sheet(random);
  for (int i = 0; i < 3; ++i) {
    const double y = (i - 1) * half_storey * 0.66 + random.range(-0.03, 0.03);
    const frame at = f.moved({random.range(-0.06, 0.06), y, random.range(0.003, 0.028)});
    const surface color = i == 1 ? wall_sheet(random) : sheet;
    const double wide = size * 0.5 + random.range(0.0, 0.08), high = half_storey * 0.33 + random.range(0.02, 0.1);
    card(m, color, at, wide, high);
  }
}

void bay_window(mesh& m, const frame& f, double size, random_stream& random) {
  const double half = size * random.range(0.26, 0.36), high = random.range(0.6, 0.75), front = 0.034;
  card(m, surface::panel_dark, f.moved({0, 0.1, front}), half, high);
  card(m, surface::glass, f.moved({0.02, 0.1, front + 0.012}), half, high);
  for (const double side : {-1.0, 1.0}) {
    card(m, surface::panel_light, f.moved({side * half, 0.1, front + random.range(0.004, 0.03)}), 0.05, high + 0.06);
    card(m, surface::panel_light, f.moved({0, 0.1 + side * high, front + random.range(0.004, 0.03)}), half + 0.06,
         0.05);
  }
  card(m, surface::panel_grey, f.moved({0, 0.1, front + 0.018}), 0.03, high);
  crate(m, surface::concrete, tumbled(f.moved({0, 0.02 - high, 0.08}), 0.01, random), {half + 0.1, 0.04, 0.1});
}

void air_conditioner(mesh& m, const frame& f, double size, random_stream& random) {
  const frame box = tumbled(f.moved({random.range(-0.25, 0.25) * size, -0.95, 0.32}), 0.03, random);
  crate(m, surface::paint, box, {0.4, 0.27, 0.2});
  card(m, surface::panel_dark, box.moved({-0.08, 0, 0.204}), 0.22, 0.22);
  card(m, surface::panel_grey, box.moved({0.02, 0.0, 0.209}), 0.3, 0.04);
  for (const double x : {-0.3, 0.3}) {
    pillar(m, surface::rust, box.point({x, -0.29, -0.3}), box.point({x, -0.29, 0.22}), 0.015, 0.015, 3);
    for (const double z : {-0.15, 0.15}) crate(m, surface::rust, box.moved({x, -0.28, z}), {0.03, 0.02, 0.03});
  }
  pillar(m, surface::panel_light, box.point({0.36, -0.1, -0.2}), box.point({0.45, -1.4, -0.24}), 0.012, 0.012, 3);
}

void balcony(mesh& m, const frame& f, double size, random_stream& random) {
  const double half = size * 0.42;
  crate(m, surface::concrete, f.moved({0, -1.36, 0.55}), {half, 0.08, 0.58});
  // A second slab, drawn once more a few millimeters off.
  crate(m, surface::concrete, f.moved({0.01, -1.36 + random.range(0.002, 0.006), 0.55}), {half - 0.004, 0.08, 0.585});
  card(m, surface::panel_rose, f.moved({0, -0.9, 1.128}), half - 0.02, 0.4);
  card(m, surface::panel_light, f.moved({0, -0.95, 1.133}), half * 0.6, 0.3);
  pillar(m, surface::metal, f.point({-half, -0.45, 1.1}), f.point({half, -0.45, 1.1}), 0.02, 0.02, 3);
  for (int i = 0; i < 7; ++i) {
    const double x = half * (i / 3.0 - 1.0) * 0.98;
    pillar(m, surface::metal, f.point({x, -1.3, 1.1}), f.point({x + random.range(-0.02, 0.02), -0.45, 1.1}), 0.008,
           0.008, 3);
  }
}

void laundry(mesh& m, const frame& f, double size, random_stream& random) {
  const frame rack = tumbled(f.moved({0, -0.6, 0}), 0.06, random);
  for (const double z : {0.5, 0.9}) {
    pillar(m, surface::metal, rack.point({-size * 0.4, 0, z}), rack.point({size * 0.4, 0, z}), 0.009, 0.009, 3);
  }
  for (int i = 0; i < 5; ++i) {
    const double x = size * (i - 2.0) * 0.16, z = i % 2 == 0 ? 0.9 : 0.5, drop = random.range(0.25, 0.5);
    const surface color = random.chance(0.6) ? surface::cloth : surface::litter;
    card(m, color, tumbled(rack.moved({x, -drop, z}), 0.15, random), 0.2, drop);
    crate(m, surface::fruit, tumbled(rack.moved({x - 0.12, 0, z}), 0.2, random), {0.015, 0.05, 0.02});
    crate(m, surface::fruit, tumbled(rack.moved({x + 0.12, 0, z}), 0.2, random), {0.015, 0.05, 0.02});
  }
}

void pipe(mesh& m, const frame& f, double size, random_stream& random) {
  const double x = size * 0.47;
  pillar(m, surface::rust, f.point({x, -half_storey - 0.05, 0.1}), f.point({x, half_storey + 0.05, 0.1}), 0.05, 0.05,
         6);
  for (const double y : {-0.8, 0.7}) {
    crate(m, surface::rust, tumbled(f.moved({x, y, 0.08}), 0.08, random), {0.09, 0.025, 0.08});
  }
}

void stain(mesh& m, const frame& f, double size, random_stream& random) {
  for (int i = 0; i < 3; ++i) {
    const frame at = f.moved({random.range(-0.35, 0.35) * size, random.range(-1.2, 1.2), 0.036 + 0.004 * i});
    const double wide = random.range(0.1, 0.4), high = random.range(0.1, 0.5);
    card(m, i == 0 ? surface::panel_dark : surface::panel_grey, at, wide, high);
  }
}

void vent(mesh& m, const frame& f, double size, random_stream& random) {
  const frame at = tumbled(f.moved({random.range(-0.4, 0.4) * size, 1.15, 0.08}), 0.05, random);
  crate(m, surface::metal, at, {0.11, 0.11, 0.06});
  for (int i = 0; i < 3; ++i) {
    card(m, surface::panel_dark, tumbled(at.moved({0, i * 0.06 - 0.06, 0.068}), 0.1, random), 0.09, 0.02);
  }
  pillar(m, surface::metal, at.point({0, 0.1, 0}), at.point({0, 0.22, 0.03}), 0.04, 0.05, 6);
}

void cage(mesh& m, const frame& f, double size, random_stream& random) {
  const double half = size * 0.36;
  for (int i = 0; i < 8; ++i) {
    const double x = half * ((i + 0.5) / 4.0 - 1.0);
    pillar(m, surface::metal, f.point({x, -0.75, 0.4}), f.point({x + random.range(-0.02, 0.02), 0.9, 0.4}), 0.008,
           0.008, 3);
  }
  for (const double y : {-0.7, 0.1, 0.85}) {
    pillar(m, surface::metal, f.point({-half, y, 0.41}), f.point({half, y, 0.41}), 0.01, 0.01, 3);
  }
  for (const double x : {-half, half}) {
    pillar(m, surface::metal, f.point({x, 0.85, 0}), f.point({x, 0.85, 0.42}), 0.01, 0.01, 3);
  }
}

// Sticks out over the street.
void shop_sign(mesh& m, const frame& f, double, random_stream& random) {
  const double reach = random.range(0.9, 1.6), high = random.range(0.6, 1.2);
  const surface color = random.chance(0.5) ? surface::sign_red : surface::sign_blue;
  const frame board = tumbled(f.moved({0, 0, 0.2 + reach * 0.5}), 0.03, random);
  crate(m, color, board, {0.08, high, reach * 0.5});
  for (const double side : {-1.0, 1.0}) {
    const frame face = {board.point({side * 0.085, 0, 0}), board.z * -side, board.y, board.x * side};
    card(m, surface::panel_light, face, reach * 0.45, high * 0.94);
    for (int i = 0; i < 3; ++i) {
      card(m, i == 1 ? surface::panel_dark : surface::panel_rose,
           face.moved({random.range(-0.1, 0.1), (i - 1) * high * 0.55, 0.003 + 0.003 * i}), reach * 0.3, high * 0.22);
    }
    pillar(m, surface::rust, f.point({0, side * high * 0.7, 0}), board.point({0, side * high * 0.7, 0}), 0.02, 0.02, 3);
  }
  for (int i = 0; i < 10; ++i) {
    const frame bulb = board.moved({0, high + 0.02, reach * ((i + 0.5) / 10.0 - 0.5)});
    pillar(m, surface::fruit, bulb.at, bulb.point({0, 0.08, 0}), 0.03, 0.02, 3);
  }
}

void ledge(mesh& m, const frame& f, double size, random_stream& random) {
  crate(m, surface::concrete, f.moved({random.range(-0.05, 0.05), -half_storey, 0.1}), {size * 0.52, 0.06, 0.14});
  card(m, surface::panel_grey, f.moved({0, -half_storey, 0.243 + random.range(0.0, 0.004)}), size * 0.5, 0.055);
}

}  // namespace sightcell::city::parts
