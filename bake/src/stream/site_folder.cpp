#include "stream/site_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <system_error>
#include <thread>
#include <vector>

#include "sightcell/base/error.h"
#include "sightcell/format/writer.h"

namespace sightcell::bake {
namespace {

[[noreturn]] void fail_to_write(const std::filesystem::path& path) {
  throw error(error_kind::failed, "pack.not-written", path.string(), "cannot be written",
              "free space or choose another -o");
}

bool has_contents(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::error_code failed;
  if (std::filesystem::file_size(path, failed) != bytes.size() || failed) return false;
  std::vector<char> found(bytes.size());
  std::ifstream in(path, std::ios::binary);
  in.read(found.data(), static_cast<std::streamsize>(found.size()));
  return in && std::equal(found.begin(), found.end(), reinterpret_cast<const char*>(bytes.data()));
}

}  // namespace

std::string path_in_site(const char* kind, const content_name& name, const char* extension) {
  return fmt::format("{}/{:02x}.{}", kind, fmt::join(name, ""), extension);
}

site_folder::site_folder(const std::filesystem::path& path) : path_(path) {
  for (const char* kind : {"pages", "cells", "images"}) create(kind);
}

void site_folder::create(const char* kind) const {
  std::error_code failed;
  std::filesystem::create_directories(path_ / kind, failed);
  if (failed) fail_to_write(path_ / kind);
}

listed_file site_folder::add(const char* kind, const char* extension, std::span<const std::byte> bytes) {
  const listed_file out{static_cast<std::uint32_t>(bytes.size()), name_of(bytes)};
  const std::filesystem::path path = path_ / path_in_site(kind, out.name, extension);
  const std::lock_guard lock(mutex_);  // equal contents have one name, which two threads must not write at once
  if (has_contents(path, bytes)) {
    ++kept_;
    return out;
  }
  // Not flushed to the disk: another run finds and replaces what a power failure damaged, and the front comes last.
  std::filesystem::path part = path;
  part += ".part";
  std::ofstream file(part, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code failed;
  if (file) std::filesystem::rename(part, path, failed);
  if (!file || failed) {
    std::filesystem::remove(part, failed);
    fail_to_write(path);
  }
  ++written_;
  return out;
}

void site_folder::finish(const char* name, std::span<const std::byte> bytes) {
  const std::filesystem::path path = path_ / name;
  format::remove_unfinished(path.string().c_str());
  if (has_contents(path, bytes)) {
    ++kept_;
    return;
  }
  if (format::write_file(path.string().c_str(), bytes) != format::status::ok) fail_to_write(path);
  ++written_;
}

}  // namespace sightcell::bake
