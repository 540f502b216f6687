#pragma once
// The folder of a streamed scene.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>

#include "stream/front_payload.h"

namespace sightcell::bake {

// Returns KIND/HASH.EXTENSION.
std::string path_in_site(const char* kind, const content_name& name, const char* extension);

class site_folder {
 public:
  // Creates the folder and those for pages, cells and images. Throws sightcell::error: pack.not-written.
  explicit site_folder(const std::filesystem::path& path);

  // Creates the folder for another kind of files. Throws sightcell::error: pack.not-written.
  void create(const char* kind) const;

  // Writes KIND/HASH.EXTENSION by rename, unless it has these contents. Any number of threads at once. Throws
  // sightcell::error: pack.not-written.
  listed_file add(const char* kind, const char* extension, std::span<const std::byte> bytes);

  // Replaces a file of the folder and flushes it to the disk: the front, and then what needs it.
  void finish(const char* name, std::span<const std::byte> bytes);

  std::uint32_t written() const { return written_; }
  std::uint32_t kept() const { return kept_; }

 private:
  std::filesystem::path path_;
  std::mutex mutex_;
  std::uint32_t written_ = 0, kept_ = 0;
};

}  // namespace sightcell::bake
