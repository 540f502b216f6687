#include "job/disk_space.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

// Per polygon of the set of a cell. Measured: docs/baking.md, "Memory and disk".
constexpr double checkpoint_bytes = 5.0, file_bytes = 1.0;
constexpr std::uint64_t of_cell = 256;  // box, certificate, directory, SQLite's pages

// A bake with less than estimate / too_little free is an error; less than estimate * tight is a warning.
constexpr std::uint64_t too_little = 4;
constexpr std::uint64_t tight = 2;

std::uint64_t bytes_of_cell(double polygons, double per_polygon) {
  return of_cell + static_cast<std::uint64_t>(std::ceil(polygons * per_polygon));
}

struct disk {
  dev_t device = 0;
  std::filesystem::path folder;
  std::uint64_t bytes = 0;
};

std::vector<disk> by_disk(const std::vector<disk_need>& needs) {
  std::vector<disk> disks;
  for (const disk_need& need : needs) {
    struct stat about {};
    if (stat(need.folder.c_str(), &about) != 0)
      continue;  // the writer of the file reports what is wrong with the folder
    const auto known =
        std::find_if(disks.begin(), disks.end(), [&](const disk& d) { return d.device == about.st_dev; });
    if (known == disks.end())
      disks.push_back({about.st_dev, need.folder, need.bytes});
    else
      known->bytes += need.bytes;
  }
  return disks;
}

std::string text(std::uint64_t bytes) {
  return bytes < (1u << 20) ? fmt::format("{} KiB", bytes >> 10)
                            : fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1u << 20));
}

}  // namespace

std::uint64_t checkpoint_bytes_of_cell(double polygons) {
  return bytes_of_cell(polygons, checkpoint_bytes);
}

std::uint64_t file_bytes_of_cell(double polygons) {
  return bytes_of_cell(polygons, file_bytes);
}

void check_disk_space(const std::vector<disk_need>& needs, const callbacks& events) {
  for (const disk& d : by_disk(needs)) {
    struct statvfs about {};
    if (statvfs(d.folder.c_str(), &about) != 0 || about.f_blocks == 0) continue;
    const std::uint64_t free = std::uint64_t{about.f_bavail} * about.f_frsize;
    if (free < d.bytes / too_little)
      throw error(error_kind::failed, "bake.disk-space", d.folder.string(),
                  fmt::format("has {} free, and the bake needs about {}", text(free), text(d.bytes)),
                  "make room or choose another -o, then run the same command again; finished cells are kept");
    if (free < d.bytes * tight && events.on_message)
      events.on_message(severity::warning, fmt::format("{}: {} are free, and the bake needs about {}",
                                                       d.folder.string(), text(free), text(d.bytes)));
  }
}

}  // namespace sightcell::bake
