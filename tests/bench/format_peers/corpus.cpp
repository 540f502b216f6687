#include "bench/format_peers/corpus.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>
#include <unordered_set>

#include "sightcell/format/reader.h"

namespace sightcell::bench {
namespace {

std::vector<id_run> runs_of(std::span<const std::uint32_t> ids) {
  std::vector<id_run> runs;
  for (const std::uint32_t id : ids) {
    if (!runs.empty() && runs.back().first + runs.back().count == id)
      ++runs.back().count;
    else
      runs.push_back({id, 1});
  }
  return runs;
}

std::array<float, 3> middle_of(const sightcell_db* db, std::uint32_t cell) {
  float low[3], high[3];
  require(sightcell_db_cell_box(db, cell, low, high), "sightcell_db_cell_box");
  return {0.5f * (low[0] + high[0]), 0.5f * (low[1] + high[1]), 0.5f * (low[2] + high[2])};
}

// All that a view says of a cell, one output against the others.
class cell_reader {
 public:
  explicit cell_reader(const corpus& of)
      : of_(of),
        view_(make_view(of)),
        indices_(3 * std::size_t{of.info.polygon_count}),
        list_(indices_.size()),
        ids_(of.info.polygon_count),
        ranges_(of.info.range_bound) {}

  // Source ids, ascending.
  std::span<const std::uint32_t> ids(std::uint32_t cell) {
    sightcell_frame frame{};
    require(sightcell_view_move(view_.get(), of_.middles[cell].data(), &frame), "sightcell_view_move");
    const std::string name = "cell " + std::to_string(cell);
    if (frame.cell != cell)
      throw std::runtime_error(name + ": its middle is in cell " + std::to_string(frame.cell) +
                               "; only cells that do not overlap are measured");
    if ((frame.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0) throw std::runtime_error(name + ": is damaged");
    std::size_t count = 0, listed = 0;
    require(sightcell_view_polygons(view_.get(), ids_.data(), ids_.size(), &count), "sightcell_view_polygons");
    require(sightcell_view_ranges(view_.get(), ranges_.data(), ranges_.size(), &range_count_), "sightcell_view_ranges");
    require(sightcell_view_indices(view_.get(), indices_.data(), list_.data(), list_.size(), &listed),
            "sightcell_view_indices");
    std::uint64_t in_ranges = 0;
    for (std::size_t i = 0; i < range_count_; ++i) in_ranges += ranges_[i].count;
    const std::span<std::uint32_t> found(ids_.data(), count);
    std::sort(found.begin(), found.end());
    if (count != frame.polygon_count || in_ranges != count || listed != 3 * count ||
        std::adjacent_find(found.begin(), found.end()) != found.end())
      throw std::runtime_error(name + ": its outputs have different numbers of polygons");
    return found;
  }

  std::uint32_t range_count() const { return static_cast<std::uint32_t>(range_count_); }

 private:
  const corpus& of_;
  view_handle view_;
  std::vector<std::uint32_t> indices_, list_, ids_;
  std::vector<sightcell_range> ranges_;
  std::size_t range_count_ = 0;
};

std::vector<std::uint8_t> depths_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  format::reader file;
  if (format::reader::open(std::as_bytes(std::span(text)), file) != format::status::ok)
    throw std::runtime_error(path.string() + ": cannot be read");
  const auto record_of = [&](std::uint32_t cell) {
    format::row_record record;
    if (file.row(cell, record) != format::status::ok) throw std::runtime_error(path.string() + ": has a damaged row");
    return record;
  };
  std::vector<std::uint8_t> depths(file.cell_count(), 0);
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell)
    for (format::row_record at = record_of(cell); at.delta; at = record_of(at.reference)) ++depths[cell];
  return depths;
}

}  // namespace

void require(sightcell_status status, const char* what) {
  if (status != SIGHTCELL_OK) throw std::runtime_error(std::string(what) + ": " + sightcell_status_text(status));
}

view_handle make_view(const corpus& of) {
  sightcell_view* view = nullptr;
  require(sightcell_view_create(of.db.get(), &view), "sightcell_view_create");
  return view_handle(view);
}

void expand(std::span<const id_run> runs, std::vector<std::uint32_t>& ids) {
  ids.clear();
  for (const id_run& run : runs)
    for (std::uint32_t i = 0; i < run.count; ++i) ids.push_back(run.first + i);
}

corpus read_corpus(const std::filesystem::path& file) {
  corpus made;
  sightcell_db* db = nullptr;
  require(sightcell_db_open_file(file.string().c_str(), nullptr, &db), file.string().c_str());
  made.db.reset(db);
  made.info.struct_size = sizeof made.info;
  require(sightcell_db_info(db, &made.info), "sightcell_db_info");
  made.file_bytes = std::filesystem::file_size(file);
  made.depth = depths_of(file);
  for (std::uint32_t cell = 0; cell < made.info.cell_count; ++cell) made.middles.push_back(middle_of(db, cell));

  cell_reader reader(made);
  std::mt19937_64 random(1);
  std::vector<std::uint64_t> signatures(made.info.polygon_count);  // which cells see it, as a sum of their names
  for (std::uint32_t cell = 0; cell < made.info.cell_count; ++cell) {
    const std::span<const std::uint32_t> ids = reader.ids(cell);
    const std::uint64_t name = random();
    for (const std::uint32_t id : ids) signatures[id] += name;
    made.runs.push_back(runs_of(ids));
    made.ranges.push_back(reader.range_count());
    made.visible += ids.size();
    made.run_count += made.runs.back().size();
    made.range_count += made.ranges.back();
    made.most_polygons = std::max<std::uint64_t>(made.most_polygons, ids.size());
  }
  std::unordered_set<std::uint64_t> different;
  for (const std::uint64_t signature : signatures) {
    if (signature == 0) continue;
    ++made.polygons_seen;
    different.insert(signature);
  }
  made.atoms = different.size();
  return made;
}

}  // namespace sightcell::bench
