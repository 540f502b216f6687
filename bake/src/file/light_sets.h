#pragma once
// The lights of a file, and the polygons that each reaches, by source ids.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sightcell/format/light_table.h"
#include "sightcell/format/reader.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Reads the lights section of a file, one set at a time.
class light_set_reader {
 public:
  // Opens the section. absent: the file has none. file must outlive the object.
  format::status open(const format::reader& file);
  const format::light_table& table() const { return table_; }
  // Writes the polygons that a light reaches to out, ascending.
  format::status source_ids(std::uint32_t light, std::vector<std::uint32_t>& out);

 private:
  format::light_table table_;
  const format::row_codes* codes_ = nullptr;
  std::vector<std::byte> memory_, scratch_;
  std::vector<format::run> runs_;
  std::vector<std::uint32_t> sources_;
};

// Marks the polygons of one set, to be compared with many others.
class marked_set {
 public:
  explicit marked_set(std::uint32_t polygons) : marks_(polygons) {}
  // set: in place of the one before.
  void mark(std::vector<std::uint32_t> set);
  // Returns whether a set has one of the marked polygons.
  bool meets(const std::vector<std::uint32_t>& set) const;

 private:
  std::vector<bool> marks_;
  std::vector<std::uint32_t> set_;
};

// Converts between the two forms of a light. The result of the second has no `moves`.
format::light_record record_of_light(const scene::light& light);
scene::light light_of(const format::light_record& record);

// Copies the lights section from another file with the same cells and polygons into `file`, whose sets may be larger
// and stored in another order: a light also touches a cell whose set has a further polygon that it reaches. Does
// nothing if `from` has no section. name: of the file, for errors.
void carry_lights(const format::reader& from, std::vector<std::byte>& file, const std::string& name);

}  // namespace sightcell::bake
