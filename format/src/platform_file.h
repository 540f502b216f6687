#pragma once
// What <cstdio> cannot do: UTF-8 names on every system, flushing to the disk, replacing a file in one step.
#include <cstdint>
#include <cstdio>

namespace sightcell::format {

// A file for writing, emptied first; null on failure. path is UTF-8.
std::FILE* open_for_writing(const char* path);
// Hands what the C library and the system still hold to the disk.
[[nodiscard]] bool flush_to_disk(std::FILE* file) noexcept;
// Puts the file from in the place of to, in one step: to is always the old file or the new one.
[[nodiscard]] bool replace_file(const char* from, const char* to);
// Makes a rename inside path's folder last through a power cut, where the system and the folder's rights allow it.
// False only when the disk reports an error.
[[nodiscard]] bool flush_folder_of(const char* path);
bool remove_file(const char* path);
std::uint64_t process_number() noexcept;

}  // namespace sightcell::format
