#pragma once
// A packed .glb as a host sees it that knows glTF and nothing of us; and orders to pack in.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "sightcell/scene/pack.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// Groups as a bake makes them, each in an order of its own: from the back, with steps of 7.
inline packed_order some_order(const scene& s) {
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> groups;
  packed_order order;
  for (std::uint32_t i = 0; i < s.draws.size(); ++i) {
    const draw& d = s.draws[i];
    const std::tuple key(d.material, d.tags.group, d.lod_object, d.lod_level, d.moves ? i + 1 : 0);
    const auto [known, added] = groups.try_emplace(key, static_cast<std::uint32_t>(groups.size()));
    if (added) order.groups.emplace_back();
    order.groups[known->second].draws.push_back(i);
    order.groups[known->second].moves = d.moves;
  }
  std::reverse(order.groups.begin(), order.groups.end());
  for (packed_group& group : order.groups) {
    group.first_stored = static_cast<std::uint32_t>(order.source_of_stored.size());
    std::vector<std::uint32_t> ids;
    for (const std::uint32_t number : group.draws)
      for (std::uint32_t i = 0; i < s.draws[number].polygon_count; ++i) ids.push_back(s.draws[number].first_source + i);
    std::reverse(ids.begin(), ids.end());
    for (std::size_t first = 0; first < 7; ++first)
      for (std::size_t i = first; i < ids.size(); i += 7) order.source_of_stored.push_back(ids[i]);
    group.polygon_count = static_cast<std::uint32_t>(ids.size());
  }
  return order;
}

class packed_file {
 public:
  explicit packed_file(std::vector<std::byte> glb) : glb_(std::move(glb)) {
    const std::size_t json_bytes = u32_at(12);
    EXPECT_EQ(u32_at(8), glb_.size());
    json = nlohmann::json::parse(reinterpret_cast<const char*>(&glb_[20]),
                                 reinterpret_cast<const char*>(&glb_[20]) + json_bytes);
    begin_ = 20 + json_bytes + 8;
    EXPECT_EQ(json["buffers"][0]["byteLength"], u32_at(20 + json_bytes));
    EXPECT_FALSE(json["buffers"][0].contains("uri"));
  }

  const std::vector<std::byte>& bytes() const { return glb_; }
  scene loaded() const { return load_gltf(glb_, "packed.glb"); }

  template <typename T>
  std::vector<T> numbers(std::size_t accessor) const {
    const nlohmann::json& a = json["accessors"].at(accessor);
    const nlohmann::json& v = json["bufferViews"].at(a["bufferView"].get<std::size_t>());
    const std::string type = a["type"];
    const std::size_t width = type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
    std::vector<T> out(a["count"].get<std::size_t>() * width);
    const std::size_t offset = v["byteOffset"].get<std::size_t>() + a.value("byteOffset", std::size_t{0});
    if (!out.empty()) std::memcpy(out.data(), &glb_.at(begin_ + offset), out.size() * sizeof(T));
    return out;
  }
  // Of group n, which is node n.
  const nlohmann::json& primitive(std::size_t group) const {
    return json["meshes"].at(json["nodes"].at(group)["mesh"].get<std::size_t>())["primitives"].at(0);
  }
  std::vector<float> attribute(std::size_t group, const char* name) const {
    return numbers<float>(primitive(group)["attributes"].at(name).get<std::size_t>());
  }
  std::vector<std::uint32_t> indices(std::size_t group) const {
    return numbers<std::uint32_t>(primitive(group)["indices"].get<std::size_t>());
  }
  std::vector<std::byte> view(std::size_t number) const {
    const nlohmann::json& v = json["bufferViews"].at(number);
    const auto from = glb_.begin() + static_cast<std::ptrdiff_t>(begin_ + v["byteOffset"].get<std::size_t>());
    return {from, from + static_cast<std::ptrdiff_t>(v["byteLength"].get<std::size_t>())};
  }

  nlohmann::json json;

 private:
  std::uint32_t u32_at(std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, &glb_.at(at), 4);
    return value;
  }
  std::vector<std::byte> glb_;
  std::size_t begin_ = 0;
};

// What does not move is flatten()'s, number by number and bit by bit; all of it is where flatten() has it once the file
// is loaded.
inline void expect_flattened(const scene& s, const packed_order& order, const packed_file& file) {
  const world_geometry world = flatten(s);
  const scene again = file.loaded();
  ASSERT_EQ(again.polygon_count, s.polygon_count);
  const world_geometry packed = flatten(again);
  std::uint32_t stored = 0;
  for (std::size_t g = 0; g < order.groups.size(); ++g) {
    const packed_group& group = order.groups[g];
    const std::vector<std::uint32_t> indices = file.indices(g);
    ASSERT_EQ(indices.size(), std::size_t{group.polygon_count} * 3);
    ASSERT_EQ(group.first_stored, stored);
    const auto drawn = std::find_if(again.draws.begin(), again.draws.end(), [g](const draw& d) { return d.node == g; });
    ASSERT_NE(drawn, again.draws.end());
    ASSERT_EQ(drawn->polygon_count, group.polygon_count);
    ASSERT_EQ(drawn->material, s.draws[group.draws[0]].material);
    std::size_t different = 0, elsewhere = 0;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const std::size_t from = 3 * std::size_t{order.source_of_stored[stored + i / 3]} + i % 3;
      if (!group.moves && indices[i] != world.indices[from]) ++different;
      const glm::vec3 there = packed.positions[packed.indices[3 * std::size_t{drawn->first_source} + i]];
      if (there != world.positions[world.indices[from]]) ++elsewhere;
    }
    EXPECT_EQ(different, 0u) << "indices of group " << g;
    EXPECT_EQ(elsewhere, 0u) << "corners of group " << g;
    stored += group.polygon_count;
  }
  EXPECT_EQ(stored, s.polygon_count);
}

}  // namespace sightcell::scene
