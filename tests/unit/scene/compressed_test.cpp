// Draco and meshopt streams, made with the libraries' own encoders.
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <functional>
#include <span>

#include "draco_sketch.h"
#include "loaded_sketch.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"
#include "sightcell/scene/strip.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

// The corners of all triangles as a sorted list: codecs may turn triangles and number vertices anew.
std::vector<std::vector<float>> triangles_of(const scene& s) {
  std::vector<std::vector<float>> out;
  const geometry& g = s.geometries.at(0);
  for (std::size_t t = 0; t < g.indices.size(); t += 3) {
    std::size_t first = 0;  // the same triangle begins with its smallest corner
    const auto corner = [&](std::size_t k) {
      const std::uint32_t v = g.indices[t + k % 3];
      std::vector<float> c = {g.positions[v].x, g.positions[v].y, g.positions[v].z};
      if (!g.uvs.empty()) c.insert(c.end(), {g.uvs[v].x, g.uvs[v].y});
      return c;
    };
    for (std::size_t k = 1; k < 3; ++k)
      if (corner(k) < corner(first)) first = k;
    std::vector<float> all;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto c = corner(first + k);
      all.insert(all.end(), c.begin(), c.end());
    }
    out.push_back(std::move(all));
  }
  std::sort(out.begin(), out.end());
  return out;
}

gltf_sketch plain() {
  const strip s;
  gltf_sketch g;
  const int positions = g.add_positions(s.positions);
  const int indices = g.add_accessor(s.indices, "SCALAR", 5125, s.indices.size());
  const int uvs = g.add_accessor(s.uvs, "VEC2", 5126, s.uvs.size() / 2);
  g.json["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}, {"indices", indices}}}}}};
  g.json["nodes"] = {{{"mesh", 0}}};
  return g;
}

std::string refusal_line(const gltf_sketch& sketch) {
  const std::string bytes = sketch.glb();
  try {
    load_gltf(std::as_bytes(std::span(bytes)), "sketch");
  } catch (const error& e) {
    return e.what();
  }
  return "none";
}

// Replaces the bytes of a buffer view by a compressed stream at the end of the buffer.
void compress_view(gltf_sketch& g, std::size_t view, std::vector<unsigned char> bytes, const char* mode,
                   std::size_t count, std::size_t stride, const char* filter = nullptr) {
  while (g.binary.size() % 4 != 0) g.binary += '\0';
  json extension = {{"buffer", 0},    {"byteOffset", g.binary.size()}, {"byteLength", bytes.size()},
                    {"count", count}, {"byteStride", stride},          {"mode", mode}};
  if (filter != nullptr) extension["filter"] = filter;
  g.binary.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  json& v = g.json["bufferViews"][view];
  v = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
  if (std::string(mode) == "ATTRIBUTES") v["byteStride"] = stride;
  // The fallback buffer that such files have: no bytes behind it.
  g.json["buffers"] = {{{"byteLength", g.binary.size()}}, {{"byteLength", 1000}}};
}

gltf_sketch meshopt(const char* index_mode) {
  const strip s;
  gltf_sketch g = plain();
  std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(10, 12));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), s.positions.data(), 10, 12));
  compress_view(g, 0, bytes, "ATTRIBUTES", 10, 12);
  if (std::string(index_mode) == "TRIANGLES") {
    bytes.resize(meshopt_encodeIndexBufferBound(s.indices.size(), 10));
    bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), s.indices.data(), s.indices.size()));
  } else {
    bytes.resize(meshopt_encodeIndexSequenceBound(s.indices.size(), 10));
    bytes.resize(meshopt_encodeIndexSequence(bytes.data(), bytes.size(), s.indices.data(), s.indices.size()));
  }
  compress_view(g, 1, bytes, index_mode, s.indices.size(), 4);
  g.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  return g;
}

TEST(meshopt, attributes_and_both_kinds_of_indices) {
  const auto expected = triangles_of(load(plain()));
  ASSERT_EQ(expected.size(), 8u);
  EXPECT_EQ(triangles_of(load(meshopt("TRIANGLES"))), expected);
  EXPECT_EQ(triangles_of(load(meshopt("INDICES"))), expected);
}

