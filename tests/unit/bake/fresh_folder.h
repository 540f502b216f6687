#pragma once
// An empty folder for the files of one test, gone with all that is in it when the test ends.
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace sightcell::test {

class fresh_folder {
 public:
  fresh_folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sightcell-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::filesystem::filesystem_error(pattern, last_error());
    path_ = pattern;
  }
  ~fresh_folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  fresh_folder(const fresh_folder&) = delete;
  fresh_folder& operator=(const fresh_folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

 private:
  static std::error_code last_error() { return {errno, std::generic_category()}; }

  std::filesystem::path path_;
};

}  // namespace sightcell::test
