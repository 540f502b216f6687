#pragma once
// A bent strip of triangles as a Draco stream, made with Draco's own encoder.
#include <array>
#include <cstdlib>
#include <utility>

#include "gltf_sketch.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#pragma GCC diagnostic pop

// A strip of four quads, bent, so that every triangle differs: 10 vertices, 8 triangles.
struct strip {
  std::vector<float> positions, uvs;
  std::vector<std::uint32_t> indices;
  strip() {
    for (int i = 0; i < 10; ++i) {
      const auto x = static_cast<float>(i / 2), y = static_cast<float>(i % 2);
      positions.insert(positions.end(), {x, y, x * x * 0.25f});
      uvs.insert(uvs.end(), {x * 0.25f, y});
    }
    for (std::uint32_t i = 0; i < 8; i += 2) indices.insert(indices.end(), {i, i + 2, i + 1, i + 1, i + 2, i + 3});
  }
};

// The strip as a Draco stream in its own buffer view; positions are not quantized.
inline gltf_sketch draco_sketch(int uv_components = 2, bool skinned = false) {
  const strip s;
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(s.indices.size() / 3));
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, static_cast<std::int8_t>(uv_components),
                                      draco::DT_FLOAT32);
  // All corners hang on joint 1 with three times the weight that they have on joint 0.
  const std::array<std::uint16_t, 4> on = {0, 1, 0, 0};
  const std::array<float, 4> by = {0.25f, 0.75f, 0, 0};
  int joints = 0, weights = 0;
  if (skinned) {
    joints = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT16);
    weights = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_FLOAT32);
  }
  for (std::uint32_t t = 0; t < s.indices.size() / 3; ++t) {
    if (skinned) {
      builder.SetAttributeValuesForFace(joints, draco::FaceIndex(t), on.data(), on.data(), on.data());
      builder.SetAttributeValuesForFace(weights, draco::FaceIndex(t), by.data(), by.data(), by.data());
    }
    const auto p = [&](std::uint32_t k) { return &s.positions[3 * s.indices[3 * t + k]]; };
    const auto c = [&](std::uint32_t k) { return &s.uvs[2 * s.indices[3 * t + k]]; };
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(t), p(0), p(1), p(2));
    builder.SetAttributeValuesForFace(uv, draco::FaceIndex(t), c(0), c(1), c(2));
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer bytes;
  if (!encoder.EncodeMeshToBuffer(*mesh, &bytes).ok()) std::abort();

  gltf_sketch g;
  g.json["accessors"] = {{{"componentType", 5126}, {"count", 10}, {"type", "VEC3"}},
                         {{"componentType", 5125}, {"count", 24}, {"type", "SCALAR"}},
                         {{"componentType", 5126}, {"count", 10}, {"type", "VEC2"}}};
  g.json["bufferViews"] = {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", bytes.size()}}};
  g.binary.assign(bytes.data(), bytes.size());
  const nlohmann::json extension = {
      {"bufferView", 0},
      {"attributes",
       {{"POSITION", mesh->attribute(position)->unique_id()}, {"TEXCOORD_0", mesh->attribute(uv)->unique_id()}}}};
  g.json["meshes"] = {{{"primitives",
                        {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 2}}},
                          {"indices", 1},
                          {"extensions", {{"KHR_draco_mesh_compression", extension}}}}}}}};
  g.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {9, 0, 0}}}};
  g.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  if (!skinned) return g;
  nlohmann::json& primitive = g.json["meshes"][0]["primitives"][0];
  for (const auto& [name, attribute] : {std::pair{"JOINTS_0", joints}, std::pair{"WEIGHTS_0", weights}}) {
    primitive["attributes"][name] = g.json["accessors"].size();
    g.json["accessors"].push_back({{"componentType", name[0] == 'J' ? 5123 : 5126}, {"count", 10}, {"type", "VEC4"}});
    primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"][name] = mesh->attribute(attribute)->unique_id();
  }
  g.json["skins"] = {{{"joints", {0, 1}}}};
  g.json["nodes"][0]["skin"] = 0;
  return g;
}
