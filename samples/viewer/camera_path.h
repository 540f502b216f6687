#pragma once
// A recorded path of the camera: one pose per drawn frame.
#include <chrono>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controls.h"

namespace viewer {

struct path_pose {
  double seconds = 0.0;  // since the recording began
  fly_camera camera;     // without its field of view
};

// Writes the poses of a path: a line of text each, `seconds,x,y,z,yaw,pitch` in meters and radians. A pose that is that
// of the frame before is left out.
class path_recorder {
 public:
  // Throws sightcell::error (failed) if the file cannot be written.
  explicit path_recorder(const std::string& file);
  void add(double seconds, const fly_camera& camera);
  std::uint64_t poses() const { return poses_; }
  // Throws sightcell::error (failed) if not all was written.
  void finish();

 private:
  std::string file_;
  std::ofstream out_;
  fly_camera last_;
  std::uint64_t poses_ = 0;
};

// Keeps the place of the camera in a path file of one point (docs/json-files.md), for `sightcell bake --near`. It is
// written by rename, at most once per second, when the camera has moved.
class camera_note {
 public:
  // file: empty: none.
  explicit camera_note(std::string file) : file_(std::move(file)) {}
  // Throws sightcell::error (failed) if the file cannot be written.
  void follow(const fly_camera& camera);

 private:
  using clock = std::chrono::steady_clock;
  std::string file_;
  std::optional<glm::vec3> last_;
  clock::time_point written_{};
};

// Returns the poses of a file, exactly as they were recorded. Throws sightcell::error (bad_input) with the line that is
// broken.
std::vector<path_pose> read_path(const std::string& file);

// Returns `most` poses that are spread over the path, or all if there are no more. most: at least 1.
std::vector<path_pose> thinned(const std::vector<path_pose>& path, std::size_t most);

}  // namespace viewer
