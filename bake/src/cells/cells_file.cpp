#include "cells/cells_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cells/lattice.h"
#include "sightcell/scene/error.h"

namespace sightcell::bake {

namespace {

using nlohmann::json;

constexpr std::uintmax_t file_size_limit = 256u << 20;  // bytes; a million cells take about a third of it
constexpr std::size_t cell_count_limit = 1'000'000;
constexpr double coordinate_limit = 1e7;  // metres; beyond it a float steps by a metre

constexpr const char* shape = R"(write {"cells":[{"name":"lane 3","min":[x,y,z],"max":[x,y,z]}]}, metres)";

[[noreturn]] void refuse(const char* id, const std::string& subject, const std::string& cause,
                         const std::string& remedy = shape) {
  throw error(error_kind::bad_input, id, subject, cause, remedy);
}

glm::vec3 read_corner(const json& cell, const char* key, const std::string& label, const std::string& subject) {
  const auto found = cell.find(key);
  if (found == cell.end() || !found->is_array() || found->size() != 3)
    refuse("cells.bad-box", subject, fmt::format("{} has no \"{}\" of three numbers", label, key));
  glm::vec3 corner{0.0f};
  for (int axis = 0; axis < 3; ++axis) {
    const json& number = (*found)[static_cast<std::size_t>(axis)];
    if (!number.is_number())
      refuse("cells.bad-box", subject, fmt::format("{}: \"{}\" holds a {}", label, key, number.type_name()));
    const double value = number.get<double>();
    if (!std::isfinite(value))
      refuse("cells.not-finite", subject, fmt::format("{}: \"{}\" holds a number that is not finite", label, key));
    if (std::abs(value) > coordinate_limit)
      refuse(
          "cells.too-far", subject,
          fmt::format("{}: \"{}\" holds {:g}, more than {:g} m from the origin", label, key, value, coordinate_limit),
          "use metres, and a scene near the origin");
    corner[axis] = static_cast<float>(value);
  }
  return corner;
}

view_cell read_cell(const json& entry, std::size_t number, const std::string& subject) {
  std::string label = fmt::format("cell {}", number);
  if (!entry.is_object()) refuse("cells.bad-box", subject, label + " is not an object");
  view_cell cell;
  if (const auto name = entry.find("name"); name != entry.end()) {
    if (!name->is_string()) refuse("cells.bad-name", subject, label + ": its name is not a text");
    cell.name = name->get<std::string>();
    label += fmt::format(" \"{}\"", cell.name);
  }
  cell.min = read_corner(entry, "min", label, subject);
  cell.max = read_corner(entry, "max", label, subject);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(cell.min[axis] < cell.max[axis]))
      refuse("cells.empty-box", subject,
             fmt::format("{}: min {} is not below max {} on {}", label, cell.min[axis], cell.max[axis], "xyz"[axis]),
             "give it a volume, in single precision");
  }
  for (const glm::vec3& corner : {cell.min, cell.max}) {
    for (int axis = 0; axis < 3; ++axis)
      cell.place = mix(cell.place, std::bit_cast<std::uint32_t>(corner[axis] + 0.0f));  // + 0: one zero, not two
  }
  return cell;
}

}  // namespace

std::vector<view_cell> parse_cells(std::string_view text, const std::string& subject) {
  json document;
  try {
    document = json::parse(text);
  } catch (const json::exception& e) {  // a parse error, or a number beyond double
    // The library's text starts with its own name and number in brackets; people need only what follows.
    const std::string what = e.what();
    const auto end = what.find("] ");
    refuse("cells.not-json", subject, "not JSON: " + (end == std::string::npos ? what : what.substr(end + 2)));
  }
  const auto list = document.is_object() ? document.find("cells") : document.end();
  if (!document.is_object() || list == document.end() || !list->is_array())
    refuse("cells.no-list", subject, "has no \"cells\" array");
  if (list->empty()) refuse("cells.no-list", subject, "its \"cells\" array is empty");
  if (list->size() > cell_count_limit)
    refuse("cells.too-many", subject, fmt::format("holds {} cells, more than {}", list->size(), cell_count_limit),
           "split the scene into several bakes");
  std::vector<view_cell> cells;
  cells.reserve(list->size());
  for (std::size_t i = 0; i < list->size(); ++i) cells.push_back(read_cell((*list)[i], i, subject));
  return cells;
}

std::vector<view_cell> read_cells_file(const std::filesystem::path& path) {
  const std::string subject = path.string();
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  if (code) refuse("cells.unreadable", subject, "cannot be read: " + code.message(), "check the path of --cells-file");
  if (size > file_size_limit)
    refuse("cells.too-large", subject, fmt::format("is {} bytes long, more than {}", size, file_size_limit),
           "split the scene into several bakes");
  std::string text(size, '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in.read(text.data(), static_cast<std::streamsize>(size)))
    refuse("cells.unreadable", subject, "cannot be read", "check the path of --cells-file and its permissions");
  return parse_cells(text, subject);
}

}  // namespace sightcell::bake
