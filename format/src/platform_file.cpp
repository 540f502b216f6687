#include "platform_file.h"

#include <cerrno>
#include <string>

#if defined(_WIN32)
#define WIN32_LEAN_AND_MEAN
#if !defined(NOMINMAX)  // mingw's libstdc++ defines it too
#define NOMINMAX
#endif
#include <windows.h>
#else
#include <fcntl.h>
#include <unistd.h>
#endif

namespace sightcell::format {

#if defined(_WIN32)

namespace {

std::wstring wide(const char* utf8) {
  const int size = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, utf8, -1, nullptr, 0);
  if (size <= 0) return {};
  std::wstring text(static_cast<std::size_t>(size), L'\0');
  MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, utf8, -1, text.data(), size);
  return text;
}

}  // namespace

std::FILE* open_for_writing(const char* path) {
  return _wfopen(wide(path).c_str(), L"wbc");  // c: fflush() writes to the disk
}

bool flush_to_disk(std::FILE* file) noexcept {
  return std::fflush(file) == 0;
}

bool replace_file(const char* from, const char* to) {
  return MoveFileExW(wide(from).c_str(), wide(to).c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0;
}

bool flush_folder_of(const char*) {
  return true;
}

bool remove_file(const char* path) {
  return _wremove(wide(path).c_str()) == 0;
}

std::uint64_t process_number() noexcept {
  return static_cast<std::uint64_t>(GetCurrentProcessId());
}

#else

std::FILE* open_for_writing(const char* path) {
  return std::fopen(path, "wb");
}

bool flush_to_disk(std::FILE* file) noexcept {
  return std::fflush(file) == 0 && fsync(fileno(file)) == 0;
}

bool replace_file(const char* from, const char* to) {
  return std::rename(from, to) == 0;
}

bool flush_folder_of(const char* path) {
  const std::string name(path);
  const std::size_t slash = name.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : name.substr(0, slash + 1);
  const int handle = ::open(folder.c_str(), O_RDONLY);
  if (handle < 0) return true;
  const bool failed = fsync(handle) != 0 && errno == EIO;
  ::close(handle);
  return !failed;
}

bool remove_file(const char* path) {
  return std::remove(path) == 0;
}

std::uint64_t process_number() noexcept {
  return static_cast<std::uint64_t>(getpid());
}

#endif

}  // namespace sightcell::format
