// Things that lie, stand and hang in streets and yards. Frames stand on the ground, y up.
#include <cmath>

#include "clutter_parts.h"

namespace sightcell::city::parts {
namespace {

// A place near the frame's, turned any way round the vertical.
frame near(const frame& f, double radius, random_stream& random) {
  const frame at = f.moved({random.range(-radius, radius), 0, random.range(-radius, radius)});
  return turned(at, random.range(-2.0, 2.0));
}

}  // namespace

// Sagging along x, half of it on either side; the frame hangs at wall height.
void wire(mesh& m, const frame& f, double size, random_stream& random) {
  const double sag = size * random.range(0.02, 0.05), rise = random.range(-0.3, 0.3);
  constexpr int parts = 6;
  const auto point = [&](int i) {
    const double s = 2.0 * i / parts - 1.0;
    return f.point({s * size * 0.5, -sag * (1.0 - s * s) + rise * s, 0});
  };
  for (int i = 0; i < parts; ++i) pillar(m, surface::metal, point(i), point(i + 1), 0.011, 0.011, 3);
}

void fruit_crate(mesh& m, const frame& f, double, random_stream& random) {
  const frame box = tumbled(turned(f, random.range(-2.0, 2.0)), 0.06, random);
  crate(m, surface::wood, box.moved({0, 0.14, 0}), {0.3, 0.14, 0.2});
  const surface kind = random.chance(0.5) ? surface::fruit : surface::flower;
  for (int i = 0; i < 9; ++i) {
    const double x = (i % 3) * 0.17 - 0.17 + random.range(-0.02, 0.02), z = (i / 3) * 0.11 - 0.11;
    const double y = 0.3 + random.range(0.0, 0.02);
    m.blob(kind, box.point({x, y, z}), glm::dvec3(0.055), false, random.next());
  }
}

void litter(mesh& m, const frame& f, double, random_stream& random) {
  for (int i = 0; i < 3; ++i) {
    frame paper = near(f, 0.6, random).moved({0, 0.05, 0});
    paper = {paper.at, paper.x, -paper.z, paper.y};  // lies on the ground
    card(m, surface::litter, tumbled(paper, 0.2, random), 0.1, 0.07);
  }
  const frame can = tumbled(near(f, 0.6, random).moved({0, 0.05, 0}), 1.0, random);
  pillar(m, surface::metal, can.at, can.point({0, 0.12, 0}), 0.033, 0.033, 6);
}

void stones(mesh& m, const frame& f, double, random_stream& random) {
  for (int i = 0; i < 5; ++i) {
    const double r = random.range(0.04, 0.11);
    const glm::dvec3 at = near(f, 0.6, random).point({0, r * 0.5, 0});
    m.blob(surface::stone, at, {r, r * 0.7, r}, false, random.next());
  }
}

void fallen_leaves(mesh& m, const frame& f, double, random_stream& random) {
  for (int i = 0; i < 10; ++i) leaf(m, near(f, 0.7, random), 0, random);
}

void leaf(mesh& m, const frame& f, double, random_stream& random) {
  const frame flat = {f.point({0, 0.04, 0}), f.x, -f.z, f.y};
  card(m, surface::foliage, tumbled(flat, 0.35, random), 0.05, 0.07);
}

void pigeons(mesh& m, const frame& f, double, random_stream& random) {
  for (int i = 0; i < 3; ++i) {
    const frame bird = tumbled(near(f, 0.6, random), 0.1, random);
    m.blob(surface::roof_slate, bird.point({0, 0.13, 0}), {0.08, 0.08, 0.08}, false, random.next());
    m.blob(surface::roof_slate, bird.point({0, 0.24, 0.09}), glm::dvec3(0.04), false, random.next());
    pillar(m, surface::roof_slate, bird.point({0, 0.14, -0.05}), bird.point({0, 0.1, -0.22}), 0.04, 0, 3);
    for (const double x : {-0.03, 0.03}) {
      pillar(m, surface::rust, bird.point({x, -0.01, 0}), bird.point({x, 0.1, 0}), 0.006, 0.006, 3);
    }
  }
}

void railing(mesh& m, const frame& f, double size, random_stream& random) {
  const auto ground = [&](double x) { return size * x / 2.9; };
  for (const double y : {0.45, 1.0}) {
    pillar(m, surface::metal, f.point({-1.45, ground(-1.45) + y, 0}), f.point({1.45, ground(1.45) + y, 0}), 0.018,
           0.018, 4);
  }
  for (int i = 0; i < 10; ++i) {
    const double x = (i + 0.5) * 0.29 - 1.45, lean = random.range(-0.02, 0.02);
    pillar(m, surface::metal, f.point({x, ground(x) - 0.05, 0}), f.point({x + lean, ground(x) + 1.0, 0}), 0.009, 0.009,
           3);
  }
}

// Leaning on a wall behind them.
void planks(mesh& m, const frame& f, double, random_stream& random) {
  for (int i = 0; i < 3; ++i) {
    const double x = i * 0.3 - 0.3, foot = random.range(0.5, 0.9), length = random.range(1.6, 2.6);
    const double rise = std::sqrt(length * length - foot * foot);
    const frame plank = {f.point({x, rise * 0.5, foot * 0.5 + 0.03}), f.x, (f.y * rise - f.z * foot) / length,
                         (f.z * rise + f.y * foot) / length};
    crate(m, surface::wood, turned(tumbled(plank, 0.02, random), 0.0), {0.1, length * 0.5, 0.02});
  }
}

void bottles(mesh& m, const frame& f, double, random_stream& random) {
  for (int i = 0; i < 4; ++i) {
    const frame bottle = tumbled(near(f, 0.3, random).moved({0, 0.04, 0}), i < 2 ? 0.03 : 1.0, random);
    pillar(m, surface::lawn, bottle.at, bottle.point({0, 0.16, 0}), 0.036, 0.036, 6);
    pillar(m, surface::lawn, bottle.point({0, 0.158, 0}), bottle.point({0, 0.25, 0}), 0.02, 0.014, 3);
  }
}

void drain(mesh& m, const frame& f, double, random_stream& random) {
  const frame grate = turned(f, random.range(-0.2, 0.2));
  for (int i = 0; i < 6; ++i) {
    crate(m, surface::metal, tumbled(grate.moved({i * 0.08 - 0.2, 0.0, 0}), 0.01, random), {0.02, 0.025, 0.135});
  }
}

}  // namespace sightcell::city::parts
