#include "misses/misses_file.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace sightcell::bake {
namespace {

using nlohmann::json;

constexpr std::uintmax_t file_size_limit = 16u << 20;  // bytes; about 300,000 misses
constexpr double farthest = 1e7;                       // meters, as for cells
constexpr const char* shape = R"(write {"misses":[{"eye":[x,y,z],"polygon":1234}]}, meters and source ids)";

[[noreturn]] void refuse(const char* id, const std::string& subject, const std::string& cause,
                         const std::string& remedy = shape) {
  throw error(error_kind::bad_input, id, subject, cause, remedy);
}

json parse(std::string_view text, const std::string& subject) {
  try {
    return scene::parse_json(text);
  } catch (const json::exception& e) {  // a parse error, or a number beyond double
    // The library's text starts with its own name and number in brackets, which mean nothing to users.
    const std::string what = e.what();
    const auto end = what.find("] ");
    refuse("misses.not-json", subject, "not JSON: " + (end == std::string::npos ? what : what.substr(end + 2)));
  }
}

// The fingerprint is optional. If it is there, it must be that of the scene.
void check_fingerprint(const json& document, const std::string& subject, const scene::scene& s) {
  const auto found = document.find("scene_fingerprint");
  if (found == document.end()) return;
  std::string digits = found->is_string() ? found->get<std::string>() : std::string();
  for (char& c : digits) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (digits.size() != 2 * s.fingerprint.size() || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
    refuse("misses.bad-report", subject, "its \"scene_fingerprint\" is not 32 hex digits",
           "write the fingerprint that sightcell info shows, or leave it out");
  const std::string own = fmt::format("{:02x}", fmt::join(s.fingerprint, ""));
  if (digits != own)
    refuse("misses.other-scene", subject,
           fmt::format("is of a scene with the fingerprint {}, and {} has {}", digits, s.name, own),
           "give misses of this scene: source ids of another scene mean other polygons");
}

glm::vec3 read_eye(const json& miss, const std::string& label, const std::string& subject) {
  const auto found = miss.find("eye");
  if (found == miss.end() || !found->is_array() || found->size() != 3)
    refuse("misses.bad-report", subject, label + " has no \"eye\" of three numbers");
  glm::vec3 eye;
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    const json& number = (*found)[static_cast<std::size_t>(axis)];
    if (!number.is_number())
      refuse("misses.bad-report", subject, fmt::format("{}: its \"eye\" contains a {}", label, number.type_name()));
    const auto value = number.get<double>();
    if (!(std::abs(value) <= farthest))
      refuse("misses.bad-report", subject, fmt::format("{}: its eye is at {} m", label, value),
             "give an eye within 10,000 km of the origin");
    eye[axis] = static_cast<float>(value) + 0.0f;  // -0 becomes 0
  }
  return eye;
}

reported_miss read_miss(const json& entry, std::size_t number, const std::string& subject, const scene::scene& s) {
  const std::string label = fmt::format("miss {}", number);
  if (!entry.is_object()) refuse("misses.bad-report", subject, label + " is not an object");
  reported_miss miss;
  miss.eye = read_eye(entry, label, subject);
  const auto polygon = entry.find("polygon");
  if (polygon == entry.end() || !polygon->is_number_unsigned())
    refuse("misses.bad-report", subject, label + " has no \"polygon\" that is a source id");
  const auto id = polygon->get<std::uint64_t>();
  if (id >= s.polygon_count)
    refuse("misses.no-such-polygon", subject, fmt::format("{}: polygon {} of {}", label, id, s.polygon_count),
           "use source ids of this scene");
  miss.polygon = static_cast<std::uint32_t>(id);
  return miss;
}

std::string read_text(const std::filesystem::path& path) {
  const std::string subject = path.string();
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  if (code) refuse("misses.unreadable", subject, "cannot be read: " + code.message(), "check its path");
  if (size > file_size_limit)
    refuse("misses.too-large", subject, fmt::format("is {} bytes long, more than {}", size, file_size_limit),
           "split it, and give the files to one run after the other");
  std::string text(size, '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in.read(text.data(), static_cast<std::streamsize>(size)))
    refuse("misses.unreadable", subject, "cannot be read", "check its path and permissions");
  return text;
}

}  // namespace

std::vector<reported_miss> parse_misses(std::string_view text, const std::string& subject, const scene::scene& s) {
  const json document = parse(text, subject);
  const auto list = document.is_object() ? document.find("misses") : document.end();
  if (!document.is_object() || list == document.end() || !list->is_array())
    refuse("misses.no-list", subject, "has no \"misses\" array");
  check_fingerprint(document, subject, s);
  std::vector<reported_miss> misses;
  misses.reserve(list->size());
  for (std::size_t i = 0; i < list->size(); ++i) misses.push_back(read_miss((*list)[i], i, subject, s));
  return misses;
}

std::vector<reported_miss> read_misses(const std::filesystem::path& path, const scene::scene& s) {
  return parse_misses(read_text(path), path.string(), s);
}

}  // namespace sightcell::bake
