// Computes the size that a file would have without its volumes.
#include <vector>

#include "file/importance_section.h"
#include "sightcell/bake/inspect.h"
#include "sightcell/base/error.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"

namespace sightcell::bake {
namespace {

void require_ok(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::bad_input, "pvs.broken", name, format::status_text(outcome), "bake it again");
}

}  // namespace

std::uint64_t size_without_volumes(std::span<const std::byte> file, const std::string& name) {
  format::reader opened;
  format::set_reader sets;
  format::file_parts parts;
  require_ok(format::reader::open(file, opened), name);
  if (opened.volumes().count() == 0) return file.size();
  require_ok(sets.open(opened), name);
  require_ok(format::take_apart(opened, parts), name);
  parts.volumes.clear();
  std::vector<std::byte> bytes;
  require_ok(format::encode(parts.contents({parts.cells.size(),
                                            [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
                                              return sets.source_ids(cell, set);
                                            }}),
                            bytes),
             name);
  carry_importance(opened, bytes, name);
  return bytes.size();
}

}  // namespace sightcell::bake
