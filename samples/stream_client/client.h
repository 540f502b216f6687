#pragma once
// A run: loads the front, follows the walk, and begins anew where the server got another front.
#include <optional>

#include "report.h"
#include "session.h"

namespace stream_client {

struct camera_choice {
  std::optional<glm::vec3> eye, look;  // look: a point; without one, the view is along -z
  std::string path_file;               // empty: at rest at `eye`, by default in the middle of the scene
  float speed = 1.5f;                  // meters per second
};

// settings.network.base_url: of the folder with scene.front.
// picture: where to write the last picture; empty: nowhere.
// Fails with client.*, gl.*, picture.*.
report run_client(const client_settings& settings, const camera_choice& camera, const std::string& picture);

}  // namespace stream_client
