#include "pvs_file.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "sightcell/bake/settings.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"
#include "sightcell/format/eye_table.h"
#include "sightcell/format/layout.h"
#include "sightcell/scene/embed.h"

namespace sightcell::cli {

namespace {

std::vector<std::byte> read_bytes(const std::filesystem::path& path) {
  const auto refuse = [&path](const std::string& cause) {
    throw error(error_kind::bad_input, "cli.unreadable", path.string(), "cannot be read: " + cause,
                "check the path and its permissions");
  };
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  if (code) refuse(code.message());
  std::vector<std::byte> bytes(size);
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) refuse("read error");
  return bytes;
}

bool begins_like_pvs(const std::filesystem::path& path) {
  std::array<std::uint8_t, format::layout::magic.size()> first{};
  std::ifstream in(path, std::ios::binary);
  in.read(reinterpret_cast<char*>(first.data()), first.size());
  return first == format::layout::magic;
}

}  // namespace

pvs_file::pvs_file(std::filesystem::path path, std::vector<std::byte> bytes)
    : path_(std::move(path)), bytes_(std::move(bytes)) {
  check(format::reader::open(bytes_, reader_));
  format::eye_table eyes;  // open() skips them
  const format::status of_eyes = format::eye_table::open(reader_, eyes);
  if (of_eyes != format::status::absent) check(of_eyes);
}

void pvs_file::check(format::status status) const {
  if (status == format::status::ok) return;
  throw error(error_kind::bad_input, "pvs.refused", path_.string(), format::status_text(status),
              "bake the scene again, or use the Sightcell that made the file");
}

std::optional<pvs_file> pvs_file::open_if_pvs(const std::filesystem::path& path) {
  if (path.extension() != ".pvs" && !begins_like_pvs(path)) return std::nullopt;
  return open(path);
}

pvs_file pvs_file::open(const std::filesystem::path& path) {
  return {path, read_bytes(path)};
}

pvs_file pvs_file::open_or_embedded(const std::filesystem::path& path) {
  if (path.extension() != ".glb" && path.extension() != ".gltf") return open(path);
  std::optional<scene::embedded_pvs> found = scene::read_embedded(path);
  if (!found)
    throw error(error_kind::bad_input, "embed.none", path.string(), "contains and names no .pvs file",
                "name the .pvs file, or bake the scene with --embed");
  return of_bytes(path, std::move(found->bytes));
}

pvs_file pvs_file::of_bytes(const std::filesystem::path& path, std::vector<std::byte> bytes) {
  return {path, std::move(bytes)};
}

format::row_statistics pvs_file::statistics() const {
  format::row_statistics sums;
  check(sets().statistics(sums));
  return sums;
}

format::set_reader pvs_file::sets() const {
  format::set_reader sets;
  check(sets.open(reader_));
  return sets;
}

format::box pvs_file::cell_box(std::uint32_t cell) const {
  format::box b;
  check(reader_.cell_box(cell, b));
  return b;
}

scene::animated_as pvs_file::animated() const {
  const auto settings = scene::parse_json(reader_.settings(), false);
  const auto found = settings.is_object() ? settings.find("animated") : settings.end();
  const auto named = found != settings.end() && found->is_string() ? found->get<std::string>() : std::string();
  return scene::animated_as_of(named).value_or(scene::animated_as::always);
}

std::string_view pvs_file::metric() const {
  const auto settings = scene::parse_json(reader_.settings(), false);
  const auto found = settings.is_object() ? settings.find("metric") : settings.end();
  const auto& names = bake::metric_names;
  const auto name = found != settings.end() ? std::find(names.begin(), names.end(), *found) : names.end();
  return name != names.end() ? *name : names.front();
}

double pvs_file::requested_bound() const {
  constexpr double without = bake::max_pixel_error_of_quality[static_cast<std::size_t>(bake::quality::normal)];
  const auto settings = scene::parse_json(reader_.settings(), false);
  const auto found = settings.is_object() ? settings.find("max_pixel_error") : settings.end();
  if (found == settings.end() || !found->is_number()) return without;
  const auto bound = found->get<double>();
  return bound > 0.0 && bound <= 1.0 ? bound : without;
}

int pvs_file::scene() const {
  const auto settings = scene::parse_json(reader_.settings(), false);
  if (!settings.is_object()) return -1;
  const auto scene = settings.find("scene");
  const bool given = scene != settings.end() && scene->is_number_unsigned() && *scene <= INT32_MAX;
  return given ? scene->get<int>() : -1;
}

std::vector<std::uint32_t> pvs_file::cell_set(std::uint32_t cell) const {
  std::vector<std::uint32_t> set;
  check(sets().source_ids(cell, set));
  return set;
}

}  // namespace sightcell::cli
