#pragma once
// The sets of a file with the importance of their polygons, cell by cell.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightcell/format/importance_classes.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"

namespace sightcell::bake {

class visible_polygons {
 public:
  // Opens a file. name: for messages. The bytes must outlive the object. Throws sightcell::error: pvs.broken,
  // pack.no-importance.
  visible_polygons(std::span<const std::byte> file, const std::string& name);

  const format::reader& file() const { return file_; }

  // Reads the set of a cell: source ids and their classes, valid until the next call.
  void read(std::uint32_t cell);
  std::span<const std::uint32_t> source_ids() const { return ids_; }
  std::span<const std::uint8_t> classes() const { return classes_; }

 private:
  std::string name_;
  format::reader file_;
  format::set_reader sets_;
  format::importance_classes importance_;
  std::uint32_t checked_ = 0;  // chunks before this one have been checked
  std::vector<std::uint32_t> ids_;
  std::vector<std::uint8_t> classes_;
};

}  // namespace sightcell::bake
