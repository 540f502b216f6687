#include "sightcell/format/status.h"

namespace sightcell::format {

const char* status_text(status s) noexcept {
  switch (s) {
    case status::ok:
      return "no error";
    case status::argument:
      return "wrong argument";
    case status::memory:
      return "out of memory";
    case status::capacity:
      return "the buffer is too small";
    case status::stale:
      return "too old to say what changed: take the full list";
    case status::io:
      return "the file cannot be read or written";
    case status::not_ours:
      return "not a .pvs file";
    case status::version:
      return "written for another version of Sightcell";
    case status::truncated:
      return "the file ends too early";
    case status::checksum:
      return "the file is damaged: a checksum differs";
    case status::corrupt:
      return "the file contradicts itself";
    case status::limit:
      return "a number is above what the format can hold";
    case status::other_scene:
      return "the file belongs to another scene";
  }
  return "unknown status";
}

}  // namespace sightcell::format
