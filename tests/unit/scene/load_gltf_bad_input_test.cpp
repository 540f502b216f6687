// Every way a file can be broken that we know of: one line, the right id, never anything worse.
#include <gtest/gtest.h>

#include <functional>
#include <span>

#include "gltf_sketch.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

std::string id_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const error& e) {
    const std::string line = e.what();
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    EXPECT_LT(line.size(), 700u) << line;
    EXPECT_EQ(e.kind(), error_kind::bad_input) << line;
    return e.id();
  }
  return "none";
}

std::string id_of_bytes(const std::string& bytes) {
  const temporary_folder folder;
  const std::filesystem::path file = folder.write("bad.glb", bytes);
  return id_of([&] { load_gltf(file); });
}

// Two triangles with indices and a texture, one node, one scene; then the change.
std::string id_after(const std::function<void(gltf_sketch&)>& change) {
  gltf_sketch g;
  const int positions = g.add_row_of_triangles(2);
  const int indices = g.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 3, 4, 5}, "SCALAR", 5123, 6);
  g.add_node({{"mesh", g.add_mesh(positions, indices)}});
  g.json["scenes"] = {{{"nodes", {0}}}};
  g.json["buffers"] = {{{"byteLength", g.binary.size()}}};
  change(g);
  return id_of_bytes(g.glb());
}

json& primitive_of(gltf_sketch& g) {
  return g.json["meshes"][0]["primitives"][0];
}

TEST(load_gltf_bad_input, the_sketch_itself_is_fine) {
  EXPECT_EQ(id_after([](gltf_sketch&) {}), "none");
}

TEST(load_gltf_bad_input, containers) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
  const std::string whole = g.glb();
  // Cut anywhere, it is refused. (Cut after the JSON the buffer is what is missing.)
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_NE(id_of_bytes(whole.substr(0, size)), "none") << size;
  EXPECT_EQ(id_of_bytes(""), "scene.truncated");
  EXPECT_EQ(id_of_bytes("glTF"), "scene.truncated");
  EXPECT_EQ(id_of_bytes("glTF" + u32_text(1) + std::string(40, ' ')), "scene.version");
  EXPECT_EQ(id_of_bytes("PK\x03\x04 not a scene"), "scene.not-gltf");
  EXPECT_EQ(id_of_bytes("glTF" + u32_text(2) + u32_text(20) + u32_text(0) + "BIN "), "scene.not-gltf");
  EXPECT_EQ(id_of_bytes("glTF" + u32_text(2) + u32_text(20) + u32_text(0xFFFFFFF0u) + "JSON"), "scene.truncated");
  EXPECT_EQ(id_of_bytes(glb_text("{\"asset\":", "")), "scene.bad-json");
  EXPECT_EQ(id_of_bytes(glb_text("[]", "")), "scene.bad-field");
  EXPECT_EQ(id_of_bytes("{\"asset\":{\"version\":\"1.0\"}}"), "scene.version");
  EXPECT_EQ(id_of_bytes("{\"nodes\":[1e999]}"), "scene.bad-json");
  EXPECT_EQ(id_of_bytes("{\"a\":" + std::string(200000, '[')), "scene.bad-json");
}

TEST(load_gltf_bad_input, files) {
  const temporary_folder folder;
  EXPECT_EQ(id_of([&] { load_gltf(folder.path() / "missing.glb"); }), "scene.not-found");
  EXPECT_EQ(id_of([&] { load_gltf(folder.path()); }), "scene.not-found");
  EXPECT_EQ(id_of([&] { load_gltf("/dev/zero"); }), "scene.not-found");
}

TEST(load_gltf_bad_input, memory_without_a_folder_has_no_files) {
  const temporary_folder folder;
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
  folder.write("beside.bin", g.binary);
  g.json["buffers"] = {{{"byteLength", g.binary.size()}, {"uri", "beside.bin"}}};
  const std::string text = g.json.dump();
  const std::span bytes(reinterpret_cast<const std::byte*>(text.data()), text.size());
  EXPECT_EQ(load_gltf(bytes, "of memory", folder.path()).polygon_count, 1u);
  EXPECT_EQ(id_of([&] { load_gltf(bytes, "of memory"); }), "scene.outside-folder");
  EXPECT_EQ(id_of([&] { load_gltf(std::span<const std::byte>(), "of memory"); }), "scene.truncated");
}

