#include "cells/cells_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cells/explicit_cells.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace sightcell::bake {

namespace {

using nlohmann::json;

constexpr std::uintmax_t file_size_limit = 256u << 20;  // bytes; a million cells take about a third of it

constexpr const char* shape = R"(write {"cells":[{"name":"lane 3","min":[x,y,z],"max":[x,y,z]}]}, in meters)";

[[noreturn]] void refuse(const char* id, const std::string& subject, const std::string& cause,
                         const std::string& remedy = shape) {
  throw error(error_kind::bad_input, id, subject, cause, remedy);
}

std::array<float, 3> read_corner(const json& cell, const char* key, const std::string& label,
                                 const std::string& subject) {
  const auto found = cell.find(key);
  if (found == cell.end() || !found->is_array() || found->size() != 3)
    refuse("cells.bad-box", subject, fmt::format("{} has no \"{}\" of three numbers", label, key));
  std::array<float, 3> corner{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const json& number = (*found)[axis];
    if (!number.is_number())
      refuse("cells.bad-box", subject, fmt::format("{}: \"{}\" holds a {}", label, key, number.type_name()));
    // The clamped value is outside of the coordinate limit in any case.
    corner[axis] = static_cast<float>(std::clamp(number.get<double>(), -1e30, 1e30));
  }
  return corner;
}

cell_box read_cell(const json& entry, std::size_t number, const std::string& subject) {
  std::string label = fmt::format("cell {}", number);
  if (!entry.is_object()) refuse("cells.bad-box", subject, label + " is not an object");
  cell_box cell;
  if (const auto name = entry.find("name"); name != entry.end()) {
    if (!name->is_string()) refuse("cells.bad-name", subject, label + ": its \"name\" is not a string");
    cell.name = name->get<std::string>();
    label += fmt::format(" \"{}\"", cell.name);
  }
  cell.min = read_corner(entry, "min", label, subject);
  cell.max = read_corner(entry, "max", label, subject);
  return cell;
}

}  // namespace

json parse_cells_json(std::string_view text, const std::string& subject) {
  try {
    return scene::parse_json(text);
  } catch (const json::exception& e) {  // a parse error, or a number that exceeds double
    // The library's text begins with its own name and number in brackets, which users do not need.
    const std::string what = e.what();
    const auto end = what.find("] ");
    refuse("cells.not-json", subject, "not JSON: " + (end == std::string::npos ? what : what.substr(end + 2)));
  }
}

std::vector<view_cell> parse_cells(std::string_view text, const std::string& subject) {
  const json document = parse_cells_json(text, subject);
  const auto list = document.is_object() ? document.find("cells") : document.end();
  if (!document.is_object() || list == document.end() || !list->is_array())
    refuse("cells.no-list", subject, "has no \"cells\" array");
  if (list->empty()) refuse("cells.no-list", subject, "its \"cells\" array is empty");
  std::vector<cell_box> boxes;
  boxes.reserve(list->size());
  for (std::size_t i = 0; i < list->size(); ++i) boxes.push_back(read_cell((*list)[i], i, subject));
  return explicit_cells(boxes, subject, "give meters near the origin, min below max on every axis");
}

std::string read_cells_text(const std::filesystem::path& path) {
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
  return text;
}

std::vector<view_cell> read_cells_file(const std::filesystem::path& path) {
  return parse_cells(read_cells_text(path), path.string());
}

}  // namespace sightcell::bake
