#pragma once
// What stands for an engine here: a small museum made of entities, with the memory layout an engine would have (one
// interleaved vertex buffer per mesh, 16-bit indices, a transform per entity). Nothing in this file knows Sightcell.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace museum {

struct vertex {
  float position[3];
  float normal[3];
  float uv[2];
};

struct mesh {
  std::vector<vertex> vertices;
  std::vector<std::uint16_t> indices;
};

enum class kind : std::uint32_t { wall, floor, ceiling, lattice, statue, crate };

struct entity {
  kind what;
  std::uint32_t number;  // counts within its kind
  std::uint32_t mesh;
  std::array<double, 16> to_world;  // column-major
  std::string name;

  // What the engine knows the entity by; goes through the bake as the draw's tag.
  std::uint64_t id() const { return std::uint64_t{static_cast<std::uint32_t>(what)} << 32 | number; }
};

struct room {
  std::string name;
  std::array<float, 3> min, max;  // where a visitor's eyes can be
};

struct level {
  std::vector<mesh> meshes;
  std::vector<entity> entities;
  std::vector<room> rooms;
};

// Six rooms in two rows, A1 A2 A3 over B1 B2 B3, a statue and crates in each. Doors: A1-A2, A2-B2, B2-B3, B3-A3. B1 has
// no door, only a lattice in the wall to A1.
level make_level();

// The lattice's alpha: bars of a quarter of the width every 1/8, in both directions.
float lattice_alpha(float u, float v);

}  // namespace museum
