#include "sightcell/scene/camera_path.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <map>
#include <optional>
#include <utility>

#include "gltf_accessors.h"
#include "gltf_file.h"
#include "json_object.h"
#include "node_transform.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace sightcell::scene {
namespace {

constexpr int steps_of_curve = 8;  // between two keyframes
constexpr std::size_t path_point_limit = std::size_t{1} << 22;

enum class interpolation { linear, step, cubic };

// A sampler of an animation.
struct track {
  interpolation how = interpolation::linear;
  std::vector<double> times;   // ascending
  std::vector<double> values;  // `width` per time; of cubic ones three times that: in-tangent, value, out-tangent
  std::size_t width = 3;

  glm::dvec4 value(std::size_t key, std::size_t part) const {
    const std::size_t parts = how == interpolation::cubic ? 3 : 1;
    glm::dvec4 out(0.0);
    for (std::size_t i = 0; i < width; ++i)
      out[static_cast<int>(i)] = values[(key * parts + (parts == 3 ? part : 0)) * width + i];
    return out;
  }

  // Returns the value at a time of the interval that begins at `begin`; a step at the end of it is not taken.
  glm::dvec4 at(double time, double begin) const {
    const auto after = std::upper_bound(times.begin(), times.end(), begin);
    if (after == times.begin()) return value(0, 1);
    const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
    if (key + 1 == times.size() || how == interpolation::step) return value(key, 1);
    const double length = times[key + 1] - times[key], t = (time - times[key]) / length;
    const glm::dvec4 a = value(key, 1), b = value(key + 1, 1);
    if (how == interpolation::cubic) {
      const double t2 = t * t, t3 = t2 * t;
      return (2 * t3 - 3 * t2 + 1) * a + length * (t3 - 2 * t2 + t) * value(key, 2) + (3 * t2 - 2 * t3) * b +
             length * (t3 - t2) * value(key + 1, 0);
    }
    if (width == 3) return a + t * (b - a);
    const glm::dquat turned =
        glm::slerp(glm::normalize(glm::dquat(a.w, a.x, a.y, a.z)), glm::normalize(glm::dquat(b.w, b.x, b.y, b.z)), t);
    return {turned.x, turned.y, turned.z, turned.w};
  }
};

// What an animation does to one node.
struct node_tracks {
  std::optional<track> translation, rotation, scale;
};

class path_reader {
 public:
  path_reader(const nlohmann::json& parsed, const gltf_source& source, std::optional<std::vector<std::uint8_t>> binary)
      : root_(parsed, "", source.name),
        name_(source.name),
        table_(root_, source, std::move(binary)),
        nodes_(root_.objects("nodes")) {
    parents_.resize(nodes_.size());
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
      for (const std::uint32_t child : nodes_[i].indices("children", "nodes", nodes_.size())) parents_[child] = i;
  }

  std::vector<point_path> read(const std::string& camera);

 private:
  bool is_named(const json_object& node, const std::string& camera) const;
  std::vector<std::uint32_t> chain_of(std::uint32_t node) const;
  std::map<std::uint32_t, node_tracks> tracks_of(const json_object& animation, const std::vector<std::uint32_t>& chain);
  track read_track(const json_object& sampler, bool is_rotation);
  glm::dmat4 local_transform(std::uint32_t node, const node_tracks* moved, double time, double begin) const;
  void walk(const std::vector<std::uint32_t>& chain, const std::map<std::uint32_t, node_tracks>& tracks);

