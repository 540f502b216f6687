#include "bench/frames/path_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace sightcell::bench {

glm::vec3 path_frame::forward() const {
  return {std::sin(heading), 0.0f, -std::cos(heading)};
}

std::vector<path_frame> read_path(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  std::vector<path_frame> path;
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    path_frame frame;
    if (!(words >> frame.eye.x >> frame.eye.y >> frame.eye.z >> frame.heading)) {
      throw std::runtime_error(fmt::format("{}: line \"{}\" has no four numbers", file.string(), line));
    }
    path.push_back(frame);
  }
  if (path.empty()) throw std::runtime_error(file.string() + ": has no frames");
  return path;
}

void write_path(const std::filesystem::path& file, const std::vector<path_frame>& path) {
  std::ofstream out(file);
  out << "# x y z heading: meters and radians, a frame per line\n";
  for (const path_frame& f : path) {
    out << fmt::format("{:.2f} {:.2f} {:.2f} {:.3f}\n", f.eye.x, f.eye.y, f.eye.z, f.heading);
  }
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace sightcell::bench
