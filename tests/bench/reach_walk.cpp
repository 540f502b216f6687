// reach_walk SCENE STARTS.json OUT.json [options]: a person walks at random over the floors of a scene, for
// bench_reach.py. Knows nothing of the voxels by which a bake finds floors: the person is a box, tested against the
// polygons themselves, and the floor is what a ray down from the person hits. As for a bake, all polygons but BLEND
// ones are obstacles, and those that face up are floors.
//
// STARTS: a list of points [x, y, z] in meters. Each is dropped to the first floor below it. Those with room for a
// person get equal numbers of steps, in walks of at most 500. The first walk begins at the start, others where walks
// from the same start were least: so all eyes are connected to their start, and a pit without a way out ends one walk.
//
// OUT: {"floors": [height below each start, or null], "eyes": [of each start: [[x, y, z]], in the order of the steps]}.
// Starts without room for a person have no eyes. Blocked tries are no steps.
#include <embree3/rtcore.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <iostream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sightcell/base/random.h"
#include "sightcell/scene/scene.h"

namespace {

using namespace sightcell;

// A use of random numbers that is none of a bake.
constexpr std::uint64_t place_of_walks = 0x57414C4B53ull;

struct options {
  std::string scene, starts, out;
  std::uint32_t steps = 100000;
  std::uint64_t seed = 1;
  double stride = 0.5, half_width = 0.25, height = 1.8, climb = 0.45, jump = 1.2, slope = 45.0, eye = 1.6, drop = 8.0;
  std::vector<double> region;  // x0, z0, x1, z1
};

struct box_3 {
  glm::dvec3 min{0.0}, max{0.0};
};

using triangle = std::array<glm::dvec3, 3>;

// Separating axis test (Akenine-Möller 2001). Touching is no overlap.
bool overlaps(const box_3& box, const triangle& polygon) {
  const glm::dvec3 middle = 0.5 * (box.min + box.max), half = 0.5 * (box.max - box.min);
  const triangle at{polygon[0] - middle, polygon[1] - middle, polygon[2] - middle};
  const auto separates = [&](const glm::dvec3& axis) {
    const double reach = glm::dot(half, glm::abs(axis));
    const double a = glm::dot(at[0], axis), b = glm::dot(at[1], axis), c = glm::dot(at[2], axis);
    return std::min({a, b, c}) >= reach || std::max({a, b, c}) <= -reach;
  };
  const std::array<glm::dvec3, 3> edges{at[1] - at[0], at[2] - at[1], at[0] - at[2]};
  const std::array<glm::dvec3, 3> axes{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
  for (const glm::dvec3& axis : axes) {
    if (separates(axis)) return false;
    for (const glm::dvec3& edge : edges) {
      const glm::dvec3 across = glm::cross(axis, edge);
      if (glm::dot(across, across) > 1e-18 && separates(across)) return false;
    }
  }
  return !separates(glm::cross(edges[0], edges[1]));
}

// The polygons that stop a person.
class obstacles {
 public:
  obstacles(const scene::world_geometry& world, double slope)
      : world_(world), flat_(std::cos(slope * std::numbers::pi / 180.0) - 1e-5), device_(rtcNewDevice(nullptr)) {
    if (device_ == nullptr) throw std::runtime_error("Embree has no device");
    for (std::uint32_t p = 0; p < world.kinds.size(); ++p)
      if (!world.kinds[p].absent && world.kinds[p].alpha != scene::alpha_mode::blend) ids_.push_back(p);
    if (ids_.empty()) throw std::runtime_error("the scene has no obstacle");
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), world.positions.size()));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), ids_.size()));
    if (vertices == nullptr || indices == nullptr) throw std::bad_alloc();
    for (std::size_t i = 0; i < world.positions.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) vertices[3 * i + static_cast<std::size_t>(axis)] = world.positions[i][axis];
    for (std::size_t i = 0; i < ids_.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) indices[3 * i + k] = world.indices[3 * std::size_t{ids_[i]} + k];
    rtcCommitGeometry(mesh);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree built no scene");
  }
  ~obstacles() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  obstacles(const obstacles&) = delete;
  obstacles& operator=(const obstacles&) = delete;

  struct ground {
    double height = 0.0;
    bool is_floor = false;  // a person can stand on it
  };
  // Returns the first obstacle below a point.
  std::optional<ground> below(const glm::dvec3& from) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(from.x);
    ray.ray.org_y = static_cast<float>(from.y);
    ray.ray.org_z = static_cast<float>(from.z);
    ray.ray.dir_y = -1.0f;
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const triangle at = corners(ray.hit.primID);
    const glm::dvec3 normal = glm::cross(at[1] - at[0], at[2] - at[0]);
    const double up = world_.kinds[ids_[ray.hit.primID]].double_sided ? std::abs(normal.y) : normal.y;
    return ground{from.y - static_cast<double>(ray.ray.tfar), up >= flat_ * glm::length(normal)};
  }

  // Returns whether no obstacle is in a box.
  bool is_empty(const box_3& box) const {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    const glm::dvec3 middle = 0.5 * (box.min + box.max);
    RTCPointQuery query{};
    query.x = static_cast<float>(middle.x);
    query.y = static_cast<float>(middle.y);
    query.z = static_cast<float>(middle.z);
    query.radius = static_cast<float>(0.5 * glm::distance(box.min, box.max) + 1e-3);
    asked asking{this, &box, true};
    rtcPointQuery(scene_, &query, &context, &obstacles::test, &asking);
    return asking.empty;
  }

 private:
  struct asked {
    const obstacles* self;
    const box_3* box;
    bool empty;
  };
  static bool test(RTCPointQueryFunctionArguments* a) {
    auto& asking = *static_cast<asked*>(a->userPtr);
    if (!asking.empty || !overlaps(*asking.box, asking.self->corners(a->primID))) return false;
    asking.empty = false;
    a->query->radius = 0.0f;  // ends the search
    return true;
  }
  triangle corners(std::uint32_t number) const {
    triangle at;
    for (std::size_t i = 0; i < 3; ++i)
      at[i] = glm::dvec3(world_.positions[world_.indices[3 * std::size_t{ids_[number]} + i]]);
    return at;
  }

  const scene::world_geometry& world_;
  double flat_;
  std::vector<std::uint32_t> ids_;  // of the obstacles
  RTCDevice device_;
  RTCScene scene_ = nullptr;
};

