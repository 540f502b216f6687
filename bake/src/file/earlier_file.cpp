#include "file/earlier_file.h"

#include <cstddef>
#include <fstream>
#include <span>
#include <vector>

#include "file/readable_file.h"
#include "sightcell/format/reader.h"

namespace sightcell::bake {

format::file_parts read_earlier_file(const std::filesystem::path& pvs) {
  std::ifstream in(pvs, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
  std::vector<std::byte> bytes(size > 0 ? static_cast<std::size_t>(size) : 0);
  in.seekg(0);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (size < 0 || !in) require_readable(format::status::io, pvs.string());
  format::reader file;
  require_readable(format::reader::open(bytes, file), pvs.string());
  format::file_parts parts;
  require_readable(format::take_apart(file, parts), pvs.string());
  return parts;
}

}  // namespace sightcell::bake
