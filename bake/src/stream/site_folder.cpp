#include "stream/site_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <system_error>
#include <thread>

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

site_folder::site_folder(const std::filesystem::path& path, stream_copies copies) : path_(path), copies_(copies) {
  for (const char* kind : {"pages", "cells", "images"}) create(kind);
}

void site_folder::create(const char* kind) const {
  std::error_code failed;
  std::filesystem::create_directories(path_ / kind, failed);
  if (failed) fail_to_write(path_ / kind);
}

listed_file site_folder::add(const char* kind, const char* extension, std::span<const std::byte> bytes) {
  const listed_file out{static_cast<std::uint32_t>(bytes.size()), name_of(bytes)};
  write(path_ / path_in_site(kind, out.name, extension), bytes);
  return out;
}

added_file site_folder::add_with_copies(const char* kind, const char* extension, std::span<const std::byte> bytes) {
  const std::vector<encoded_copy> copies = encoded_copies(bytes, copies_);
  const added_file out{add(kind, extension, bytes), sent_with(copies, bytes.size())};
  for (const encoded_copy& copy : copies)
    if (!copy.bytes.empty()) write(path_ / (path_in_site(kind, out.file.name, extension) + copy.extension), copy.bytes);
  return out;
}

void site_folder::write(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const std::lock_guard lock(mutex_);  // equal contents have one name, which two threads must not write at once
  if (has_contents(path, bytes)) {
    ++kept_;
    return;
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
}

void site_folder::finish(const char* name, std::span<const std::byte> bytes) {
  finish_all(name, bytes, {});
}

sent_bytes site_folder::finish_with_copies(const char* name, std::span<const std::byte> bytes) {
  const std::vector<encoded_copy> copies = encoded_copies(bytes, copies_);
  finish_all(name, bytes, copies);
  return sent_with(copies, bytes.size());
}

// At no time is a copy there that does not have the contents of the file.
void site_folder::finish_all(const char* name, std::span<const std::byte> bytes,
                             const std::vector<encoded_copy>& copies) {
  for (const char* const extension : copy_extensions) {
    const auto copy = std::find_if(copies.begin(), copies.end(),
                                   [&](const auto& c) { return c.extension == std::string(extension); });
    const std::filesystem::path path = path_ / (std::string(name) + extension);
    if (copy != copies.end() && !copy->bytes.empty() && has_contents(path, copy->bytes)) continue;
    std::error_code failed;
    std::filesystem::remove(path, failed);
    if (failed) fail_to_write(path);
  }
  finish_one(path_ / name, bytes);
  for (const encoded_copy& copy : copies)
    if (!copy.bytes.empty()) finish_one(path_ / (std::string(name) + copy.extension), copy.bytes);
}

void site_folder::finish_one(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  format::remove_unfinished(path.string().c_str());
  if (has_contents(path, bytes)) {
    ++kept_;
    return;
  }
  if (format::write_file(path.string().c_str(), bytes) != format::status::ok) fail_to_write(path);
  ++written_;
}

}  // namespace sightcell::bake
