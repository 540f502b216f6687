#pragma once
// Where the camera is at a time: at rest, or along the points of a path file (docs/json-files.md).
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace stream_client {

struct camera_pose {
  glm::vec3 eye{0.0f}, forward{0.0f, 0.0f, -1.0f};
  glm::vec3 velocity{0.0f};  // meters per second
};

class walk {
 public:
  // A camera at rest.
  walk(const glm::vec3& eye, const glm::vec3& forward);

  // Along all paths of a path file, one after the other.
  // speed: meters per second, above 0.
  // Fails with client.path.
  walk(const std::string& path_file, float speed);

  // Returns the camera after this time; at rest after the end.
  camera_pose at(double seconds) const;

  // Returns when the last point is reached.
  double seconds() const;

 private:
  struct stretch {
    double begin = 0.0, end = 0.0;  // seconds
    glm::vec3 from{0.0f}, to{0.0f};
  };
  std::vector<stretch> stretches_;
  camera_pose rest_;
};

}  // namespace stream_client
