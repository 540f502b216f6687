#include "walk.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <nlohmann/json.hpp>

#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace stream_client {
namespace {

using nlohmann::json;

constexpr double farthest = 1e7;  // meters from the origin

[[noreturn]] void fail_path(const std::string& file, const std::string& cause) {
  throw sightcell::error(sightcell::error_kind::bad_input, "client.path", file, cause,
                         "name a path file as in docs/json-files.md");
}

std::string read_text(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) fail_path(file, "cannot be opened");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<glm::vec3> read_points(const std::string& file, const json& list) {
  std::vector<glm::vec3> out;
  if (!list.is_array()) fail_path(file, "a path is no list of points");
  for (const json& point : list) {
    if (!point.is_array() || point.size() != 3) fail_path(file, "a point has not three coordinates");
    glm::vec3 p(0.0f);
    for (int i = 0; i < 3; ++i) {
      const json& value = point[static_cast<std::size_t>(i)];
      if (!value.is_number() || !(std::abs(value.get<double>()) <= farthest))
        fail_path(file, "a coordinate is no number within 10,000 km");
      p[i] = value.get<float>();
    }
    out.push_back(p);
  }
  return out;
}

}  // namespace

walk::walk(const glm::vec3& eye, const glm::vec3& forward) : rest_{eye, forward, glm::vec3(0.0f)} {}

walk::walk(const std::string& path_file, float speed) {
  const json document = sightcell::scene::parse_json(read_text(path_file), false);
  if (!document.is_object()) fail_path(path_file, "is no JSON object");
  std::vector<std::vector<glm::vec3>> paths;
  if (document.contains("path")) paths.push_back(read_points(path_file, document["path"]));
  if (document.contains("paths")) {
    for (const json& list : document["paths"]) paths.push_back(read_points(path_file, list));
  }
  double now = 0.0;
  bool any = false;
  for (const auto& points : paths) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      any = true;
      rest_.eye = points[i];
      if (i == 0 || points[i] == points[i - 1]) continue;
      rest_.forward = points[i] - points[i - 1];
      const double end = now + static_cast<double>(glm::length(rest_.forward) / speed);
      stretches_.push_back({now, end, points[i - 1], points[i]});
      now = end;
    }
  }
  if (!any) fail_path(path_file, "has no point");
}

double walk::seconds() const {
  return stretches_.empty() ? 0.0 : stretches_.back().end;
}

camera_pose walk::at(double seconds) const {
  const auto found = std::upper_bound(stretches_.begin(), stretches_.end(), seconds,
                                      [](double t, const stretch& s) { return t < s.end; });
  if (found == stretches_.end()) return rest_;
  const double length = found->end - found->begin;
  const auto part = static_cast<float>(std::clamp((seconds - found->begin) / length, 0.0, 1.0));
  const glm::vec3 way = found->to - found->from;
  return {found->from + part * way, way, way / static_cast<float>(length)};
}

}  // namespace stream_client
