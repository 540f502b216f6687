#include "sightcell/base/disk.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

namespace sightcell::bake {
namespace {

void flush(const std::filesystem::path& path, int flags) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  if (file < 0) throw std::filesystem::filesystem_error("open", path, {errno, std::generic_category()});
  const int failed = fsync(file) == 0 ? 0 : errno;
  close(file);
  // Some network disks cannot flush folders (EINVAL). That is not an error.
  if (failed != 0 && !(flags == O_DIRECTORY && failed == EINVAL))
    throw std::filesystem::filesystem_error("fsync", path, {failed, std::generic_category()});
}

}  // namespace

bool on_network_disk(const std::filesystem::path& folder) {
  // statfs(2): NFS, SMB, SMB2, CIFS, AFS, Coda, NCP, FUSE, 9P, Ceph, Lustre, GPFS, BeeGFS, GFS2, OCFS2.
  constexpr std::array<unsigned, 15> network = {0x6969,     0x517B,     0xFE534D42, 0xFF534D42, 0x5346414F,
                                                0x73757245, 0x564C,     0x65735546, 0x01021997, 0x00C36400,
                                                0x0BD00BD0, 0x47504653, 0x19830326, 0x01161970, 0x7461636F};
  struct statfs about {};
  if (statfs(folder.c_str(), &about) != 0) return false;
  return std::find(network.begin(), network.end(), static_cast<unsigned>(about.f_type)) != network.end();
}

file_identity identity_of(const std::filesystem::path& path) {
  struct stat about {};
  if (stat(path.c_str(), &about) != 0) return {};
  return {true, about.st_dev, about.st_ino};
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

int folder_problem(const std::filesystem::path& folder) {
  return access(folder.c_str(), W_OK | X_OK) == 0 ? 0 : errno;
}

void publish(const std::filesystem::path& file, const std::filesystem::path& path) {
  try {
    flush(file, 0);
    std::filesystem::rename(file, path);
    flush(folder_of(path), O_DIRECTORY);
  } catch (const std::filesystem::filesystem_error&) {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    throw;
  }
}

}  // namespace sightcell::bake
