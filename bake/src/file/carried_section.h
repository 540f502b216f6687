#pragma once
// A section that belongs to the sets of a file, such as lights, in a file that is made from it with larger sets.
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "sightcell/base/error.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"

namespace sightcell::bake {

// The file without the section yet, its sets, and those of the file that it is made from.
struct sets_of_both {
  format::reader file;
  format::set_reader now, before;
};

// Throws sightcell::error unless the outcome of a step is ok.
struct carried_step {
  std::string name, what, option;  // of the file that is made; of the section; of the bake that makes it

  void operator()(format::status outcome) const {
    if (outcome != format::status::ok)
      throw error(error_kind::failed, "output.encode", name, "its " + what + " could not be carried over",
                  "bake again with " + option);
  }
};

// Adds the section to file; does nothing if `from` has none.
// opened_section: reads it; has open(const format::reader&).
// put(section, sets, made): makes the bytes of the file with the section. Returns a format::status.
template <class opened_section, class put_section>
void carry_section(const format::reader& from, std::vector<std::byte>& file, const carried_step& require,
                   const put_section& put) {
  opened_section section;
  const format::status opened = section.open(from);
  if (opened == format::status::absent) return;
  require(opened);
  sets_of_both sets;
  require(format::reader::open(file, sets.file));
  require(sets.now.open(sets.file));
  require(sets.before.open(from));
  std::vector<std::byte> made;
  require(put(section, sets, made));
  file = std::move(made);
}

}  // namespace sightcell::bake
