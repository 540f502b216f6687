#include "stream/visible_polygons.h"

#include "file/readable_file.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
visible_polygons::visible_polygons(std::span<const std::byte> file, const std::string& name) : name_(name) {
  require_readable(format::reader::open(file, file_), name_);
  if (!file_.has_importance())
    throw error(error_kind::wrong_use, "pack.no-importance", name_, "has no importance, by which pages are ordered",
                "sightcell recode FILE -o NEW.pvs --importance SCENE adds it");
  require_readable(file_.importance(importance_), name_);
  require_readable(sets_.open(file_), name_);
}

void visible_polygons::read(std::uint32_t cell) {
  const std::uint32_t chunk = file_.chunk_of(cell);
  for (; checked_ <= chunk; ++checked_) {
    require_readable(file_.check_chunk(checked_), name_);
    require_readable(importance_.check_chunk(checked_), name_);
  }
  std::span<const format::run> runs;
  require_readable(sets_.runs(cell, runs), name_);
  ids_.clear();
  for (const format::run& r : runs) {
    const std::span<const std::uint32_t> some = sets_.source_of_stored().subspan(r.first, r.count);
    ids_.insert(ids_.end(), some.begin(), some.end());
  }
  classes_.resize(ids_.size());
  require_readable(importance_.decode(cell, classes_), name_);
}

}  // namespace sightcell::bake