  const json_object root_;
  const std::string& name_;
  accessor_table table_;
  const std::vector<json_object> nodes_;
  std::vector<std::optional<std::uint32_t>> parents_;
  std::vector<point_path> paths_;
  std::size_t points_ = 0;
};

bool path_reader::is_named(const json_object& node, const std::string& camera) const {
  if (node.text("name") == camera) return true;
  const std::vector<json_object> cameras = root_.objects("cameras");
  const auto of_node = node.index("camera", "cameras", cameras.size());
  return of_node && cameras[*of_node].text("name") == camera;
}

// Returns a node and all above it, from the root down.
std::vector<std::uint32_t> path_reader::chain_of(std::uint32_t node) const {
  std::vector<std::uint32_t> chain{node};
  while (parents_[chain.back()]) {
    chain.push_back(*parents_[chain.back()]);
    if (chain.size() > nodes_.size())
      nodes_[node].fail("scene.node-cycle", "is in or below a cycle of nodes", "export the file again");
  }
  std::reverse(chain.begin(), chain.end());
  return chain;
}

track path_reader::read_track(const json_object& sampler, bool is_rotation) {
  track out;
  const std::string how = sampler.text("interpolation").value_or("LINEAR");
  out.how = how == "STEP" ? interpolation::step : how == "CUBICSPLINE" ? interpolation::cubic : interpolation::linear;
  out.width = is_rotation ? 4 : 3;
  const std::uint32_t input = sampler.required_index("input", "accessors", table_.size());
  const std::uint32_t output = sampler.required_index("output", "accessors", table_.size());
  table_.require(sampler, input, "keyframe times", {"SCALAR"}, {5126});
  if (is_rotation)
    table_.require(sampler, output, "rotations", {"VEC4"}, {5120, 5121, 5122, 5123, 5126});
  else
    table_.require(sampler, output, "translations or scales", {"VEC3"}, {5126});
  const bool good =
      read_numbers(table_.elements(input), out.times) && read_numbers(table_.elements(output), out.values);
  const std::size_t parts = out.how == interpolation::cubic ? 3 : 1;
  if (!good || out.times.empty() || out.values.size() != out.times.size() * parts * out.width)
    sampler.fail("scene.bad-field", "has no value for each keyframe time", "export the file again");
  for (std::size_t i = 0; i < out.times.size(); ++i)
    if (!std::isfinite(out.times[i]) || (i > 0 && !(out.times[i - 1] < out.times[i])))
      sampler.fail("scene.bad-field", "has keyframe times that do not ascend", "export the file again");
  return out;
}

std::map<std::uint32_t, node_tracks> path_reader::tracks_of(const json_object& animation,
                                                            const std::vector<std::uint32_t>& chain) {
  std::map<std::uint32_t, node_tracks> tracks;
  const std::vector<json_object> samplers = animation.objects("samplers");
  for (const json_object& channel : animation.objects("channels")) {
    const auto target = channel.object("target");
    const auto node = target ? target->index("node", "nodes", nodes_.size()) : std::nullopt;
    if (!node || std::find(chain.begin(), chain.end(), *node) == chain.end()) continue;
    const std::string what = target->text("path").value_or("");
    std::optional<track> node_tracks::*const member = what == "translation" ? &node_tracks::translation
                                                      : what == "rotation"  ? &node_tracks::rotation
                                                      : what == "scale"     ? &node_tracks::scale
                                                                            : nullptr;
    // A camera that only turns does not move.
    if (member == nullptr || (*node == chain.back() && what != "translation")) continue;
    const json_object& sampler = samplers[channel.required_index("sampler", "samplers", samplers.size())];
    tracks[*node].*member = read_track(sampler, what == "rotation");
  }
  return tracks;
}

glm::dmat4 path_reader::local_transform(std::uint32_t node, const node_tracks* moved, double time, double begin) const {
  const json_object& source = nodes_[node];
  const std::vector<double> matrix = source.reals("matrix", 16);
  if (moved == nullptr && !matrix.empty()) {
    glm::dmat4 m;
    for (std::size_t i = 0; i < 16; ++i) m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = matrix[i];
    return m;
  }
  const auto part = [&](const char* key, std::size_t count, const std::optional<track>* by, glm::dvec4 rest) {
    if (by != nullptr && *by) return (*by)->at(time, begin);
    const std::vector<double> values = source.reals(key, count);
    for (std::size_t i = 0; i < values.size(); ++i) rest[static_cast<int>(i)] = values[i];
    return rest;
  };
  const glm::dvec4 t = part("translation", 3, moved ? &moved->translation : nullptr, glm::dvec4(0.0));
  const glm::dvec4 r = part("rotation", 4, moved ? &moved->rotation : nullptr, {0.0, 0.0, 0.0, 1.0});
  const glm::dvec4 s = part("scale", 3, moved ? &moved->scale : nullptr, glm::dvec4(1.0));
  return from_trs(&t.x, &r.x, &s.x);
}

// Adds the path of the last node of a chain under one animation.
void path_reader::walk(const std::vector<std::uint32_t>& chain, const std::map<std::uint32_t, node_tracks>& tracks) {
  std::vector<double> times;
  bool curved = false;
  for (const auto& [node, moved] : tracks)
    for (const std::optional<track>* one : {&moved.translation, &moved.rotation, &moved.scale})
      if (*one) {
        times.insert(times.end(), (*one)->times.begin(), (*one)->times.end());
        curved |= (*one)->how == interpolation::cubic || one != &moved.translation;
      }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  const auto steps = static_cast<std::size_t>(curved ? steps_of_curve : 1);
  points_ += times.size() * steps;
  if (points_ > path_point_limit)
    refuse(name_, "scene.too-large", "its animations have more than " + std::to_string(path_point_limit) + " points",
           "export fewer keyframes");

  const auto position = [&](double time, double begin) {
    glm::dmat4 world(1.0);
    for (const std::uint32_t node : chain) {
      const auto moved = tracks.find(node);
      world = world * local_transform(node, moved == tracks.end() ? nullptr : &moved->second, time, begin);
    }
    return glm::dvec3(world[3]);
  };
  glm::dvec3 last(0.0);
  const auto add = [&](const glm::dvec3& p) {
    paths_.back().push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    last = p;
  };
  for (std::size_t i = 0; i < times.size(); ++i) {
    const glm::dvec3 here = position(times[i], times[i]);
    // Where the camera jumped, another path begins.
    if (i == 0 || glm::distance(here, last) > 1e-6 * (1.0 + glm::length(last))) paths_.emplace_back();
    if (paths_.back().empty()) add(here);
    for (std::size_t step = 1; step <= steps && i + 1 < times.size(); ++step) {
      const double share = static_cast<double>(step) / static_cast<double>(steps);
      add(position(step == steps ? times[i + 1] : times[i] + share * (times[i + 1] - times[i]), times[i]));
    }
  }
}

std::vector<point_path> path_reader::read(const std::string& camera) {
  bool found = false;
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
    if (!is_named(nodes_[node], camera)) continue;
    found = true;
    const std::vector<std::uint32_t> chain = chain_of(node);
    for (const json_object& animation : root_.objects("animations"))
      if (const auto tracks = tracks_of(animation, chain); !tracks.empty()) walk(chain, tracks);
  }
  if (!found)
    throw error(error_kind::wrong_use, "scene.no-such-camera", name_,
                "has no node and no camera named \"" + printable(camera) + "\"",
                "give the name of a camera of this file");
  if (paths_.empty())
    throw error(error_kind::wrong_use, "scene.camera-at-rest", name_,
                "no animation moves \"" + printable(camera) + "\"", "name a camera that moves, or use --path");
  return std::move(paths_);
}

}  // namespace

std::vector<point_path> camera_paths(const std::filesystem::path& path, const std::string& camera) {
  const gltf_source source = source_of(path);
  gltf_file file = split_gltf(read_scene_bytes(path), source.name);
  nlohmann::json parsed;
  try {
    parsed = parse_json(file.json);
  } catch (const nlohmann::json::exception& e) {
    refuse(source.name, "scene.bad-json", "its JSON cannot be parsed: " + printable(e.what(), 160),
           "the file is damaged: copy or export it again");
  }
  return path_reader(parsed, source, std::move(file.binary)).read(camera);
}

}  // namespace sightcell::scene
