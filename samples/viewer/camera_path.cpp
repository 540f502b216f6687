#include "camera_path.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "sightcell/base/error.h"

namespace viewer {
namespace {

using sightcell::error;
using sightcell::error_kind;

constexpr const char* heading = "seconds,x,y,z,yaw,pitch";

bool same_pose(const fly_camera& a, const fly_camera& b) {
  return a.eye == b.eye && a.yaw == b.yaw && a.pitch == b.pitch;
}

error broken(const std::string& file, const std::string& cause) {
  return {error_kind::bad_input, "viewer.path", file, cause, "name a file that --record has written"};
}

error not_written(const std::string& file) {
  return {error_kind::failed, "viewer.path-not-written", file, "cannot be written",
          "name a file in a folder that can be written to"};
}

}  // namespace

path_recorder::path_recorder(const std::string& file) : file_(file), out_(file, std::ios::binary | std::ios::trunc) {
  out_ << heading << '\n';
  finish();
}

void path_recorder::add(double seconds, const fly_camera& camera) {
  if (poses_ > 0 && same_pose(camera, last_)) return;
  last_ = camera;
  ++poses_;
  char line[160];
  // 9 digits bring back each float.
  std::snprintf(line, sizeof line, "%.6f,%.9g,%.9g,%.9g,%.9g,%.9g\n", seconds, static_cast<double>(camera.eye.x),
                static_cast<double>(camera.eye.y), static_cast<double>(camera.eye.z), static_cast<double>(camera.yaw),
                static_cast<double>(camera.pitch));
  out_ << line;
}

void path_recorder::finish() {
  out_.flush();
  if (!out_) throw not_written(file_);
}

void camera_note::follow(const fly_camera& camera) {
  if (file_.empty() || last_ == camera.eye || clock::now() - written_ < std::chrono::seconds(1)) return;
  const std::string fresh = file_ + ".new";
  char text[128];
  std::snprintf(text, sizeof text, "{\"path\": [[%.9g, %.9g, %.9g]]}\n", static_cast<double>(camera.eye.x),
                static_cast<double>(camera.eye.y), static_cast<double>(camera.eye.z));
  std::ofstream out(fresh, std::ios::binary | std::ios::trunc);
  out << text;
  out.close();
  std::error_code failed;
  if (out) std::filesystem::rename(fresh, file_, failed);
  if (!out || failed) throw not_written(file_);
  last_ = camera.eye;
  written_ = clock::now();
}

std::vector<path_pose> read_path(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  if (!in) throw broken(file, "cannot be read");
  if (!std::getline(in, line) || line != heading) throw broken(file, "does not begin with " + std::string(heading));
  std::vector<path_pose> path;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    path_pose pose;
    float* values[] = {&pose.camera.eye.x, &pose.camera.eye.y, &pose.camera.eye.z, &pose.camera.yaw,
                       &pose.camera.pitch};
    int end = 0;
    const int read = std::sscanf(line.c_str(), "%lf,%f,%f,%f,%f,%f%n", &pose.seconds, values[0], values[1], values[2],
                                 values[3], values[4], &end);
    bool good = read == 6 && static_cast<std::size_t>(end) == line.size() && std::isfinite(pose.seconds) &&
                (path.empty() || pose.seconds >= path.back().seconds);
    for (const float* value : values) good = good && std::isfinite(*value);
    if (!good) throw broken(file, "line " + std::to_string(number) + " is no pose");
    path.push_back(pose);
  }
  if (path.empty()) throw broken(file, "holds no pose");
  return path;
}

std::vector<path_pose> thinned(const std::vector<path_pose>& path, std::size_t most) {
  if (path.size() <= most) return path;
  std::vector<path_pose> out;
  for (std::size_t i = 0; i < most; ++i) out.push_back(path[i * path.size() / most]);
  return out;
}

}  // namespace viewer
