#pragma once
// Functions that <cstdio> lacks: UTF-8 names on every system, flushing to the disk, replacing a file in one step.
#include <cstdint>
#include <cstdio>

namespace sightcell::format {

// Opens a file for writing and empties it; null on failure. path is UTF-8.
std::FILE* open_for_writing(const char* path);
// Writes to the disk what the C library and the system still buffer.
[[nodiscard]] bool flush_to_disk(std::FILE* file) noexcept;
// Renames file from to to in one step: to is always the old file or the new one.
[[nodiscard]] bool replace_file(const char* from, const char* to);
// Makes a rename inside the folder of path survive a power failure, where the system and the folder's permissions allow
// it. False only if the disk reports an error.
[[nodiscard]] bool flush_folder_of(const char* path);
bool remove_file(const char* path);
std::uint64_t process_number() noexcept;

}  // namespace sightcell::format
