#pragma once
// The folder of a streamed scene.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/stream.h"
#include "stream/encoded_copies.h"
#include "stream/front_payload.h"

namespace sightcell::bake {

// Returns KIND/HASH.EXTENSION.
std::string path_in_site(const char* kind, const content_name& name, const char* extension);

struct added_file {
  listed_file file;
  sent_bytes sent;
};

class site_folder {
 public:
  // Creates the folder and those for pages, cells and images. Throws sightcell::error: pack.not-written.
  // copies: of files that add_with_copies and finish_with_copies write.
  site_folder(const std::filesystem::path& path, stream_copies copies);

  // Creates the folder for another kind of files. Throws sightcell::error: pack.not-written.
  void create(const char* kind) const;

  // Writes KIND/HASH.EXTENSION by rename, unless it has these contents. Any number of threads at once. Throws
  // sightcell::error: pack.not-written.
  listed_file add(const char* kind, const char* extension, std::span<const std::byte> bytes);

  // As `add`, with compressed copies beside the file where they are smaller.
  added_file add_with_copies(const char* kind, const char* extension, std::span<const std::byte> bytes);

  // Replaces a file of the folder and flushes it to the disk: the front, and then what needs it. Removes compressed
  // copies of the older version, which a server would send in its place.
  void finish(const char* name, std::span<const std::byte> bytes);

  // As `finish`, with compressed copies. Returns the bytes that are sent.
  sent_bytes finish_with_copies(const char* name, std::span<const std::byte> bytes);

  std::uint32_t written() const { return written_; }
  std::uint32_t kept() const { return kept_; }

 private:
  void write(const std::filesystem::path& path, std::span<const std::byte> bytes);
  void finish_all(const char* name, std::span<const std::byte> bytes, const std::vector<encoded_copy>& copies);
  void finish_one(const std::filesystem::path& path, std::span<const std::byte> bytes);

  std::filesystem::path path_;
  stream_copies copies_;
  std::mutex mutex_;
  std::uint32_t written_ = 0, kept_ = 0;
};

}  // namespace sightcell::bake
