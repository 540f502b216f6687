// A page has no files to name: it fetches bytes and opens these with sightcell_db_open.
#include "file_input.h"

namespace sightcell::runtime {

sightcell_status read_file(const char*, const sightcell_allocator&, file_block&) noexcept {
  return SIGHTCELL_ERR_IO;
}

}  // namespace sightcell::runtime
