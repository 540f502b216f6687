#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "report/collect.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace sightcell::cli {
namespace {

using nlohmann::ordered_json;

ordered_json read_result(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in || std::filesystem::is_directory(path))
    throw error(error_kind::bad_input, "cli.unreadable", path.string(), "cannot be read",
                "check the path and its permissions");
  ordered_json result = scene::parse_ordered_json(text, false);
  if (!result.is_object())
    throw error(error_kind::bad_input, "report.not-json", path.string(), "is not a JSON object",
                "give a file that --json wrote");
  return result;
}

[[noreturn]] void refuse_other(const std::filesystem::path& path, const std::string& cause) {
  throw error(error_kind::bad_input, "report.other-file", path.string(), cause,
              "run the verb again for this .pvs file, with --json");
}

bool has_number(const ordered_json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number();
}

bool is_number_below(const ordered_json& object, const char* key, std::uint64_t end) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number_unsigned() && found->get<std::uint64_t>() < end;
}

bool is_point(const ordered_json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != 3) return false;
  for (const ordered_json& one : *found)
    if (!one.is_number() || !(std::abs(one.get<double>()) < 1e9)) return false;
  return true;
}

bool is_miss_of(const ordered_json& one, const pvs_file& file) {
  return one.is_object() && is_number_below(one, "cell", file.content().cell_count()) &&
         is_number_below(one, "polygon", file.content().polygon_count()) && is_number_below(one, "rays", UINT64_MAX) &&
         is_point(one, "eye") && is_point(one, "target") && one.contains("node_name") && one["node_name"].is_string();
}

}  // namespace

ordered_json read_verify_result(const std::filesystem::path& path, const pvs_file& file) {
  ordered_json result = read_result(path);
  for (const char* key : {"rays", "misses", "upper_bound", "confidence", "max_pixel_error", "cells"})
    if (!has_number(result, key)) refuse_other(path, fmt::format("has no number \"{}\" of sightcell verify", key));
  if (result["cells"].get<double>() > file.content().cell_count()) refuse_other(path, "is of a file with more cells");
  const auto missing = result.find("missing");
  if (missing == result.end() || !missing->is_array()) refuse_other(path, "has no list \"missing\"");
  for (const ordered_json& one : *missing)
    if (!is_miss_of(one, file)) refuse_other(path, "names a missing polygon that this file cannot have");
  return result;
}

ordered_json read_bake_result(const std::filesystem::path& path, const pvs_file& file) {
  ordered_json result = read_result(path);
  for (const char* key : {"cells", "polygons", "bytes", "cpu_seconds"})
    if (!has_number(result, key)) refuse_other(path, fmt::format("has no number \"{}\" of sightcell bake", key));
  if (result["cells"] != file.content().cell_count() || result["polygons"] != file.content().polygon_count() ||
      result["bytes"] != file.size())
    refuse_other(path, "is of another file: the numbers of cells, polygons or bytes differ");
  return result;
}

}  // namespace sightcell::cli
