#pragma once
// Tiny glTF files, put together by a test and written into a folder that lives as long as the test.
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

class temporary_folder {
 public:
  temporary_folder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("sightcell-scene-test-" + std::to_string(getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~temporary_folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  temporary_folder(const temporary_folder&) = delete;
  temporary_folder& operator=(const temporary_folder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
    return file;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string u32_text(std::uint32_t value) {
  std::string out;
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xFFu);
  return out;
}

inline std::string glb_text(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF" + u32_text(2);
  out += u32_text(static_cast<std::uint32_t>(28 + json.size() + binary.size()));
  out += u32_text(static_cast<std::uint32_t>(json.size())) + "JSON" + json;
  out += u32_text(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
  return out;
}

// A document under construction; tests may change `json` as they like before writing.
struct gltf_sketch {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}},
                         {"accessors", nlohmann::json::array()},
                         {"bufferViews", nlohmann::json::array()},
                         {"meshes", nlohmann::json::array()},
                         {"nodes", nlohmann::json::array()}};
  std::string binary;

  template <typename T>
  int add_accessor(const std::vector<T>& values, const std::string& type, int component, std::size_t count) {
    while (binary.size() % 4 != 0) binary += '\0';
    const std::size_t offset = binary.size(), bytes = values.size() * sizeof(T);
    binary.resize(offset + bytes);
    std::memcpy(binary.data() + offset, values.data(), bytes);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  int add_positions(const std::vector<float>& values) { return add_accessor(values, "VEC3", 5126, values.size() / 3); }

  // A mesh of one primitive; indices -1: none.
  int add_mesh(int positions, int indices = -1, int mode = 4) {
    nlohmann::json primitive = {{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
    if (indices >= 0) primitive["indices"] = indices;
    json["meshes"].push_back({{"primitives", nlohmann::json::array({primitive})}});
    return static_cast<int>(json["meshes"].size()) - 1;
  }

  int add_node(const nlohmann::json& node) {
    json["nodes"].push_back(node);
    return static_cast<int>(json["nodes"].size()) - 1;
  }

  // Triangles side by side along x, each one unit wide and starting at x = number: positions tell which is which.
  int add_row_of_triangles(std::size_t count, float first = 0) {
    std::vector<float> positions;
    for (std::size_t i = 0; i < count; ++i) {
      const float x = first + static_cast<float>(i);
      positions.insert(positions.end(), {x, 0, 0, x + 1, 0, 0, x, 1, 0});
    }
    return add_positions(positions);
  }

  // An animation of more than 4 GiB where each accessor has bytes of its own: here, all have the same.
  void add_more_than_a_glb_holds() {
    const std::size_t size = std::size_t{1} << 20;
    const int all = add_accessor(std::vector<std::uint8_t>(size), "SCALAR", 5121, size);
    nlohmann::json samplers = nlohmann::json::array();
    for (std::size_t i = 0; i < 4200; ++i) {
      nlohmann::json accessor = json["accessors"][static_cast<std::size_t>(all)];
      accessor["count"] = size - i;
      json["accessors"].push_back(accessor);
      samplers.push_back({{"input", json["accessors"].size() - 1}});
    }
    json["animations"] = {{{"samplers", samplers}}};
  }

  std::string glb() const {
    nlohmann::json whole = json;
    if (!whole.contains("buffers")) whole["buffers"] = {{{"byteLength", binary.size()}}};
    return glb_text(whole.dump(), binary);
  }
};
