#include "file/caster_sets.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "sightcell/base/error.h"
#include "sightcell/format/caster_writer.h"
#include "sightcell/format/set_reader.h"

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
  const auto require = [&](format::status outcome) {
    if (outcome != format::status::ok)
      throw error(error_kind::failed, "output.encode", name, "its shadow casters could not be carried over",
                  "bake again with --sun");
  };
  caster_set_reader casters;
  const format::status opened = casters.open(from);
  if (opened == format::status::absent) return;
  require(opened);
  format::reader to;
  format::set_reader sets, sets_before;
  require(format::reader::open(file, to));
  require(sets.open(to));
  require(sets_before.open(from));
  const std::uint32_t suns = casters.table().sun_count();
  format::caster_source source;
  std::vector<format::certificate_record> proofs;
  for (std::uint32_t sun = 0; sun < suns; ++sun) require(casters.table().sun(sun, source.suns.emplace_back()));
  for (std::uint32_t cell = 0; cell < to.cell_count(); ++cell)
    for (std::uint32_t sun = 0; sun < suns; ++sun)
      require(casters.table().certificate(cell, sun, proofs.emplace_back()));
  source.certificate = proofs;
  std::vector<std::uint32_t> old, seen, all;
  source.get = [&](std::uint32_t cell, std::uint32_t sun, std::vector<std::uint32_t>& out) {
    if (const format::status s = casters.source_ids(cell, sun, old); s != format::status::ok) return s;
    // What the earlier set had stays among what the host draws.
    if (const format::status s = sets_before.source_ids(cell, seen); s != format::status::ok) return s;
    all.clear();
    std::set_union(old.begin(), old.end(), seen.begin(), seen.end(), std::back_inserter(all));
    if (const format::status s = sets.source_ids(cell, seen); s != format::status::ok) return s;
    std::set_difference(all.begin(), all.end(), seen.begin(), seen.end(), std::back_inserter(out));
    return format::status::ok;
  };
  std::vector<std::byte> made;
  require(format::put_casters(file, source, made));
  file = std::move(made);
}

}  // namespace sightcell::bake
