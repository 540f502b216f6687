#include "file/light_sets.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "file/carried_section.h"
#include "sightcell/format/light_writer.h"

namespace sightcell::bake {

format::status light_set_reader::open(const format::reader& file) {
  if (const format::status s = format::light_table::open(file, table_); s != format::status::ok) return s;
  memory_.resize(file.codes_size());
  scratch_.resize(table_.sets().scratch_size());
  runs_.resize(table_.sets().run_bound());
  sources_.resize(file.polygon_count());
  if (const format::status s = table_.sets().make_codes(memory_, codes_); s != format::status::ok) return s;
  return file.source_of_stored(sources_);
}

format::status light_set_reader::source_ids(std::uint32_t light, std::vector<std::uint32_t>& out) {
  std::size_t count = 0;
  out.clear();
  const format::status s = table_.sets().decode(light, codes_, runs_, scratch_, count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto from = sources_.begin() + runs_[i].first;
    out.insert(out.end(), from, from + runs_[i].count);
  }
  std::sort(out.begin(), out.end());
  return s;
}

void marked_set::mark(std::vector<std::uint32_t> set) {
  for (const std::uint32_t polygon : set_) marks_[polygon] = false;
  set_ = std::move(set);
  for (const std::uint32_t polygon : set_) marks_[polygon] = true;
}

bool marked_set::meets(const std::vector<std::uint32_t>& set) const {
  return std::any_of(set.begin(), set.end(), [this](std::uint32_t polygon) { return marks_[polygon]; });
}

format::light_record record_of_light(const scene::light& light) {
  return {light.node, light.position, light.direction, light.range, light.cone};
}

scene::light light_of(const format::light_record& record) {
  return {record.node, record.position, record.direction, record.range, record.cone, false};
}

void carry_lights(const format::reader& from, std::vector<std::byte>& file, const std::string& name) {
  const carried_step require{name, "lights", "--lights"};
  const auto put = [&](light_set_reader& lights, sets_of_both& sets, std::vector<std::byte>& made) {
    format::light_source source;
    std::vector<format::certificate_record> proofs;
    std::vector<std::vector<std::uint32_t>> reached;
    for (std::uint32_t light = 0; light < lights.table().light_count(); ++light) {
      require(lights.table().light(light, source.lights.emplace_back()));
      require(lights.table().sets().certificate(light, light, proofs.emplace_back()));
      require(lights.source_ids(light, reached.emplace_back()));
    }
    source.certificate = proofs;
    source.sets = format::sets_of(reached);
    marked_set further(from.polygon_count());
    std::uint32_t marked = sets.file.cell_count();  // the cell that `further` is of
    source.touches = [&](std::uint32_t cell, std::uint32_t light) {
      if (cell != marked) {
        std::vector<std::uint32_t> before, now, more;
        require(sets.before.source_ids(cell, before));
        require(sets.now.source_ids(cell, now));
        std::set_difference(now.begin(), now.end(), before.begin(), before.end(), std::back_inserter(more));
        further.mark(std::move(more));
        marked = cell;
      }
      return lights.table().touches(cell, light) || further.meets(reached[light]);
    };
    return format::put_lights(file, source, made);
  };
  carry_section<light_set_reader>(from, file, require, put);
}

}  // namespace sightcell::bake
