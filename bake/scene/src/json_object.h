#pragma once
// Typed reading of glTF's JSON: every value is checked for type and range before anything is done with it, and what is
// wrong is reported as one line that names file, place and cause.
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sightcell::scene {

// Text of a file inside a message: printable, one line, not endless.
std::string printable(const std::string& text, std::size_t limit = 120);

[[noreturn]] void refuse(const std::string& file, const std::string& id, const std::string& cause,
                         const std::string& remedy);

class json_object {
 public:
  // file and where ("accessors[3]", empty for the whole document) are for messages. Throws when the value is no object.
  json_object(const nlohmann::json& value, std::string where, const std::string& file);

  const std::string& where() const { return where_; }
  bool has(const char* key) const { return value_->contains(key); }
  const nlohmann::json* raw(const char* key) const;  // unchecked; null: not there

  // Absent keys give an empty result; wrong types and values out of range throw.
  std::optional<std::uint64_t> number(const char* key, std::uint64_t largest) const;
  std::optional<std::uint32_t> index(const char* key, const char* section, std::size_t section_size) const;
  std::vector<std::uint32_t> indices(const char* key, const char* section, std::size_t section_size) const;
  std::optional<double> real(const char* key) const;
  std::vector<double> reals(const char* key, std::size_t count) const;
  std::vector<double> reals(const char* key) const;  // as many as there are
  std::optional<bool> boolean(const char* key) const;
  std::optional<std::string> text(const char* key) const;
  std::vector<std::string> texts(const char* key) const;
  std::optional<json_object> object(const char* key) const;
  std::vector<json_object> objects(const char* key) const;
  std::vector<std::string> keys() const;

  // The same for keys that must be there.
  std::uint64_t required_number(const char* key, std::uint64_t largest) const;
  std::uint32_t required_index(const char* key, const char* section, std::size_t section_size) const;
  std::string required_text(const char* key) const;
  json_object required_object(const char* key) const;

  [[noreturn]] void fail(const std::string& id, const std::string& cause, const std::string& remedy) const;

 private:
  [[noreturn]] void fail_type(const char* key, const char* expected) const;
  [[noreturn]] void fail_missing(const char* key) const;
  std::uint64_t to_number(const nlohmann::json& value, const char* key, std::uint64_t largest) const;
  std::uint32_t to_index(const nlohmann::json& value, const char* key, const char* section, std::size_t size) const;

  const nlohmann::json* value_;
  std::string where_;
  const std::string* file_;
};

}  // namespace sightcell::scene