// A person, by the middle of the feet.
class walker {
 public:
  walker(const obstacles& around, const options& how, const glm::dvec3& feet, std::uint64_t number)
      : around_(around),
        how_(how),
        feet_(feet),
        random_(how.seed, place_of_walks, bake::purpose::viewpoints, 0, number) {
    heading_ = 2.0 * std::numbers::pi * uniform();
  }

  // One step: straight on with a small turn, or where that is blocked in any direction. Returns whether one was free.
  bool step() {
    constexpr int tries = 16;
    for (int i = 0; i < tries; ++i) {
      const double turn = i == 0 ? 0.6 : 2.0 * std::numbers::pi;
      const double heading = heading_ + turn * (uniform() - 0.5);
      // Every fourth try may be a jump.
      const double up = uniform() < 0.25 ? how_.jump : how_.climb;
      const glm::dvec3 before = feet_;
      if (move(heading, up) && move(heading, how_.climb)) {
        heading_ = heading;
        return true;
      }
      feet_ = before;
    }
    return false;
  }

  const glm::dvec3& feet() const { return feet_; }

 private:
  double uniform() { return static_cast<double>(random_.uniform()); }

  // Half of a step, so that the boxes before and after it overlap and no wall is between them.
  bool move(double heading, double up) {
    const double length = std::min(0.5 * how_.stride, how_.half_width);
    glm::dvec3 to = feet_ + length * glm::dvec3(std::cos(heading), 0.0, std::sin(heading));
    if (!how_.region.empty() &&
        (to.x < how_.region[0] || to.z < how_.region[1] || to.x > how_.region[2] || to.z > how_.region[3]))
      return false;
    const auto ground = around_.below({to.x, feet_.y + up, to.z});
    if (!ground || !ground->is_floor) return false;
    to.y = ground->height;
    const double top = std::max(feet_.y, to.y) + how_.height;  // also after a fall, which passes all between
    if (to.y > feet_.y + how_.climb && !is_free(feet_, top)) return false;
    if (!is_free(to, top)) return false;
    feet_ = to;
    return true;
  }

  bool is_free(const glm::dvec3& feet, double top) const {
    const double r = how_.half_width;
    return around_.is_empty({{feet.x - r, feet.y + how_.climb, feet.z - r}, {feet.x + r, top, feet.z + r}});
  }

  const obstacles& around_;
  const options& how_;
  glm::dvec3 feet_;
  double heading_ = 0.0;
  bake::random_stream random_;
};