TEST(load_gltf_bad_input, paths_stay_in_the_folder) {
  const auto with_uri = [](const char* uri) {
    return id_after([&](gltf_sketch& g) { g.json["buffers"] = json::array({{{"byteLength", 4}, {"uri", uri}}}); });
  };
  for (const char* uri :
       {"..", "../a.bin", "a/b/../../../c.bin", "%2E%2e%2Fa.bin", "..%2fa.bin", "/etc/passwd", "//host/a.bin",
        "%2Fetc%2Fpasswd", "C:/a.bin", "C:\\a.bin", "C:a.bin", "file:a.bin", "./../a.bin", ""})
    EXPECT_EQ(with_uri(uri), "scene.outside-folder") << uri;
  for (const char* uri : {"..a.bin", "a..bin", "a/../b.bin", "%252e%252e/a.bin", ".../a.bin"})
    EXPECT_EQ(with_uri(uri), "scene.not-found") << uri;
}

// What a few bytes may not ask for, refused before it is allocated.
TEST(load_gltf_bad_input, absurd_sizes) {
  const auto zeros = [](std::uint64_t count) {
    return json({{"componentType", 5126}, {"count", count}, {"type", "VEC3"}});
  };
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["accessors"][0]["count"] = std::uint64_t{1} << 62; }),
            "scene.bad-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["bufferViews"][0]["byteLength"] = std::uint64_t{1} << 62; }),
            "scene.bad-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["bufferViews"][0]["byteLength"] = std::uint64_t{1} << 39; }),
            "scene.buffer-size");
  EXPECT_EQ(id_after([](gltf_sketch& g) {
              g.json["accessors"][0]["sparse"] = {{"count", 4294967295u}, {"indices", {{"bufferView", 0}}}};
            }),
            "scene.bad-field");
  for (const std::uint64_t instances : {std::uint64_t{1} << 31, std::uint64_t{65537}}) {
    EXPECT_EQ(id_after([&](gltf_sketch& g) {
                g.json["accessors"].push_back(zeros(instances));
                g.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", {{"SCALE", 2}}}};
              }),
              "scene.too-large");
  }
  // Each accessor alone would be let in.
  EXPECT_EQ(id_after([&](gltf_sketch& g) {
              for (int i = 0; i < 20; ++i) {
                g.json["accessors"].push_back(zeros(1000000));
                g.add_node({{"mesh", g.add_mesh(2 + i)}});
              }
            }),
            "scene.too-large");
  // The same million of vertices for very many primitives, each with indices of its own.
  EXPECT_EQ(
      id_after([&](gltf_sketch& g) {
        g.json["accessors"].push_back(zeros(8000000));
        json& primitives = g.json["meshes"][0]["primitives"];
        for (std::size_t i = 0; i < 20; ++i) {
          g.json["accessors"].push_back({{"bufferView", 1}, {"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}});
          primitives.push_back({{"attributes", {{"POSITION", 2}}}, {"indices", 3 + i}});
        }
      }),
      "scene.too-large");
}

TEST(load_gltf_bad_input, a_chain_of_very_many_nodes_is_walked) {
  std::string text = "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[";
  constexpr int nodes = 150000;  // a call each would need more than any stack has
  for (int i = 1; i < nodes; ++i) text += "{\"children\":[" + std::to_string(i) + "]},";
  const auto load = [](const std::string& whole) {
    return load_gltf(std::as_bytes(std::span(whole)), "chain").node_names.size();
  };
  EXPECT_EQ(load(text + "{}]}"), static_cast<std::size_t>(nodes));
  EXPECT_EQ(id_of([&] { load(text + "{\"children\":[75000]}]}"); }), "scene.node-cycle");
}

// What nothing reads may be nested as deep as it likes, without using up the stack.
TEST(load_gltf_bad_input, deep_json) {
  constexpr std::size_t depth = 100000;
  std::string objects, ends;
  for (std::size_t i = 0; i < depth; ++i) objects += "{\"a\":", ends += '}';
  const auto load = [](const std::string& value) {
    const std::string text = "{\"extras\":" + value + ",\"nodes\":[{\"extras\":" + value +
                             ",\"extensions\":{\"EXT_other\":" + value + "}}]}";
    return load_gltf(std::as_bytes(std::span(text)), "deep").node_names.size();
  };
  EXPECT_EQ(load(std::string(depth, '[') + std::string(depth, ']')), 1u);
  EXPECT_EQ(load(objects + "0" + ends), 1u);
  EXPECT_EQ(id_of([&] { load(objects); }), "scene.bad-json");
}

TEST(load_gltf_bad_input, buffers) {
  const auto with_buffer = [](const json& buffer) {
    return id_after([&](gltf_sketch& g) { g.json["buffers"] = json::array({buffer}); });
  };
  EXPECT_EQ(with_buffer({{"byteLength", 9223372036854775807}}), "scene.bad-field");
  EXPECT_EQ(with_buffer({{"byteLength", 1000000000}}), "scene.buffer-size");
  EXPECT_EQ(with_buffer({{"byteLength", -1}}), "scene.bad-field");
  EXPECT_EQ(with_buffer({{"byteLength", 0}}), "scene.buffer-size");
  EXPECT_EQ(with_buffer(json::object()), "scene.missing-field");
  EXPECT_EQ(with_buffer(7), "scene.bad-field");
  EXPECT_EQ(with_buffer({{"byteLength", 4}, {"uri", "missing.bin"}}), "scene.not-found");
  EXPECT_EQ(with_buffer({{"byteLength", 1u << 30}, {"uri", "bad.glb"}}), "scene.buffer-size");
  EXPECT_EQ(with_buffer({{"byteLength", 4}, {"uri", "../secret.bin"}}), "scene.outside-folder");
  EXPECT_EQ(with_buffer({{"byteLength", 4}, {"uri", "a/../../secret.bin"}}), "scene.outside-folder");
  EXPECT_EQ(with_buffer({{"byteLength", 4}, {"uri", "%2e%2e/secret.bin"}}), "scene.outside-folder");
  EXPECT_EQ(with_buffer({{"byteLength", 4}, {"uri", "/etc/passwd"}}), "scene.outside-folder");
  EXPECT_EQ(with_buffer({{"byteLength", 4}, {"uri", "file:///etc/passwd"}}), "scene.outside-folder");
  EXPECT_EQ(with_buffer({{"byteLength", 4}, {"uri", "https://example.org/a.bin"}}), "scene.outside-folder");
  EXPECT_EQ(with_buffer({{"byteLength", 4}, {"uri", "a%00.bin"}}), "scene.outside-folder");
  EXPECT_EQ(with_buffer({{"byteLength", 4}, {"uri", "data:application/octet-stream;base64,AA!A"}}), "scene.bad-field");
  EXPECT_EQ(with_buffer({{"byteLength", 40}, {"uri", "data:application/octet-stream;base64,AAAA"}}),
            "scene.buffer-size");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["buffers"] = 3; }), "scene.bad-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["buffers"] = json::array(); }), "scene.index-out-of-range");
}

