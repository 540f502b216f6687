// sightcell-test-hidden-pairs SCENE RECORD [DOOR...]: looks at what sightcell-relevance-server --record wrote, with
// exact rays. A pair is wrong when it was called hidden and a ray from the eye comes to a point of the other's box.
// Viewers whose eye is no valid viewpoint are left out: the set does not cover them. Doors are those of the server, in
// the order of its options; a door that is closed in a line of the record occludes. Prints one JSON object.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"

namespace {

using sightcell::bake::coincidence_reach;
using sightcell::bake::ray_scene;
using sightcell::bake::sight;
using sightcell::bake::sight_line;

constexpr float player_radius = 0.05f, smallest_gap = 0.002f;  // meters, the bake's defaults
constexpr int across = 4, upward = 9;                          // points of a box along its width and height

struct pair_record {
  std::uint32_t frame = 0, viewer = 0, closed = 0;
  glm::vec3 eye{0.0f}, min{0.0f}, max{0.0f};
  bool visible = false;
};

std::vector<pair_record> read_record(const char* path) {
  std::ifstream in(path);
  std::string line;
  if (!std::getline(in, line)) throw std::runtime_error(std::string(path) + ": no record");
  std::vector<pair_record> out;
  while (std::getline(in, line)) {
    pair_record r;
    unsigned other = 0, visible = 0;
    const int got = std::sscanf(line.c_str(), "%u,%u,%u,%f,%f,%f,%f,%f,%f,%f,%f,%f,%u,%u", &r.frame, &r.viewer, &other,
                                &r.eye.x, &r.eye.y, &r.eye.z, &r.min.x, &r.min.y, &r.min.z, &r.max.x, &r.max.y,
                                &r.max.z, &r.closed, &visible);
    if (got != 14) throw std::runtime_error(std::string(path) + ": not a record: " + line);
    r.visible = visible != 0;
    out.push_back(r);
  }
  return out;
}

// Points all over the box, its faces included.
std::vector<glm::vec3> points_of(const pair_record& r) {
  std::vector<glm::vec3> points;
  for (int y = 0; y < upward; ++y) {
    for (int x = 0; x < across; ++x) {
      for (int z = 0; z < across; ++z) {
        const glm::vec3 part(static_cast<float>(x) / (across - 1), static_cast<float>(y) / (upward - 1),
                             static_cast<float>(z) / (across - 1));
        points.push_back(r.min + part * (r.max - r.min));
      }
    }
  }
  return points;
}

class checker {
 public:
  explicit checker(const ray_scene& rays) : rays_(rays) {}

  bool is_valid(const pair_record& r) {
    const auto [found, is_new] = free_.try_emplace({r.frame, r.viewer}, false);
    if (is_new) found->second = rays_.is_valid(r.eye, player_radius);
    return found->second;
  }

  // Does a ray come through, by more than rounding and cracks may explain?
  bool is_clear(const pair_record& r) {
    const std::vector<glm::vec3> points = points_of(r);
    lines_.clear();
    distances_.clear();
    for (const glm::vec3& p : points) {
      const float distance = glm::length(p - r.eye);
      if (distance < 1e-3f) return true;  // they stand in each other
      lines_.push_back({r.eye, (p - r.eye) / distance});
      distances_.push_back(distance);
    }
    sights_.resize(lines_.size());
    rays_.trace(lines_, sights_);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (sights_[i].distance < distances_[i] + coincidence_reach(distances_[i])) continue;
      if (!rays_.through_gap(r.eye, lines_[i].direction, distances_[i], smallest_gap)) return true;
    }
    return false;
  }

 private:
  const ray_scene& rays_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> free_;
  std::vector<sight_line> lines_;
  std::vector<float> distances_;
  std::vector<sight> sights_;
};

// The scene with some doors closed.
struct closed_world {
  closed_world(const sightcell::scene::scene& s, std::span<const std::string> doors, std::uint32_t closed)
      : world(sightcell::scene::flatten(s, {}, names_of(doors, closed))), rays(world, false), check(rays) {}

  static std::vector<std::string> names_of(std::span<const std::string> doors, std::uint32_t closed) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < doors.size(); ++i)
      if ((closed >> i & 1u) != 0) names.push_back(doors[i]);
    return names;
  }

  sightcell::scene::world_geometry world;
  ray_scene rays;
  checker check;
};

int run(const char* scene_file, const char* record_file, std::span<const std::string> doors) {
  const sightcell::scene::scene s = sightcell::scene::load_gltf(scene_file);
  std::map<std::uint32_t, std::unique_ptr<closed_world>> worlds;  // by the doors that are closed
  std::uint64_t pairs = 0, checked = 0, hidden = 0, wrong = 0, unseen = 0;
  for (const pair_record& r : read_record(record_file)) {
    ++pairs;
    std::unique_ptr<closed_world>& world = worlds[r.closed];
    if (!world) world = std::make_unique<closed_world>(s, doors, r.closed);
    if (!world->check.is_valid(r)) continue;
    ++checked;
    const bool clear = world->check.is_clear(r);
    hidden += r.visible ? 0 : 1;
    wrong += !r.visible && clear ? 1 : 0;
    unseen += !clear ? 1 : 0;
  }
  std::printf("{\"pairs\": %llu, \"checked\": %llu, \"hidden\": %llu, \"wrong\": %llu, \"unseen_by_rays\": %llu}\n",
              static_cast<unsigned long long>(pairs), static_cast<unsigned long long>(checked),
              static_cast<unsigned long long>(hidden), static_cast<unsigned long long>(wrong),
              static_cast<unsigned long long>(unseen));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: sightcell-test-hidden-pairs SCENE RECORD [DOOR...]\n");
    return 2;
  }
  try {
    const std::vector<std::string> doors(argv + 3, argv + argc);
    return run(argv[1], argv[2], doors);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
