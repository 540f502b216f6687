#include "city.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include "glb_writer.h"
#include "sightcell/scene/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::city {
namespace {

class written_city {
 public:
  written_city(std::uint64_t polygons, std::uint64_t seed) : model_(make_city(polygons, seed)) {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("sightcell-city-test-" + std::to_string(getpid()) + "-" + std::to_string(count++) + ".glb");
    write_glb(model_, path_);
  }
  ~written_city() { std::filesystem::remove(path_); }
  written_city(const written_city&) = delete;
  written_city& operator=(const written_city&) = delete;

  const model& made() const { return model_; }
  scene::scene load() const { return scene::load_gltf(path_); }
  std::string bytes() const {
    std::ifstream stream(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  model model_;
  std::filesystem::path path_;
};

bool is_open_on_purpose(surface material) {
  return material == surface::glass || material == surface::fence || material == surface::road;
}

TEST(city, has_exactly_as_many_polygons_as_asked_for) {
  for (const std::uint64_t polygons : {500, 501, 777, 1000, 2999, 3999, 4000, 4001, 12345, 100000}) {
    const scene::scene s = written_city(polygons, 1).load();
    EXPECT_EQ(s.polygon_count, polygons);
    EXPECT_TRUE(s.warnings.empty());
    const scene::world_geometry w = scene::flatten(s);
    for (const scene::polygon_kind kind : w.kinds) ASSERT_FALSE(kind.degenerate);
  }
}

TEST(city, every_number_and_seed_has_a_town) {
  for (std::uint64_t polygons = 500; polygons < 30000; polygons += 397) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) EXPECT_NO_THROW(make_city(polygons, seed * 1000003)) << polygons;
  }
}

TEST(city, the_same_numbers_give_the_same_bytes) {
  const std::string first = written_city(20000, 7).bytes();
  EXPECT_EQ(first, written_city(20000, 7).bytes());
  EXPECT_NE(first, written_city(20000, 8).bytes());
}

TEST(city, a_pinned_town_is_the_same_on_every_machine) {
  const scene::scene s = written_city(5000, 1).load();
  std::string print;
  for (const std::uint8_t byte : s.fingerprint) {
    print += "0123456789abcdef"[byte >> 4];
    print += "0123456789abcdef"[byte & 15];
  }
  EXPECT_EQ(print, "782726737c728cbb6744ce5c0be15405");
}

// Some of a grid of points on some polygon lies in the cell.
bool reaches_into(const scene::world_geometry& w, const named_cell& cell) {
  for (std::size_t i = 0; i < w.indices.size(); i += 3) {
    const glm::dvec3 a(w.positions[w.indices[i]]), b(w.positions[w.indices[i + 1]]), c(w.positions[w.indices[i + 2]]);
    if (glm::any(glm::lessThan(glm::max(a, glm::max(b, c)), cell.min)) ||
        glm::any(glm::greaterThan(glm::min(a, glm::min(b, c)), cell.max))) {
      continue;
    }
    for (int u = 0; u <= 16; ++u) {
      for (int v = 0; u + v <= 16; ++v) {
        const glm::dvec3 p = a + (b - a) * (u / 16.0) + (c - a) * (v / 16.0);
        if (glm::all(glm::greaterThan(p, cell.min)) && glm::all(glm::lessThan(p, cell.max))) return true;
      }
    }
  }
  return false;
}

// Every edge of a closed shell is walked once in each direction; outward winding makes its volume positive.
TEST(city, shells_are_closed_and_face_outward) {
  const model city = make_city(100000, 1);
  std::size_t shells = 0;
  for (const mesh& m : city.meshes) {
    using corner = std::array<float, 3>;
    std::map<std::pair<corner, corner>, int> edges;
    double volume = 0;
    for (const primitive& p : m.primitives()) {
      if (is_open_on_purpose(p.material)) continue;
      for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        std::array<corner, 3> t;
        std::array<glm::dvec3, 3> v;
        for (std::size_t k = 0; k < 3; ++k) {
          t[k] = p.positions[p.indices[i + k]];
          v[k] = {t[k][0], t[k][1], t[k][2]};
        }
        volume += glm::dot(v[0], glm::cross(v[1], v[2]));
        for (std::size_t k = 0; k < 3; ++k) {
          ++edges[{t[k], t[(k + 1) % 3]}];
          --edges[{t[(k + 1) % 3], t[k]}];
        }
      }
    }
    if (edges.empty()) continue;
    ++shells;
    EXPECT_GT(volume, 0.0) << m.name();
    for (const auto& [edge, balance] : edges) ASSERT_EQ(balance, 0) << m.name();
  }
  EXPECT_GT(shells, 100u);
}

TEST(city, cells_are_free_of_houses_and_some_hold_a_tree) {
  const written_city city(100000, 1);
  const scene::scene s = city.load();
  const scene::world_geometry w = scene::flatten(s);
  ASSERT_EQ(city.made().cells.size(), 20u);
  std::size_t with_geometry = 0;
  for (const named_cell& cell : city.made().cells) {
    const glm::dvec3 size = cell.max - cell.min;
    EXPECT_GE(size.x * size.z, 10.0) << cell.name;
    EXPECT_LE(size.x, 8.01) << cell.name;
    EXPECT_EQ(reaches_into(w, cell), cell.has_tree) << cell.name;
    if (cell.has_tree) ++with_geometry;
  }
  EXPECT_GE(with_geometry, 4u);
}

TEST(city, numbers_out_of_range_are_refused) {
  for (const std::uint64_t polygons : {std::uint64_t{0}, fewest_polygons - 1, most_polygons + 1}) {
    try {
      make_city(polygons, 1);
      FAIL() << polygons;
    } catch (const error& e) {
      EXPECT_EQ(e.kind(), error_kind::wrong_use);
      EXPECT_EQ(e.id(), "city.polygons");
    }
  }
}

}  // namespace
}  // namespace sightcell::city
