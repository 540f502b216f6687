#include "cells/path_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sightcell/bake/cells.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace sightcell::bake {
namespace {

using nlohmann::json;

constexpr std::uintmax_t path_bytes_limit = 64u << 20;  // more than a million points
constexpr double farthest_point = 1e7;                  // meters, as for cells
constexpr const char* path_shape = R"(write {"path":[[x,y,z],[x,y,z]]}, in meters)";

[[noreturn]] void refuse_path(const char* id, const std::string& subject, const std::string& cause,
                              const std::string& remedy = path_shape) {
  throw error(error_kind::bad_input, id, subject, cause, remedy);
}

std::array<float, 3> read_point(const json& entry, const std::string& label, const std::string& subject) {
  if (!entry.is_array() || entry.size() != 3)
    refuse_path("path.bad-point", subject, label + " is not a list of three numbers");
  std::array<float, 3> point{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!entry[axis].is_number())
      refuse_path("path.bad-point", subject, fmt::format("{} contains a {}", label, entry[axis].type_name()));
    const auto value = entry[axis].get<double>();
    if (!(std::abs(value) <= farthest_point))
      refuse_path("path.bad-point", subject, fmt::format("{} is at {:g} m", label, value),
                  "give points within 10,000 km of the origin");
    point[axis] = static_cast<float>(value);
  }
  return point;
}

camera_path read_camera_path(const json& list, const std::string& label, const std::string& subject) {
  if (!list.is_array()) refuse_path("path.no-points", subject, label + " is not a list of points");
  if (list.empty()) refuse_path("path.no-points", subject, label + " has no point");
  camera_path path;
  path.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i)
    path.push_back(read_point(list[i], fmt::format("point {} of {}", i, label), subject));
  return path;
}

json parse_path_json(std::string_view text, const std::string& subject) {
  try {
    return scene::parse_json(text);
  } catch (const json::exception& e) {  // a parse error, or a number that exceeds double
    // The library's text begins with its own name and number in brackets, which users do not need.
    const std::string what = e.what();
    const auto end = what.find("] ");
    refuse_path("path.not-json", subject, "not JSON: " + (end == std::string::npos ? what : what.substr(end + 2)));
  }
}

}  // namespace

std::vector<camera_path> parse_paths(std::string_view text, const std::string& subject) {
  const json document = parse_path_json(text, subject);
  std::vector<camera_path> paths;
  if (document.is_object()) {
    if (const auto one = document.find("path"); one != document.end())
      paths.push_back(read_camera_path(*one, "\"path\"", subject));
    if (const auto list = document.find("paths"); list != document.end()) {
      if (!list->is_array()) refuse_path("path.no-points", subject, "\"paths\" is not a list of paths");
      for (std::size_t i = 0; i < list->size(); ++i)
        paths.push_back(read_camera_path((*list)[i], fmt::format("path {} of \"paths\"", i), subject));
    }
  }
  if (paths.empty()) refuse_path("path.no-points", subject, "has neither a \"path\" nor \"paths\"");
  return paths;
}

std::vector<camera_path> read_paths(const std::filesystem::path& path) {
  const std::string subject = path.string();
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  if (code) refuse_path("path.unreadable", subject, "cannot be read: " + code.message(), "check the path");
  if (size > path_bytes_limit)
    refuse_path("path.too-large", subject, fmt::format("is {} bytes long, more than {}", size, path_bytes_limit),
                "leave out points: paths are straight between them");
  std::string text(size, '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in.read(text.data(), static_cast<std::streamsize>(size)))
    refuse_path("path.unreadable", subject, "cannot be read", "check the path and the permissions");
  return parse_paths(text, subject);
}

std::array<float, 3> last_point(const std::filesystem::path& path_file) {
  return read_paths(path_file).back().back();
}

}  // namespace sightcell::bake
