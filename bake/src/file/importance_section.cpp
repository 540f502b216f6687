#include "file/importance_section.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <span>
#include <utility>

#include "file/importance_meter.h"
#include "file/stored_rules.h"
#include "sightcell/base/error.h"
#include "sightcell/format/importance_writer.h"
#include "sightcell/format/set_reader.h"

namespace sightcell::bake {
namespace {

void require_ok(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::failed, "output.encode", name, "the importance of its polygons could not be encoded",
                "report this file");
}

void put(std::vector<std::byte>& file, const std::string& name, const format::importance_source& classes) {
  std::vector<std::byte> made;
  require_ok(format::put_importance(file, classes, made), name);
  file = std::move(made);
}

// Writes the source ids of a cell's set to out, in stored order.
void stored_polygons(format::set_reader& sets, std::uint32_t cell, const std::string& name,
                     std::vector<std::uint32_t>& out) {
  std::span<const format::run> runs;
  require_ok(sets.runs(cell, runs), name);
  out.clear();
  for (const format::run& r : runs) {
    const std::span<const std::uint32_t> some = sets.source_of_stored().subspan(r.first, r.count);
    out.insert(out.end(), some.begin(), some.end());
  }
}

// Two classes per byte, because with thousands of cells they are as large as the file.
struct packed_classes {
  std::vector<std::uint8_t> pairs;

  explicit packed_classes(std::span<const std::uint8_t> classes) : pairs((classes.size() + 1) / 2) {
    for (std::size_t i = 0; i < classes.size(); ++i)
      pairs[i / 2] = static_cast<std::uint8_t>(pairs[i / 2] | classes[i] << (i % 2 * 4));
  }
  void unpack(std::span<std::uint8_t> classes) const {
    for (std::size_t i = 0; i < classes.size(); ++i) classes[i] = pairs[i / 2] >> (i % 2 * 4) & 0xFu;
  }
};

// The polygons of a cell in stored order, and their classes.
struct measured_cell {
  box grown;
  std::vector<std::uint32_t> polygons;
  std::vector<std::uint8_t> classes;
};

void measure(const ray_scene& rays, const stored_rules& rules, measured_cell& cell) {
  constexpr std::size_t stretch = 256;
  const importance_meter meter(rays, cell.grown, rules.player_radius, rules.seed);
  cell.classes.resize(cell.polygons.size());
  tbb::parallel_for(std::size_t{0}, (cell.polygons.size() + stretch - 1) / stretch, [&](std::size_t i) {
    importance_meter::scratch room;
    const std::size_t end = std::min(cell.polygons.size(), (i + 1) * stretch);
    for (std::size_t k = i * stretch; k < end; ++k)
      cell.classes[k] = importance_class_of(meter.visible_angle(cell.polygons[k], room));
  });
}

// The cells that are measured together: several, so that all threads have work if sets are small, with a limit on
// polygons, so that a cancellation takes effect within seconds.
class cells_in_work {
 public:
  cells_in_work(format::set_reader& sets, const std::string& name) : sets_(sets), name_(name) {}

  // Reads the next cells. Returns false at the end.
  bool next() {
    constexpr std::size_t most_cells = 64, enough_polygons = 1 << 16;
    cells_.clear();
    std::size_t polygons = 0;
    while (taken_ < sets_.file().cell_count() && cells_.size() < most_cells && polygons < enough_polygons) {
      measured_cell cell;
      format::box corners;
      require_ok(sets_.file().cell_box(taken_, corners), name_);
      cell.grown =
          box{{corners.min[0], corners.min[1], corners.min[2]}, {corners.max[0], corners.max[1], corners.max[2]}}.grown(
              sets_.file().facts().margin);
      stored_polygons(sets_, taken_++, name_, cell.polygons);
      polygons += cell.polygons.size();
      cells_.push_back(std::move(cell));
    }
    return !cells_.empty();
  }
  std::vector<measured_cell>& cells() { return cells_; }
  std::uint32_t taken() const { return taken_; }

 private:
  format::set_reader& sets_;
  const std::string& name_;
  std::vector<measured_cell> cells_;
  std::uint32_t taken_ = 0;
};

}  // namespace

bool add_importance(std::vector<std::byte>& file, const std::string& name, const ray_scene& rays,
                    const importance_progress& on_progress) {
  format::reader opened;
  format::set_reader sets;
  require_ok(format::reader::open(file, opened), name);
  require_ok(sets.open(opened), name);
  const stored_rules rules = stored_rules_of(opened.settings());
  std::vector<packed_classes> classes;
  std::vector<std::size_t> sizes;
  cells_in_work work(sets, name);
  while (work.next()) {
    tbb::parallel_for(std::size_t{0}, work.cells().size(),
                      [&](std::size_t i) { measure(rays, rules, work.cells()[i]); });
    for (const measured_cell& cell : work.cells()) {
      classes.emplace_back(cell.classes);
      sizes.push_back(cell.classes.size());
    }
    if (on_progress && !on_progress(work.taken(), opened.cell_count())) return false;
  }
  put(file, name, {[&](std::uint32_t cell, std::vector<std::uint8_t>& out) {
        out.resize(sizes[cell]);
        classes[cell].unpack(out);
        return format::status::ok;
      }});
  return true;
}

file_completion importance_of(const settings& how, const ray_scene& rays, const std::filesystem::path& output,
                              const callbacks& events) {
  if (!how.file.importance) return {};
  return [&](std::vector<std::byte>& file) {
    if (events.on_phase) events.on_phase(bake_phase::measuring_importance);
    return add_importance(file, output.string(), rays, [&](std::uint32_t done, std::uint32_t total) {
      progress now;
      now.phase = bake_phase::measuring_importance;
      now.cells_done = now.cells_checked = now.cells_total = total;
      now.importance = static_cast<double>(done) / total;
      return !events.on_progress || events.on_progress(now);
    });
  };
}

void carry_importance(const format::reader& from, std::vector<std::byte>& file, const std::string& name) {
  if (!from.has_importance()) return;
  format::reader to;
  format::set_reader sets, sets_before;
  format::importance_classes before;
  require_ok(format::reader::open(file, to), name);
  require_ok(sets.open(to), name);
  require_ok(sets_before.open(from), name);
  require_ok(from.importance(before), name);
  std::vector<std::uint8_t> class_of(from.polygon_count(), format::least_important);
  std::vector<std::uint32_t> polygons, now;
  std::vector<std::uint8_t> known;
  put(file, name, {[&](std::uint32_t cell, std::vector<std::uint8_t>& out) {
        stored_polygons(sets_before, cell, name, polygons);
        known.resize(polygons.size());
        if (const format::status s = before.decode(cell, known); s != format::status::ok) return s;
        for (std::size_t i = 0; i < polygons.size(); ++i) class_of[polygons[i]] = known[i];
        stored_polygons(sets, cell, name, now);
        for (const std::uint32_t polygon : now) out.push_back(class_of[polygon]);
        for (const std::uint32_t polygon : polygons) class_of[polygon] = format::least_important;
        return format::status::ok;
      }});
}

}  // namespace sightcell::bake
