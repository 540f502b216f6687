#include "cells_glb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "whole_file.h"

namespace sightcell::cli {
namespace {

constexpr float gap = 0.01f;  // of the width of a box, left free on each side: adjacent boxes show their borders

// A cube from 0 to 1: its corners, by bits x, y, z, and its triangles with their fronts outside.
std::string cube_bytes() {
  constexpr std::array<std::uint16_t, 36> triangles{0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  std::string bytes;
  for (unsigned corner = 0; corner < 8; ++corner)
    for (unsigned axis = 0; axis < 3; ++axis)
      bytes += (corner >> axis & 1) != 0 ? std::string{"\0\0\x80\x3F", 4} : std::string{"\0\0\0\0", 4};  // 1.0f, 0.0f
  for (const std::uint16_t corner : triangles) bytes += {static_cast<char>(corner), '\0'};
  return bytes;
}

nlohmann::ordered_json material_of(double share) {
  return {{"alphaMode", "BLEND"},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {0.1 + 0.8 * share, 0.35, 0.9 - 0.8 * share, 0.45}}, {"metallicFactor", 0.0}}}};
}

nlohmann::ordered_json document_of(std::span<const bake::cell_box> cells) {
  std::map<long, int> mesh_of;  // by the width in millimeters
  const auto width_of = [](const bake::cell_box& cell) {
    return std::lround(1000.0 * std::max(cell.max[0] - cell.min[0], cell.max[2] - cell.min[2]));
  };
  for (const bake::cell_box& cell : cells) mesh_of[width_of(cell)] = 0;
  nlohmann::ordered_json document{
      {"asset", {{"version", "2.0"}, {"generator", "sightcell"}}},
      {"buffers", {{{"byteLength", 168}}}},
      {"bufferViews", {{{"buffer", 0}, {"byteLength", 96}}, {{"buffer", 0}, {"byteOffset", 96}, {"byteLength", 72}}}},
      {"accessors",
       {{{"bufferView", 0},
         {"componentType", 5126},
         {"count", 8},
         {"type", "VEC3"},
         {"min", {0, 0, 0}},
         {"max", {1, 1, 1}}},
        {{"bufferView", 1}, {"componentType", 5123}, {"count", 36}, {"type", "SCALAR"}}}}};
  int number = 0;
  for (auto& [width, mesh] : mesh_of) {
    mesh = number++;
    const double share = mesh_of.size() > 1 ? mesh / static_cast<double>(mesh_of.size() - 1) : 0.0;
    document["materials"].push_back(material_of(share));
    document["meshes"].push_back(
        {{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"material", mesh}}}}});
  }
  nlohmann::ordered_json roots = nlohmann::ordered_json::array();
  for (const bake::cell_box& cell : cells) {
    std::array<float, 3> translation{}, scale{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float side = cell.max[axis] - cell.min[axis];
      translation[axis] = cell.min[axis] + gap * side;
      scale[axis] = side * (1.0f - 2.0f * gap);
    }
    roots.push_back(roots.size());
    document["nodes"].push_back({{"mesh", mesh_of.at(width_of(cell))}, {"translation", translation}, {"scale", scale}});
    if (!cell.name.empty()) document["nodes"].back()["name"] = cell.name;
  }
  document["scenes"] = {{{"nodes", roots}}};
  document["scene"] = 0;
  return document;
}

void put_u32(std::string& out, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xFF);
}

void put_chunk(std::string& out, std::string bytes, const char* type, char filler) {
  while (bytes.size() % 4 != 0) bytes += filler;
  put_u32(out, static_cast<std::uint32_t>(bytes.size()));
  out.append(type, 4);
  out += bytes;
}

}  // namespace

void write_cells_glb(std::span<const bake::cell_box> cells, const std::filesystem::path& path) {
  std::string chunks;
  put_chunk(chunks, document_of(cells).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), "JSON",
            ' ');
  put_chunk(chunks, cube_bytes(), "BIN\0", '\0');
  std::string file = "glTF";
  put_u32(file, 2);
  put_u32(file, static_cast<std::uint32_t>(12 + chunks.size()));
  file += chunks;
  write_whole_file(path, file);
}

}  // namespace sightcell::cli
