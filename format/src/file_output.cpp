// write_file of writer.h.
#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include "platform_file.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view temporary_mark = ".tmp-";

// No two writers share a temporary file, in any process or thread.
std::string temporary_name(const char* path) {
  static std::atomic<std::uint64_t> counter{0};
  return path + std::string(temporary_mark) + std::to_string(process_number()) + "-" + std::to_string(counter++);
}

// NUMBER-NUMBER, as temporary_name ends.
bool is_writer_and_count(std::u8string_view text) {
  const std::size_t dash = text.find(u8'-');
  const auto is_number = [](std::u8string_view digits) {
    return !digits.empty() &&
           std::all_of(digits.begin(), digits.end(), [](char8_t c) { return c >= u8'0' && c <= u8'9'; });
  };
  return dash != text.npos && is_number(text.substr(0, dash)) && is_number(text.substr(dash + 1));
}

fs::path path_of(const char* utf8) {
  const std::string_view text(utf8);
  return fs::path(std::u8string(text.begin(), text.end()));
}

// False for a device or folder, which rename would replace by a file.
bool is_replaceable(const char* path) {
  std::error_code unknown;
  const fs::file_status there = fs::status(path_of(path), unknown);
  return !fs::exists(there) || fs::is_regular_file(there);
}

bool write_all(std::FILE* file, std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) return false;
  return flush_to_disk(file);
}

status write_beside(const char* path, std::span<const std::byte> bytes) {
  if (!is_replaceable(path)) return status::io;
  const std::string temporary = temporary_name(path);
  std::FILE* file = open_for_writing(temporary.c_str());
  if (file == nullptr) return status::io;
  const bool written = write_all(file, bytes);
  const bool closed = std::fclose(file) == 0;
  if (!written || !closed || !replace_file(temporary.c_str(), path)) {
    remove_file(temporary.c_str());
    return status::io;
  }
  return flush_folder_of(path) ? status::ok : status::io;
}

void remove_beside(const char* path) {
  const fs::path whole = path_of(path), folder = whole.has_parent_path() ? whole.parent_path() : fs::path(".");
  std::u8string beginning = whole.filename().u8string();
  beginning.append(temporary_mark.begin(), temporary_mark.end());
  std::error_code failed;
  fs::directory_iterator entry(folder, failed);
  for (const fs::directory_iterator end; !failed && entry != end; entry.increment(failed)) {
    const std::u8string name = entry->path().filename().u8string();
    if (!name.starts_with(beginning) || !is_writer_and_count(std::u8string_view(name).substr(beginning.size())))
      continue;
    std::error_code ignored;
    fs::remove(entry->path(), ignored);
  }
}

}  // namespace

void remove_unfinished(const char* path) {
  if (path == nullptr || *path == '\0') return;
#if defined(__cpp_exceptions)
  try {
    remove_beside(path);
  } catch (const std::exception&) {
    // Out of memory, or an invalid name: the files stay.
  }
#else
  remove_beside(path);
#endif
}

status write_file(const char* path, std::span<const std::byte> bytes) {
  if (path == nullptr || *path == '\0') return status::argument;
#if defined(__cpp_exceptions)
  try {
    return write_beside(path, bytes);
  } catch (const std::bad_alloc&) {
    return status::memory;
  }
#else
  return write_beside(path, bytes);
#endif
}

}  // namespace sightcell::format
