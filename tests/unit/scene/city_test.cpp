#include "city.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "glb_writer.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::city {
namespace {

class written_city {
 public:
  written_city(std::uint64_t polygons, std::uint64_t seed) : written_city(make_city(polygons, seed)) {}
  explicit written_city(model made, bool textured = false) : model_(std::move(made)) {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("sightcell-city-test-" + std::to_string(getpid()) + "-" + std::to_string(count++) + ".glb");
    write_glb(model_, path_, textured);
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
  switch (material) {
    case surface::glass:
    case surface::fence:
    case surface::road:
    case surface::foliage:
    case surface::litter:
    case surface::cloth:
    case surface::panel_light:
    case surface::panel_grey:
    case surface::panel_rose:
    case surface::panel_dark:
      return true;
    default:
      return false;
  }
}

TEST(city, has_exactly_as_many_polygons_as_asked_for) {
  for (const std::uint64_t polygons : {500, 501, 777, 1000, 2999, 3999, 4000, 4001, 12345, 100000}) {
    const scene::scene s = written_city(polygons, 1).load();
    EXPECT_EQ(s.polygon_count, polygons);
    EXPECT_TRUE(s.warnings.empty());
    const scene::world_geometry w = scene::flatten(s);
    for (const scene::polygon_kind kind : w.kinds) ASSERT_FALSE(kind.absent);
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

std::string fingerprint_of(const written_city& city) {
  std::string print;
  for (const std::uint8_t byte : city.load().fingerprint) {
    print += "0123456789abcdef"[byte >> 4];
    print += "0123456789abcdef"[byte & 15];
  }
  return print;
}

TEST(city, a_pinned_town_is_the_same_on_every_machine) {
  EXPECT_EQ(fingerprint_of(written_city(5000, 1)), "782726737c728cbb6744ce5c0be15405");
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
std::size_t count_closed_shells(const model& city) {
  std::size_t shells = 0;
  for (const mesh& m : city.meshes) {
    if (m.name() == "ground" || m.name() == "outer ground") continue;  // open below
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
    const auto open = std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 0; });
    EXPECT_EQ(open, 0) << m.name();
  }
  return shells;
}

TEST(city, shells_are_closed_and_face_outward) {
  EXPECT_GT(count_closed_shells(make_city(100000, 1)), 100u);
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

const style& preset(const char* name) {
  const style* s = find_preset(name);
  if (s == nullptr) throw std::logic_error(name);
  return *s;
}

TEST(town, presets_have_the_polygons_of_the_scenes_they_stand_for) {
  EXPECT_EQ(preset("vienna800k").polygons, 865979u);
  EXPECT_EQ(preset("vienna8m").polygons, 7928519u);
  EXPECT_EQ(preset("hongkong").polygons, 2164567u);
  EXPECT_EQ(find_preset("vienna"), nullptr);
}

TEST(town, has_exactly_as_many_polygons_as_asked_for) {
  for (const char* name : {"vienna800k", "hongkong"}) {
    for (const std::uint64_t polygons : {150000, 150001, 271828}) {
      for (const std::uint64_t seed : {1, 2}) {
        const scene::scene s = written_city(make_town(preset(name), polygons, seed)).load();
        EXPECT_EQ(s.polygon_count, polygons) << name;
        EXPECT_TRUE(s.warnings.empty());
        if (seed == 2) continue;
        const scene::world_geometry w = scene::flatten(s);
        for (const scene::polygon_kind kind : w.kinds) ASSERT_FALSE(kind.absent) << name;
      }
    }
  }
}

TEST(town, the_same_numbers_give_the_same_bytes) {
  for (const char* name : {"vienna800k", "hongkong"}) {
    const std::string first = written_city(make_town(preset(name), 150000, 7)).bytes();
    EXPECT_TRUE(first == written_city(make_town(preset(name), 150000, 7)).bytes());
    EXPECT_FALSE(first == written_city(make_town(preset(name), 150000, 8)).bytes());
  }
}

TEST(town, pinned_towns_are_the_same_on_every_machine) {
  EXPECT_EQ(fingerprint_of(written_city(make_town(preset("vienna800k"), 150000, 1))),
            "bd3b9a3249fa08e71afe7eb7c2eb9f56");
  EXPECT_EQ(fingerprint_of(written_city(make_town(preset("hongkong"), 150000, 1))), "007d47aedebc8b7a1ffacc20289d0f34");
}

TEST(town, too_few_polygons_are_refused) {
  try {
    make_town(preset("vienna800k"), 5000, 1);
    FAIL();
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "city.no-plan");
  }
}

TEST(town, shells_are_closed_and_face_outward) {
  EXPECT_GT(count_closed_shells(make_town(preset("vienna800k"), 150000, 1)), 50u);
  EXPECT_GT(count_closed_shells(make_town(preset("hongkong"), 300000, 1)), 30u);
}

TEST(town, textures_change_no_polygon) {
  const scene::scene bare = written_city(make_town(preset("vienna800k"), 150000, 1)).load();
  const scene::scene rich = written_city(make_town(preset("vienna800k"), 150000, 1), true).load();
  const scene::world_geometry a = scene::flatten(bare), b = scene::flatten(rich);
  EXPECT_TRUE(a.positions == b.positions);
  EXPECT_TRUE(a.indices == b.indices);
  EXPECT_TRUE(bare.images.empty());
  EXPECT_TRUE(rich.warnings.empty());
  std::size_t cut_outs = 0;
  for (const scene::draw& d : rich.draws) {
    const scene::geometry& g = rich.geometries[d.geometry];
    ASSERT_EQ(g.uvs.size(), g.positions.size());
    const scene::material& m = rich.materials[d.material];
    ASSERT_LT(m.base_color_image, rich.images.size()) << m.name;
    const std::vector<std::uint8_t>& png = rich.images[m.base_color_image].encoded;
    ASSERT_GT(png.size(), 8u);
    EXPECT_EQ(png[1], 'P');
    if (m.alpha != scene::alpha_mode::mask) continue;
    ++cut_outs;
    // A quad takes the whole texture: each of its triangles covers half of it.
    for (std::size_t i = 0; i < g.indices.size(); i += 3) {
      const glm::vec2 u = g.uvs[g.indices[i + 1]] - g.uvs[g.indices[i]];
      const glm::vec2 v = g.uvs[g.indices[i + 2]] - g.uvs[g.indices[i]];
      ASSERT_EQ(std::abs(u.x * v.y - u.y * v.x), 1.0f) << m.name;
    }
  }
  EXPECT_GT(cut_outs, 0u);
}

// A town large enough for bridges, squares and all kinds of cells.
const written_city& old_town() {
  static const written_city town(make_town(preset("vienna800k"), 490000, 1));
  return town;
}

TEST(town, cells_say_where_they_are_and_are_free) {
  const scene::world_geometry w = scene::flatten(old_town().load());
  const std::vector<named_cell>& cells = old_town().made().cells;
  ASSERT_EQ(cells.size(), 20u);
  std::size_t with_geometry = 0;
  for (const named_cell& cell : cells) {
    EXPECT_EQ(reaches_into(w, cell), cell.has_tree) << cell.name;
    if (cell.has_tree) ++with_geometry;
  }
  EXPECT_GE(with_geometry, 4u);
  for (const char* kind : {"crossroads 1", "lane 1", "square 1", "on bridge 1", "under bridge 1", "passage 1"}) {
    EXPECT_TRUE(std::any_of(cells.begin(), cells.end(), [&](const named_cell& c) { return c.name == kind; })) << kind;
  }
}

// Of the polygons that a vertical line through the place meets: the highest below it and the lowest above it.
std::array<double, 2> floor_and_ceiling(const scene::world_geometry& w, const glm::dvec3& place) {
  double below = -1e30, above = 1e30;
  for (std::size_t i = 0; i < w.indices.size(); i += 3) {
    const glm::dvec3 a(w.positions[w.indices[i]]), b(w.positions[w.indices[i + 1]]), c(w.positions[w.indices[i + 2]]);
    const glm::dvec3 n = glm::cross(b - a, c - a);
    if (std::abs(n.y) < 1e-9) continue;
    const auto side = [&](const glm::dvec3& from, const glm::dvec3& to) {
      return (to.x - from.x) * (place.z - from.z) - (to.z - from.z) * (place.x - from.x);
    };
    const double u = side(a, b), v = side(b, c), t = side(c, a);
    if (!((u >= 0 && v >= 0 && t >= 0) || (u <= 0 && v <= 0 && t <= 0))) continue;
    const double y = a.y - (n.x * (place.x - a.x) + n.z * (place.z - a.z)) / n.y;
    if (y <= place.y) below = std::max(below, y);
    if (y > place.y) above = std::min(above, y);
  }
  return {below, above};
}

TEST(town, cells_stand_on_the_ground_and_bridges_and_passages_cover_theirs) {
  const scene::world_geometry w = scene::flatten(old_town().load());
  double lowest = 1e30, highest = -1e30;
  for (const named_cell& cell : old_town().made().cells) {
    const glm::dvec3 middle = (cell.min + cell.max) * 0.5;
    const auto [below, above] = floor_and_ceiling(w, middle);
    if (!cell.has_tree) {
      EXPECT_GT(cell.min.y - below, 0.05) << cell.name;
      EXPECT_LT(cell.min.y - below, 1.2) << cell.name;
    }
    const bool is_covered = cell.name.starts_with("under bridge") || cell.name.starts_with("passage");
    if (is_covered) {
      EXPECT_LT(above - cell.max.y, 3.0) << cell.name;
    }
    lowest = std::min(lowest, below);
    highest = std::max(highest, below);
  }
  EXPECT_GT(highest - lowest, 3.0);
}

// Polygons of pieces (joined by corners in the same place) whose bounding box is below 0.3 m along every axis.
double share_in_small_pieces(const scene::world_geometry& w) {
  std::map<std::array<float, 3>, std::uint32_t> welded;
  std::vector<std::uint32_t> of(w.positions.size());
  for (std::size_t i = 0; i < of.size(); ++i) {
    const glm::vec3& p = w.positions[i];
    of[i] = welded.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(welded.size())).first->second;
  }
  std::vector<std::uint32_t> parent(welded.size());
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto root = [&parent](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::size_t i = 0; i < w.indices.size(); i += 3) {
    for (std::size_t k = 1; k < 3; ++k) parent[root(of[w.indices[i + k]])] = root(of[w.indices[i]]);
  }
  std::vector<glm::vec3> low(parent.size(), glm::vec3(1e30f)), high(parent.size(), glm::vec3(-1e30f));
  for (std::size_t i = 0; i < of.size(); ++i) {
    const std::uint32_t r = root(of[i]);
    low[r] = glm::min(low[r], w.positions[i]);
    high[r] = glm::max(high[r], w.positions[i]);
  }
  std::size_t small = 0;
  for (std::size_t i = 0; i < w.indices.size(); i += 3) {
    const glm::vec3 size = high[root(of[w.indices[i]])] - low[root(of[w.indices[i]])];
    if (std::max({size.x, size.y, size.z}) < 0.3f) ++small;
  }
  return static_cast<double>(small) / static_cast<double>(w.indices.size() / 3);
}

double share_long_and_thin(const scene::world_geometry& w) {
  std::size_t thin = 0;
  for (std::size_t i = 0; i < w.indices.size(); i += 3) {
    const glm::dvec3 a(w.positions[w.indices[i]]), b(w.positions[w.indices[i + 1]]), c(w.positions[w.indices[i + 2]]);
    const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
    if (longest * longest > 50.0 * glm::length(glm::cross(b - a, c - a))) ++thin;  // longest / height on it
  }
  return static_cast<double>(thin) / static_cast<double>(w.indices.size() / 3);
}

TEST(town, is_full_of_small_and_of_long_thin_things) {
  for (const char* name : {"vienna800k", "hongkong"}) {
    const scene::world_geometry w = scene::flatten(written_city(make_town(preset(name), 271828, 1)).load());
    EXPECT_GT(share_in_small_pieces(w), 0.30) << name;
    EXPECT_GT(share_long_and_thin(w), 0.05) << name;
  }
}

}  // namespace
}  // namespace sightcell::city
