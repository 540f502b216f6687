#pragma once
// Files of the writer's version with one fault each, all checksums fitting but where those are the fault: what every
// reader must refuse, and with which status. Some have no fault: what the others were made of, and what looks like one.
#include <string>
#include <vector>

#include "sightcell/format/status.h"
#include "unit/format/sample_contents.h"

namespace sightcell::test {

struct damaged_file {
  std::string name;  // of the fault, and of the file without its ending
  format::status expected = format::status::corrupt;
  std::vector<std::byte> bytes;
  bool later = false;  // opening does not find it: checking the whole file does
};
using damaged_list = std::vector<damaged_file>;

// By the part of the file that has the fault.
damaged_list damaged_headers();
damaged_list damaged_section_tables();
damaged_list damaged_tables();
damaged_list damaged_groups();
damaged_list damaged_lattices();
damaged_list damaged_code_tables();
damaged_list damaged_rows();
damaged_list damaged_importance();
damaged_list damaged_volumes();
damaged_list damaged_named_groups();
damaged_list damaged_viewpoints();
damaged_list damaged_borders();
damaged_list damaged_clusters();
// All of them.
damaged_list damaged_files();

// The name of a status as in status.h; only those that opening and checking a file answer.
const char* status_name(format::status s);

// One u32 changed.
std::vector<std::byte> changed(std::vector<std::byte> file, std::size_t at, std::uint32_t value);
// A section replaced: those behind it move. The one chunk of rows, where there is one, becomes as long as the rows.
std::vector<std::byte> with_section(const std::vector<std::byte>& file, std::uint32_t id,
                                    const std::vector<std::byte>& section);
std::vector<std::byte> section_of(const std::vector<std::byte>& file, std::uint32_t id);
// The record of a section in the table changed.
std::vector<std::byte> with_record(const std::vector<std::byte>& file, std::uint32_t id, std::uint32_t new_id,
                                   std::uint32_t flags);
// The checksums of the section table and the header alone.
void reseal_front(std::vector<std::byte>& file);
// With bytes behind it, or fewer where that is negative.
std::vector<std::byte> longer(std::vector<std::byte> section, int bytes);

// tiny_contents() with all that a file can have: two draws that share an order which is not the source's, certificate
// and settings.
sample_contents whole_contents();

}  // namespace sightcell::test
