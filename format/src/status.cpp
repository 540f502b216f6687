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
      return "not known for this frame or revision: draw or load everything";
    case status::absent:
      return "the file does not have what is asked for";
    case status::pending:
      return "the bytes have not arrived";
    case status::io:
      return "the file cannot be read or written";
    case status::not_ours:
      return "not a .pvs file";
    case status::version:
      return "a file of a version that this library does not read";
    case status::truncated:
      return "the file ends too early";
    case status::checksum:
      return "the file is damaged: a checksum differs";
    case status::corrupt:
      return "values of the file contradict each other";
    case status::limit:
      return "a number is beyond a limit of the format";
    case status::other_scene:
      return "the file belongs to another scene";
  }
  return "unknown status";
}

}  // namespace sightcell::format