// Places by squares of 4 m and 2 m of height.
class visits {
 public:
  void add(const glm::dvec3& feet) {
    square& at = squares_[{std::floor(feet.x / 4.0), std::floor(feet.y / 2.0), std::floor(feet.z / 4.0)}];
    ++at.count;
    at.last = feet;
  }
  // Returns a place in the square with the fewest visits; nothing if there is none.
  std::optional<glm::dvec3> rarest() const {
    const auto found = std::min_element(squares_.begin(), squares_.end(),
                                        [](const auto& a, const auto& b) { return a.second.count < b.second.count; });
    return found == squares_.end() ? std::nullopt : std::optional(found->second.last);
  }

 private:
  struct square {
    std::size_t count = 0;
    glm::dvec3 last{0.0};
  };
  std::map<std::array<double, 3>, square> squares_;
};

// Returns where steps from a start end. number: of the start.
std::vector<glm::dvec3> walks_from(const obstacles& around, const options& how, const glm::dvec3& start,
                                   std::size_t number, std::size_t steps) {
  constexpr std::size_t of_a_walk = 500;
  std::vector<glm::dvec3> feet;
  visits visited;
  for (std::uint64_t walk = 0; walk < steps && feet.size() < steps; ++walk) {
    walker person(around, how, visited.rarest().value_or(start), (std::uint64_t{number} << 32) + walk);
    for (std::size_t i = 0; i < of_a_walk && feet.size() < steps && person.step(); ++i) {
      feet.push_back(person.feet());
      visited.add(person.feet());
    }
  }
  return feet;
}

void run(const options& how) {
  const scene::world_geometry world = scene::flatten(scene::load_gltf(how.scene));
  const obstacles around(world, how.slope);
  std::ifstream in(how.starts);
  const auto starts = nlohmann::json::parse(in).get<std::vector<std::array<double, 3>>>();
  std::vector<std::optional<glm::dvec3>> begins;
  nlohmann::json out;
  for (const auto& [x, y, z] : starts) {
    // Surfaces that nobody can stand on are passed.
    std::optional<double> floor;
    for (double from = y; from > y - how.drop && !floor;) {
      const auto ground = around.below({x, from, z});
      if (!ground || ground->height < y - how.drop) break;
      if (ground->is_floor) floor = ground->height;
      from = ground->height - 1e-3;
    }
    const double r = how.half_width;
    const bool stands =
        floor && around.is_empty({{x - r, *floor + how.climb, z - r}, {x + r, *floor + how.height, z + r}});
    out["floors"].push_back(floor ? nlohmann::json(*floor) : nlohmann::json());
    begins.push_back(stands ? std::optional(glm::dvec3(x, *floor, z)) : std::nullopt);
  }
  const auto standing = static_cast<std::size_t>(
      std::count_if(begins.begin(), begins.end(), [](const auto& at) { return at.has_value(); }));
  std::size_t number = 0;
  for (const auto& begin : begins) {
    nlohmann::json& eyes = out["eyes"].emplace_back(nlohmann::json::array());
    if (!begin) continue;
    const std::size_t steps =
        std::size_t{how.steps} * (number + 1) / standing - std::size_t{how.steps} * number / standing;
    for (const glm::dvec3& feet : walks_from(around, how, *begin, number, steps))
      eyes.push_back({static_cast<float>(feet.x), static_cast<float>(feet.y + how.eye), static_cast<float>(feet.z)});
    ++number;
  }
  std::ofstream file(how.out);
  file << out;
  file.close();
  if (!file) throw std::runtime_error(how.out + " cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("A person walks at random over the floors of a scene.");
  options how;
  app.add_option("SCENE", how.scene)->required();
  app.add_option("STARTS", how.starts)->required();
  app.add_option("OUT", how.out)->required();
  app.add_option("--steps", how.steps);
  app.add_option("--seed", how.seed);
  app.add_option("--stride", how.stride);
  app.add_option("--half-width", how.half_width);
  app.add_option("--height", how.height);
  app.add_option("--climb", how.climb);
  app.add_option("--jump", how.jump);
  app.add_option("--slope", how.slope);
  app.add_option("--eye", how.eye);
  app.add_option("--drop", how.drop);
  app.add_option("--region", how.region, "x0,z0,x1,z1")->delimiter(',')->expected(4);
  CLI11_PARSE(app, argc, argv);
  try {
    run(how);
  } catch (const std::exception& e) {
    std::cerr << "reach_walk: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
