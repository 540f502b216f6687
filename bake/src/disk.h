#pragma once
// What kind of disk a folder is on, and files that are there as a whole or not at all.
#include <cstdint>
#include <filesystem>

namespace sightcell::bake {

// NFS, SMB, Lustre and their like, where other machines see the same files: locks and shared memory are not to be
// trusted there. False where the system cannot tell.
bool on_network_disk(const std::filesystem::path& folder);

// Which file stands under a name: another one after it was replaced.
struct file_identity {
  bool there = false;
  std::uint64_t device = 0, number = 0;
  bool operator==(const file_identity&) const = default;
};
file_identity identity_of(const std::filesystem::path& path);

// The folder a file is in; "." for a bare name.
std::filesystem::path folder_of(const std::filesystem::path& file);

// Why no file can be made in the folder (errno), or 0.
int folder_problem(const std::filesystem::path& folder);

// Flushes file, renames it to path and flushes the folder: path holds what it held, or all of the new. Throws
// std::filesystem::filesystem_error; file is removed then.
void publish(const std::filesystem::path& file, const std::filesystem::path& path);

}  // namespace sightcell::bake
