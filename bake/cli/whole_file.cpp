#include "whole_file.h"

#include <fstream>

#include "sightcell/base/disk.h"
#include "sightcell/base/error.h"

namespace sightcell::cli {

void write_whole_file(const std::filesystem::path& path, std::string_view bytes) {
  std::filesystem::path unfinished = path;
  unfinished += ".part";
  std::ofstream out(unfinished, std::ios::binary);
  out << bytes;
  out.close();
  std::error_code ignored;
  if (out) {
    try {
      return bake::publish(unfinished, path);
    } catch (const std::filesystem::filesystem_error&) {
      // Reported below, as a file that could not be opened is.
    }
  }
  std::filesystem::remove(unfinished, ignored);
  throw error(error_kind::failed, "cli.not-writable", path.string(), "cannot be written",
              "choose a file in a folder that exists and can be written");
}

}  // namespace sightcell::cli
