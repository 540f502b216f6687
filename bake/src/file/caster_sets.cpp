#include "file/caster_sets.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "file/carried_section.h"
#include "sightcell/format/caster_writer.h"

namespace sightcell::bake {

format::status caster_set_reader::open(const format::reader& file) {
  if (const format::status s = format::caster_table::open(file, table_); s != format::status::ok) return s;
  memory_.resize(file.codes_size());
  scratch_.resize(table_.scratch_size());
  runs_.resize(table_.run_bound());
  sources_.resize(file.polygon_count());
  if (const format::status s = table_.make_codes(memory_, codes_); s != format::status::ok) return s;
  return file.source_of_stored(sources_);
}

format::status caster_set_reader::source_ids(std::uint32_t cell, std::uint32_t sun, std::vector<std::uint32_t>& out) {
  std::size_t count = 0;
  out.clear();
  const format::status s = table_.decode(cell, sun, codes_, runs_, scratch_, count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto from = sources_.begin() + runs_[i].first;
    out.insert(out.end(), from, from + runs_[i].count);
  }
  std::sort(out.begin(), out.end());
  return s;
}

void carry_casters(const format::reader& from, std::vector<std::byte>& file, const std::string& name) {
  const carried_step require{name, "shadow casters", "--sun"};
  const auto put = [&](caster_set_reader& casters, sets_of_both& sets, std::vector<std::byte>& made) {
    const std::uint32_t suns = casters.table().sun_count();
    format::caster_source source;
    std::vector<format::certificate_record> proofs;
    for (std::uint32_t sun = 0; sun < suns; ++sun) require(casters.table().sun(sun, source.suns.emplace_back()));
    for (std::uint32_t cell = 0; cell < sets.file.cell_count(); ++cell)
      for (std::uint32_t sun = 0; sun < suns; ++sun)
        require(casters.table().certificate(cell, sun, proofs.emplace_back()));
    source.certificate = proofs;
    std::vector<std::uint32_t> old, seen, all;
    source.get = [&](std::uint32_t cell, std::uint32_t sun, std::vector<std::uint32_t>& out) {
      if (const format::status s = casters.source_ids(cell, sun, old); s != format::status::ok) return s;
      // What the earlier set had stays among what the host draws.
      if (const format::status s = sets.before.source_ids(cell, seen); s != format::status::ok) return s;
      all.clear();
      std::set_union(old.begin(), old.end(), seen.begin(), seen.end(), std::back_inserter(all));
      if (const format::status s = sets.now.source_ids(cell, seen); s != format::status::ok) return s;
      std::set_difference(all.begin(), all.end(), seen.begin(), seen.end(), std::back_inserter(out));
      return format::status::ok;
    };
    return format::put_casters(file, source, made);
  };
  carry_section<caster_set_reader>(from, file, require, put);
}

}  // namespace sightcell::bake
