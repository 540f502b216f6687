#pragma once
// Typed access to the JSON of glTF. Each value is checked for type and range before it is used. Errors are one line
// with file, place and cause.
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sightcell::scene {

// Returns text of a file for a message: printable, on one line, shortened to limit bytes.
std::string printable(const std::string& text, std::size_t limit = 120);

// Throws sightcell::error (bad_input).
[[noreturn]] void refuse(const std::string& file, const std::string& id, const std::string& cause,
                         const std::string& remedy);

// A JSON object with checked access. The value must outlive it.
class json_object {
 public:
  // file, where: for messages; where is "accessors[3]", or empty for the whole document. Throws sightcell::error if
  // the value is no object.
  json_object(const nlohmann::json& value, std::string where, const std::string& file);

  const std::string& where() const { return where_; }
  bool has(const char* key) const { return value_->contains(key); }
  const nlohmann::json* raw(const char* key) const;  // unchecked; null: missing

  // For a missing key the result is empty. Wrong types and values out of range throw sightcell::error.
  std::optional<std::uint64_t> number(const char* key, std::uint64_t largest) const;
  std::optional<std::uint32_t> index(const char* key, const char* section, std::size_t section_size) const;
  std::vector<std::uint32_t> indices(const char* key, const char* section, std::size_t section_size) const;
  std::optional<double> real(const char* key) const;
  std::vector<double> reals(const char* key, std::size_t count) const;
  std::vector<double> reals(const char* key) const;  // of any number
  std::optional<bool> boolean(const char* key) const;
  std::optional<std::string> text(const char* key) const;
  std::vector<std::string> texts(const char* key) const;
  std::optional<json_object> object(const char* key) const;
  std::vector<json_object> objects(const char* key) const;
  std::vector<std::string> keys() const;

  // For required keys: a missing key throws too.
  std::uint64_t required_number(const char* key, std::uint64_t largest) const;
  std::uint32_t required_index(const char* key, const char* section, std::size_t section_size) const;
  std::string required_text(const char* key) const;
  json_object required_object(const char* key) const;

  // Throws sightcell::error that names the file and the place of this object.
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