TEST(meshopt, a_stripped_file_is_plain) {
  const temporary_folder folder;
  gltf_stripper stripper(folder.write("sketch.glb", meshopt("TRIANGLES").glb()));
  std::vector<std::string> warnings;
  const scene left =
      load_gltf(stripper.strip({false, true, false, false, false, false, true, false}, warnings).glb, "");
  auto expected = triangles_of(load(plain()));
  expected.erase(expected.begin() + 6);
  expected.erase(expected.begin() + 1);
  EXPECT_EQ(triangles_of(left), expected);
  EXPECT_TRUE(left.extensions.empty());
}

TEST(meshopt, the_exponential_filter) {
  const strip s;
  gltf_sketch g = plain();
  std::vector<float> filtered(s.positions.size());
  meshopt_encodeFilterExp(filtered.data(), 10, 12, 24, s.positions.data());
  std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(10, 12));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), filtered.data(), 10, 12));
  compress_view(g, 0, bytes, "ATTRIBUTES", 10, 12, "EXPONENTIAL");
  const auto expected = triangles_of(load(plain())), got = triangles_of(load(g));
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t t = 0; t < got.size(); ++t)
    for (std::size_t k = 0; k < got[t].size(); ++k) EXPECT_NEAR(got[t][k], expected[t][k], 1e-5);
}

TEST(meshopt, broken_streams_are_refused) {
  const auto after = [](const std::function<void(gltf_sketch&, json&)>& change) {
    gltf_sketch g = meshopt("TRIANGLES");
    change(g, g.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]);
    return refusal(g);
  };
  EXPECT_EQ(after([](gltf_sketch&, json&) {}), "none");
  EXPECT_EQ(after([](gltf_sketch&, json& e) { e["mode"] = "SOMETHING"; }), "scene.meshopt");
  EXPECT_EQ(after([](gltf_sketch&, json& e) { e["filter"] = "SOMETHING"; }), "scene.meshopt");
  EXPECT_EQ(after([](gltf_sketch&, json& e) { e["filter"] = "QUATERNION"; }), "scene.meshopt") << "needs a stride of 8";
  EXPECT_EQ(after([](gltf_sketch&, json& e) { e["byteStride"] = 6; }), "scene.meshopt");
  EXPECT_EQ(after([](gltf_sketch&, json& e) { e["byteLength"] = 20; }), "scene.meshopt") << "cut short";
  EXPECT_EQ(after([](gltf_sketch&, json& e) { e["byteLength"] = 1 << 20; }), "scene.buffer-size");
  EXPECT_EQ(after([](gltf_sketch&, json& e) { e["count"] = 4'000'000'000u; }), "scene.meshopt") << "48 GB";
  EXPECT_EQ(after([](gltf_sketch&, json& e) { e["count"] = 9; }), "scene.buffer-size") << "fewer than the view has";
  EXPECT_EQ(after([](gltf_sketch&, json& e) { e.erase("count"); }), "scene.missing-field");
  EXPECT_EQ(after([](gltf_sketch& g, json&) {
              g.json["bufferViews"][1]["extensions"]["EXT_meshopt_compression"]["count"] = 23;
            }),
            "scene.meshopt");
}

json& draco_extension(gltf_sketch& g) {
  return g.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
}

TEST(draco, triangles_and_coordinates_come_back) {
  const scene s = load(draco_sketch());
  EXPECT_EQ(s.polygon_count, 16u) << "two nodes";
  EXPECT_EQ(s.geometries.size(), 1u) << "decoded once";
  EXPECT_EQ(triangles_of(s), triangles_of(load(plain())));
}

TEST(draco, joints_and_weights_come_back) {
  const scene s = load(draco_sketch(2, true));
  ASSERT_EQ(s.geometries.size(), 2u) << "bent and not";
  const geometry &bent = s.geometries[s.draws[0].geometry], &rests = s.geometries[s.draws[1].geometry];
  ASSERT_EQ(bent.positions.size(), rests.positions.size());
  // Joint 1 stands 9 to the right of where it was bound.
  for (std::size_t i = 0; i < bent.positions.size(); ++i)
    EXPECT_NEAR(bent.positions[i].x, rests.positions[i].x + 6.75f, 1e-5f);
}

TEST(draco, primitives_of_one_stream_share_their_geometry) {
  gltf_sketch g = draco_sketch();
  g.json["meshes"].push_back(g.json["meshes"][0]);
  g.json["nodes"][1]["mesh"] = 1;
  EXPECT_EQ(load(g).geometries.size(), 1u);
}

TEST(draco, broken_streams_are_refused) {
  const auto after = [](const std::function<void(gltf_sketch&)>& change) {
    gltf_sketch g = draco_sketch();
    change(g);
    return refusal(g);
  };
  EXPECT_EQ(after([](gltf_sketch&) {}), "none");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["bufferViews"][0]["byteLength"] = 30; }), "scene.draco");
  EXPECT_EQ(after([](gltf_sketch& g) { g.binary[0] = 'X'; }), "scene.draco");
  EXPECT_EQ(after([](gltf_sketch& g) { draco_extension(g)["attributes"]["POSITION"] = 77; }), "scene.draco");
  EXPECT_EQ(after([](gltf_sketch& g) { draco_extension(g)["attributes"].erase("POSITION"); }), "scene.missing-field");
  EXPECT_EQ(after([](gltf_sketch& g) { draco_extension(g)["bufferView"] = 5; }), "scene.index-out-of-range");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["accessors"][1]["count"] = 27; }), "scene.draco") << "promises more";
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["accessors"][0]["count"] = 9; }), "scene.draco");
  EXPECT_EQ(refusal(draco_sketch(1)), "scene.draco") << "texture coordinates of one component";
}

