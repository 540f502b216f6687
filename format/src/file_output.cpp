// write_file of writer.h.
#include <atomic>
#include <new>
#include <string>

#include "platform_file.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {
namespace {

// No two writers share a temporary file, whichever process or thread they are in.
std::string temporary_name(const char* path) {
  static std::atomic<std::uint64_t> counter{0};
  return std::string(path) + ".tmp-" + std::to_string(process_number()) + "-" + std::to_string(counter++);
}

bool write_all(std::FILE* file, std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) return false;
  return flush_to_disk(file);
}

status write_beside(const char* path, std::span<const std::byte> bytes) {
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

}  // namespace

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
