// A page has no files: it fetches bytes and opens them with sightcell_db_open. Of a .glb, JavaScript takes the .pvs file.
#include "embedded_pvs.h"
#include "file_input.h"

namespace sightcell::runtime {

sightcell_status read_file(const char*, const sightcell_allocator&, file_block&) noexcept {
  return SIGHTCELL_ERR_IO;
}

sightcell_status find_embedded_pvs(std::span<const std::byte> bytes, std::span<const std::byte>& out) noexcept {
  out = bytes;
  return SIGHTCELL_OK;
}

}  // namespace sightcell::runtime
