#pragma once
// What was measured, by the content of all that it depends on.
#include <filesystem>
#include <optional>
#include <string>

namespace sightcell::bench {

class kept_files {
 public:
  // The folder is made where it is not there.
  explicit kept_files(std::filesystem::path folder);

  // key: hash_of_text of all that the bytes depend on. kind: the file's ending. Nothing where there is none, or a
  // damaged one: a checksum ends each file.
  std::optional<std::string> read(const std::string& key, const char* kind) const;
  // By rename, so that what is there is whole. Throws sightcell::error where it cannot be written.
  void write(const std::string& key, const char* kind, const std::string& bytes) const;

 private:
  std::filesystem::path path_of(const std::string& key, const char* kind) const;

  std::filesystem::path folder_;
};

}  // namespace sightcell::bench