TEST(load_gltf_bad_input, buffer_views_and_accessors) {
  const auto with = [](const char* section, std::size_t index, const char* key, const json& value) {
    return id_after([&](gltf_sketch& g) { g.json[section][index][key] = value; });
  };
  EXPECT_EQ(with("bufferViews", 0, "buffer", 1), "scene.index-out-of-range");
  EXPECT_EQ(with("bufferViews", 0, "byteOffset", 100000), "scene.buffer-size");
  EXPECT_EQ(with("bufferViews", 0, "byteOffset", 18446744073709551615u), "scene.bad-field");
  EXPECT_EQ(with("bufferViews", 0, "byteStride", 8), "scene.bad-field");
  EXPECT_EQ(with("bufferViews", 0, "byteStride", 13), "scene.bad-field");
  EXPECT_EQ(with("bufferViews", 0, "byteStride", 4096), "scene.bad-field");
  EXPECT_EQ(with("bufferViews", 0, "byteLength", 8), "scene.accessor-bounds");
  EXPECT_EQ(with("accessors", 0, "bufferView", 9), "scene.index-out-of-range");
  EXPECT_EQ(with("accessors", 0, "byteOffset", 4), "scene.accessor-bounds");
  EXPECT_EQ(with("accessors", 0, "count", 7), "scene.accessor-bounds");
  EXPECT_EQ(with("accessors", 0, "count", 4294967295u), "scene.accessor-bounds");
  EXPECT_EQ(with("accessors", 0, "count", 1e300), "scene.bad-field");
  EXPECT_EQ(with("accessors", 0, "count", "six"), "scene.bad-field");
  EXPECT_EQ(with("accessors", 0, "type", "VEC2"), "scene.accessor-type");
  EXPECT_EQ(with("accessors", 0, "type", "MAT4"), "scene.accessor-type");
  EXPECT_EQ(with("accessors", 0, "componentType", 5130), "scene.accessor-type");
  EXPECT_EQ(with("accessors", 0, "componentType", 5124), "scene.accessor-type");
  EXPECT_EQ(with("accessors", 1, "componentType", 5122), "scene.accessor-type");
  EXPECT_EQ(with("accessors", 0, "normalized", 1), "scene.bad-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["accessors"][0].erase("count"); }), "scene.missing-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) {
              g.json["accessors"][0].erase("bufferView");
              g.json["accessors"][0]["count"] = 4000000000u;  // zeros that are in no file
            }),
            "scene.too-large");
}

