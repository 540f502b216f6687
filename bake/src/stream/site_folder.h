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

class site_folder {
 public:
  // Creates the folder and those for `kinds`. Throws sightcell::error: pack.not-written.
  explicit site_folder(const std::filesystem::path& path);

  // Writes KIND/HASH.EXTENSION by rename, unless it has these contents. Any number of threads at once. Throws
  // sightcell::error: pack.not-written.
  listed_file add(const char* kind, const char* extension, std::span<const std::byte> bytes);

  // Replaces the front and flushes it to the disk.
  void finish(std::span<const std::byte> front);

  std::uint32_t written() const { return written_; }
  std::uint32_t kept() const { return kept_; }

 private:
  std::filesystem::path path_;
  std::mutex mutex_;
  std::uint32_t written_ = 0, kept_ = 0;
};

}  // namespace sightcell::bake
