#pragma once
// Folders and files: network disks, identity, and files that appear complete or not at all.
#include <cstdint>
#include <filesystem>

namespace sightcell::bake {

// Returns whether a folder is on NFS, SMB, Lustre or another file system that several machines mount: locks and shared
// memory cannot be trusted there. False if the system cannot determine it.
bool on_network_disk(const std::filesystem::path& folder);

// Identifies the file that has a name now: another one after the name was replaced.
struct file_identity {
  bool there = false;
  std::uint64_t device = 0, number = 0;
  bool operator==(const file_identity&) const = default;
};

// Returns the identity of the file with this name; `there` is false if there is none.
file_identity identity_of(const std::filesystem::path& path);

// Returns the folder of a file, "." for a name without a folder.
std::filesystem::path folder_of(const std::filesystem::path& file);

// Returns the errno that creating a file in a folder would give, 0 if it would succeed.
int folder_problem(const std::filesystem::path& folder);

// Makes a complete file visible under its name: flushes it, renames it and flushes the folder.
// file: the complete file, in the same folder; removed on failure.
// path: the name. It has the old file or the whole new one at any time.
// Fails with std::filesystem::filesystem_error.
void publish(const std::filesystem::path& file, const std::filesystem::path& path);

}  // namespace sightcell::bake