TEST(load_gltf_bad_input, sparse_accessors) {
  const auto with_sparse = [](const json& sparse) {
    return id_after([&](gltf_sketch& g) { g.json["accessors"][0]["sparse"] = sparse; });
  };
  const json indices = {{"bufferView", 1}, {"componentType", 5123}}, values = {{"bufferView", 0}};
  EXPECT_EQ(with_sparse({{"count", 2}, {"indices", indices}, {"values", values}}), "none");
  EXPECT_EQ(with_sparse({{"count", 7}, {"indices", indices}, {"values", values}}), "scene.bad-field");
  EXPECT_EQ(with_sparse({{"count", 2}, {"values", values}}), "scene.missing-field");
  EXPECT_EQ(with_sparse({{"count", 2}, {"indices", {{"bufferView", 1}, {"componentType", 5126}}}, {"values", values}}),
            "scene.accessor-type");
  EXPECT_EQ(with_sparse({{"count", 6}, {"indices", indices}, {"values", {{"bufferView", 1}}}}),
            "scene.accessor-bounds");
  // Bytes of positions as indices: far beyond the count.
  EXPECT_EQ(with_sparse({{"count", 6},
                         {"indices", {{"bufferView", 0}, {"componentType", 5123}, {"byteOffset", 14}}},
                         {"values", values}}),
            "scene.index-out-of-range");
}

TEST(load_gltf_bad_input, meshes) {
  EXPECT_EQ(id_after([](gltf_sketch& g) { primitive_of(g)["mode"] = 7; }), "scene.bad-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) { primitive_of(g)["mode"] = -1; }), "scene.bad-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) { primitive_of(g)["indices"] = 2; }), "scene.index-out-of-range");
  EXPECT_EQ(id_after([](gltf_sketch& g) { primitive_of(g)["material"] = 0; }), "scene.index-out-of-range");
  EXPECT_EQ(id_after([](gltf_sketch& g) { primitive_of(g)["attributes"]["POSITION"] = 5; }),
            "scene.index-out-of-range");
  EXPECT_EQ(id_after([](gltf_sketch& g) { primitive_of(g)["attributes"]["POSITION"] = 1; }), "scene.accessor-type");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["meshes"][0]["primitives"] = 1; }), "scene.bad-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.binary[g.binary.size() - 2] = 6; }), "scene.index-out-of-range");
  EXPECT_EQ(id_after([](gltf_sketch& g) {
              g.json["accessors"].push_back({{"componentType", 5126}, {"count", 5}, {"type", "VEC2"}});
              primitive_of(g)["attributes"]["TEXCOORD_0"] = 2;
            }),
            "scene.bad-field");
}

