#include "file_input.h"

#include <cstdio>
#include <limits>

#if defined(_WIN32)
#define WIN32_LEAN_AND_MEAN
#if !defined(NOMINMAX)  // mingw's libstdc++ defines it too
#define NOMINMAX
#endif
#include <windows.h>
#endif

namespace sightcell::runtime {
namespace {

#if defined(_WIN32)

// Converts path to Windows' encoding. The system allows 32,767 characters: too many for the stacks of some hosts.
sightcell_status open_for_reading(const char* path, const sightcell_allocator& mem, std::FILE*& out) noexcept {
  const int letters = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, nullptr, 0);
  if (letters <= 0) return SIGHTCELL_ERR_IO;
  wchar_t few[260];
  const bool fits = letters <= static_cast<int>(sizeof(few) / sizeof(few[0]));
  const std::uint64_t size = static_cast<std::uint64_t>(letters) * sizeof(wchar_t);
  auto* wide = fits ? few : static_cast<wchar_t*>(allocate(mem, size));
  if (wide == nullptr) return SIGHTCELL_ERR_MEMORY;
  if (MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide, letters) > 0) out = _wfopen(wide, L"rb");
  if (!fits) release(mem, wide, size);
  return out == nullptr ? SIGHTCELL_ERR_IO : SIGHTCELL_OK;
}
bool seek_end(std::FILE* file) noexcept {
  return _fseeki64(file, 0, SEEK_END) == 0;
}
std::int64_t position_in(std::FILE* file) noexcept {
  return _ftelli64(file);
}

#else

sightcell_status open_for_reading(const char* path, const sightcell_allocator&, std::FILE*& out) noexcept {
  out = std::fopen(path, "rb");
  return out == nullptr ? SIGHTCELL_ERR_IO : SIGHTCELL_OK;
}
bool seek_end(std::FILE* file) noexcept {
  return fseeko(file, 0, SEEK_END) == 0;
}
std::int64_t position_in(std::FILE* file) noexcept {
  return ftello(file);
}

#endif

sightcell_status read_open_file(std::FILE* file, const sightcell_allocator& mem, file_block& out) noexcept {
  // On some systems a folder opens as a file of enormous size; only reading shows that it is none.
  if (std::fgetc(file) == EOF) return std::ferror(file) != 0 ? SIGHTCELL_ERR_IO : SIGHTCELL_ERR_TRUNCATED;
  if (!seek_end(file)) return SIGHTCELL_ERR_IO;
  const std::int64_t size = position_in(file);
  if (size <= 0) return SIGHTCELL_ERR_IO;
  if (static_cast<std::uint64_t>(size) > std::numeric_limits<std::size_t>::max()) return SIGHTCELL_ERR_LIMIT;
  std::rewind(file);
  file_block block{allocate(mem, static_cast<std::uint64_t>(size)), static_cast<std::uint64_t>(size)};
  if (block.bytes == nullptr) return SIGHTCELL_ERR_MEMORY;
  if (std::fread(block.bytes, 1, static_cast<std::size_t>(size), file) != static_cast<std::size_t>(size)) {
    release(mem, block.bytes, block.size);
    return SIGHTCELL_ERR_IO;
  }
  out = block;
  return SIGHTCELL_OK;
}

}  // namespace

sightcell_status read_file(const char* path, const sightcell_allocator& mem, file_block& out) noexcept {
  std::FILE* file = nullptr;
  if (const sightcell_status s = open_for_reading(path, mem, file); s != SIGHTCELL_OK) return s;
  const sightcell_status status = read_open_file(file, mem, out);
  std::fclose(file);
  return status;
}

}  // namespace sightcell::runtime
