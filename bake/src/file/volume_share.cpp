// Computes the size that a file would have without its volumes.
#include <vector>

#include "file/importance_section.h"
#include "file/readable_file.h"
#include "sightcell/bake/inspect.h"
#include "sightcell/base/error.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"

namespace sightcell::bake {
std::uint64_t size_without_volumes(std::span<const std::byte> file, const std::string& name) {
  format::reader opened;
  format::set_reader sets;
  format::file_parts parts;
  require_readable(format::reader::open(file, opened), name);
  if (opened.volumes().count() == 0) return file.size();
  require_readable(sets.open(opened), name);
  require_readable(format::take_apart(opened, parts), name);
  parts.volumes.clear();
  std::vector<std::byte> bytes;
  require_readable(format::encode(parts.contents({parts.cells.size(),
                                                  [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
                                                    return sets.source_ids(cell, set);
                                                  }}),
                                  bytes),
                   name);
  carry_importance(opened, bytes, name);
  return bytes.size();
}

}  // namespace sightcell::bake