TEST(load_gltf_bad_input, nodes_and_scenes) {
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["nodes"][0]["mesh"] = 1; }), "scene.index-out-of-range");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["nodes"][0]["children"] = {1}; }), "scene.index-out-of-range");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["nodes"][0]["children"] = {0}; }), "scene.node-cycle");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["nodes"][0]["matrix"] = {1, 2, 3}; }), "scene.bad-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["nodes"][0]["scale"] = {1, 2, "3"}; }), "scene.bad-field");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["scene"] = 1; }), "scene.index-out-of-range");
  EXPECT_EQ(id_after([](gltf_sketch& g) { g.json["scenes"][0]["nodes"] = {0, 0}; }), "scene.node-cycle");
  EXPECT_EQ(id_after([](gltf_sketch& g) {
              g.json["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
              g.json.erase("scenes");
            }),
            "scene.node-cycle");
  // A binary tree in which both children are the same node would be 2^40 visits.
  EXPECT_EQ(id_after([](gltf_sketch& g) {
              for (int i = 0; i < 40; ++i)
                g.json["nodes"][static_cast<std::size_t>(i)] = {{"children", {i + 1, i + 1}}};
              g.json["nodes"].push_back({{"mesh", 0}});
            }),
            "scene.node-cycle");
}

TEST(load_gltf_bad_input, extensions) {
  for (const char* name : {"KHR_meshopt_compression", "KHR_node_of_the_future", "CESIUM_RTC", "KHR_gaussian_splatting",
                           "KHR_materials", "ACME_materials_gold", "ACME_other\nworld"}) {
    EXPECT_EQ(id_after([&](gltf_sketch& g) { g.json["extensionsRequired"] = {name}; }), "scene.extension");
  }
  const auto with_instancing = [](const json& attributes) {
    return id_after([&](gltf_sketch& g) {
      g.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", attributes}};
    });
  };
  EXPECT_EQ(with_instancing({{"TRANSLATION", 0}}), "none");
  EXPECT_EQ(with_instancing(json::object()), "scene.missing-field");
  EXPECT_EQ(with_instancing({{"TRANSLATION", 9}}), "scene.index-out-of-range");
  EXPECT_EQ(with_instancing({{"ROTATION", 0}}), "scene.accessor-type");
  EXPECT_EQ(id_after([](gltf_sketch& g) {
              g.json["accessors"].push_back({{"componentType", 5126}, {"count", 5}, {"type", "VEC3"}});
              g.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {
                  {"attributes", {{"TRANSLATION", 0}, {"SCALE", 2}}}};
            }),
            "scene.bad-field");
  // Zeros cost a file nothing: sixteen million instances of two polygons each are too many draws.
  EXPECT_EQ(id_after([](gltf_sketch& g) {
              g.json["accessors"].push_back({{"componentType", 5126}, {"count", 16000000}, {"type", "VEC3"}});
              g.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", {{"SCALE", 2}}}};
            }),
            "scene.too-large");
}

TEST(load_gltf_bad_input, what_is_not_used_is_not_checked) {
  EXPECT_EQ(id_after([](gltf_sketch& g) {
              g.json["accessors"].push_back({{"type", "of no kind"}});
              g.json["bufferViews"].push_back({{"buffer", 99}});
              g.json["buffers"].push_back({{"uri", "animation.bin"}, {"byteLength", 1u << 30}});
              g.json["cameras"] = "none";
              g.json["skins"] = {{{"joints", {77}}}};
            }),
            "none");
}

}  // namespace
}  // namespace sightcell::scene
