// A page has no files: it fetches bytes and opens them with sightcell_db_open.
#include "file_input.h"

namespace sightcell::runtime {

sightcell_status read_file(const char*, const sightcell_allocator&, file_block&) noexcept {
  return SIGHTCELL_ERR_IO;
}

}  // namespace sightcell::runtime
