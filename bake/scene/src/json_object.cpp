#include "json_object.h"

#include <cmath>
#include <utility>

#include "sightcell/base/error.h"

namespace sightcell::scene {

std::string printable(const std::string& text, std::size_t limit) {
  std::string out;
  for (const char c : text) {
    if (out.size() >= limit) return out + "...";
    const auto byte = static_cast<unsigned char>(c);
    out += byte < 0x20 || byte == 0x7F ? '?' : c;
  }
  return out;
}

void refuse(const std::string& file, const std::string& id, const std::string& cause, const std::string& remedy) {
  throw error(error_kind::bad_input, id, file, cause, remedy);
}

json_object::json_object(const nlohmann::json& value, std::string where, const std::string& file)
    : value_(&value), where_(std::move(where)), file_(&file) {
  if (!value.is_object()) fail("scene.bad-field", "is not a JSON object", "export the file again");
}

void json_object::fail(const std::string& id, const std::string& cause, const std::string& remedy) const {
  refuse(*file_, id, (where_.empty() ? "it" : where_) + " " + cause, remedy);
}

const nlohmann::json* json_object::raw(const char* key) const {
  const auto it = value_->find(key);
  return it == value_->end() ? nullptr : &*it;
}

void json_object::fail_type(const char* key, const char* expected) const {
  fail("scene.bad-field", std::string("has a \"") + key + "\" that is not " + expected, "export the file again");
}

void json_object::fail_missing(const char* key) const {
  fail("scene.missing-field", std::string("has no \"") + key + "\"", "export the file again");
}

std::uint64_t json_object::to_number(const nlohmann::json& value, const char* key, std::uint64_t largest) const {
  std::uint64_t number = 0;
  if (value.is_number_unsigned()) {
    number = value.get<std::uint64_t>();
  } else if (value.is_number_float() && value.get<double>() >= 0.0 && value.get<double>() < 9007199254740992.0 &&
             std::floor(value.get<double>()) == value.get<double>()) {
    number = static_cast<std::uint64_t>(value.get<double>());  // "3.0" is a whole number in JSON
  } else {
    fail_type(key, "a whole number of 0 or more");
  }
  if (number > largest) {
    fail("scene.bad-field",
         std::string("has a \"") + key + "\" of " + std::to_string(number) + ", above the limit " +
             std::to_string(largest),
         "export the file again");
  }
  return number;
}

std::uint32_t json_object::to_index(const nlohmann::json& value, const char* key, const char* section,
                                    std::size_t size) const {
  const std::uint64_t number = to_number(value, key, UINT64_MAX);
  if (number >= size) {
    fail("scene.index-out-of-range",
         std::string("refers to ") + section + "[" + std::to_string(number) + "] by \"" + key +
             "\", but the file has " + std::to_string(size),
         "export the file again");
  }
  return static_cast<std::uint32_t>(number);
}

std::optional<std::uint64_t> json_object::number(const char* key, std::uint64_t largest) const {
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return std::nullopt;
  return to_number(*value, key, largest);
}

std::optional<std::uint32_t> json_object::index(const char* key, const char* section, std::size_t section_size) const {
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return std::nullopt;
  return to_index(*value, key, section, section_size);
}

std::vector<std::uint32_t> json_object::indices(const char* key, const char* section, std::size_t section_size) const {
  std::vector<std::uint32_t> out;
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return out;
  if (!value->is_array()) fail_type(key, "an array");
  out.reserve(value->size());
  for (const nlohmann::json& entry : *value) out.push_back(to_index(entry, key, section, section_size));
  return out;
}

std::optional<double> json_object::real(const char* key) const {
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_number()) fail_type(key, "a number");
  return value->get<double>();
}

std::vector<double> json_object::reals(const char* key, std::size_t count) const {
  std::vector<double> out;
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return out;
  const std::string expected = "an array of " + std::to_string(count) + " numbers";
  if (!value->is_array() || value->size() != count) fail_type(key, expected.c_str());
  for (const nlohmann::json& entry : *value) {
    if (!entry.is_number()) fail_type(key, expected.c_str());
    out.push_back(entry.get<double>());
  }
  return out;
}

std::vector<double> json_object::reals(const char* key) const {
  std::vector<double> out;
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return out;
  if (!value->is_array()) fail_type(key, "an array of numbers");
  for (const nlohmann::json& entry : *value) {
    if (!entry.is_number()) fail_type(key, "an array of numbers");
    out.push_back(entry.get<double>());
  }
  return out;
}

std::optional<bool> json_object::boolean(const char* key) const {
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_boolean()) fail_type(key, "true or false");
  return value->get<bool>();
}

std::optional<std::string> json_object::text(const char* key) const {
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_string()) fail_type(key, "a string");
  return value->get<std::string>();
}

std::vector<std::string> json_object::texts(const char* key) const {
  std::vector<std::string> out;
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return out;
  if (!value->is_array()) fail_type(key, "an array of strings");
  for (const nlohmann::json& entry : *value) {
    if (!entry.is_string()) fail_type(key, "an array of strings");
    out.push_back(entry.get<std::string>());
  }
  return out;
}

std::optional<json_object> json_object::object(const char* key) const {
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return std::nullopt;
  return json_object(*value, where_.empty() ? key : where_ + "." + key, *file_);
}

std::vector<json_object> json_object::objects(const char* key) const {
  std::vector<json_object> out;
  const nlohmann::json* value = raw(key);
  if (value == nullptr) return out;
  if (!value->is_array()) fail_type(key, "an array");
  const std::string prefix = where_.empty() ? key : where_ + "." + key;
  out.reserve(value->size());
  for (const nlohmann::json& entry : *value) {
    out.emplace_back(entry, prefix + "[" + std::to_string(out.size()) + "]", *file_);
  }
  return out;
}

std::vector<std::string> json_object::keys() const {
  std::vector<std::string> out;
  for (auto it = value_->begin(); it != value_->end(); ++it) out.push_back(it.key());
  return out;
}

std::uint64_t json_object::required_number(const char* key, std::uint64_t largest) const {
  const auto found = number(key, largest);
  if (!found) fail_missing(key);
  return *found;
}

std::uint32_t json_object::required_index(const char* key, const char* section, std::size_t section_size) const {
  const auto found = index(key, section, section_size);
  if (!found) fail_missing(key);
  return *found;
}

std::string json_object::required_text(const char* key) const {
  auto found = text(key);
  if (!found) fail_missing(key);
  return *std::move(found);
}

json_object json_object::required_object(const char* key) const {
  auto found = object(key);
  if (!found) fail_missing(key);
  return *std::move(found);
}

}  // namespace sightcell::scene