// Draco would allocate what the header says: here two billion triangles and points in 200 bytes.
TEST(draco, absurd_promises_are_refused_before_decoding) {
  const std::string many = "\xFF\xFF\xFF\xFF\x03";  // a varint
  const auto after = [&](int method) {
    gltf_sketch g = draco_sketch();
    g.binary = std::string("DRACO\x02\x02\x01", 8) + static_cast<char>(method) + std::string(2, '\0');
    if (method == draco::MESH_EDGEBREAKER_ENCODING) g.binary += '\0';
    g.binary += many + many + std::string(200, '\0');
    g.json["bufferViews"][0]["byteLength"] = g.binary.size();
    return refusal_line(g);
  };
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING})
    EXPECT_NE(after(method).find("it claims 2147483646 triangles and points in 2"), std::string::npos) << after(method);
  gltf_sketch old = draco_sketch();
  old.binary[6] = 1;
  EXPECT_NE(refusal_line(old).find("its bitstream is 2.1, and glTF has 2.2"), std::string::npos) << refusal_line(old);
}

TEST(draco, the_same_bytes_are_not_decoded_for_ever) {
  gltf_sketch g = draco_sketch();
  g.binary += std::string(100000, '\0');  // behind the stream: Draco does not mind
  g.json["bufferViews"] = json::array();
  json& primitives = g.json["meshes"][0]["primitives"];
  for (std::size_t i = 0; i < 50; ++i) {
    g.json["bufferViews"].push_back({{"buffer", 0}, {"byteLength", g.binary.size() - i}});
    if (i > 0) primitives.push_back(primitives[0]);
    primitives[i]["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = i;
  }
  EXPECT_EQ(refusal(g), "scene.too-large");
}

// Every byte of the stream flipped, and the stream cut at every length: a scene or one line.
TEST(draco, damage_anywhere_ends_in_a_scene_or_one_line) {
  const gltf_sketch fine = draco_sketch();
  std::size_t refused = 0;
  for (std::size_t i = 0; i < fine.binary.size(); ++i) {
    gltf_sketch g = fine;
    g.binary[i] = static_cast<char>(g.binary[i] ^ 0x55);
    refused += refusal(g) != "none";
    g = fine;
    g.json["bufferViews"][0]["byteLength"] = i;
    refused += refusal(g) != "none";
  }
  EXPECT_GT(refused, fine.binary.size());
}

}  // namespace
}  // namespace sightcell::scene
