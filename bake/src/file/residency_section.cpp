#include "file/residency_section.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "file/stored_rules.h"
#include "file/texture_levels.h"
#include "sightcell/base/error.h"
#include "sightcell/format/residency_writer.h"
#include "sightcell/format/set_reader.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {
namespace {

// 1,080 pixels at 60 degrees from the top of the picture to its bottom.
constexpr double reference_density = 540.0 / 0.57735026918962576;

void require_stored(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::failed, "output.encode", name, "its texture residency could not be encoded",
                "report this file");
}

// Returns where the viewpoints of a cell are.
viewpoint_region region_of(const format::reader& file, std::uint32_t cell, const std::string& name) {
  format::box corners;
  require_stored(file.cell_box(cell, corners), name);
  const box grown =
      box{{corners.min[0], corners.min[1], corners.min[2]}, {corners.max[0], corners.max[1], corners.max[2]}}.grown(
          file.facts().margin);
  const auto bytes = file.viewpoints().region_bytes(cell);
  auto region = viewpoint_region::decode(grown, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  if (!region) require_stored(format::status::corrupt, name);
  return std::move(*region);
}

struct cell_levels {
  std::vector<std::uint32_t> polygons;
  std::vector<std::uint8_t> levels;  // by texture
};

}  // namespace

bool add_residency(std::vector<std::byte>& file, const std::string& name, const scene::scene& s, const ray_scene& rays,
                   float anisotropy, const residency_progress& on_progress) {
  constexpr std::uint32_t group = 64;  // few at a time, so that a cancellation takes effect soon
  format::reader opened;
  format::set_reader sets;
  require_stored(format::reader::open(file, opened), name);
  require_stored(sets.open(opened), name);
  format::residency_source source;
  for (const scene::texture_info& one : s.textures.textures)
    source.textures.push_back({one.image, one.width, one.height});
  source.pixels_per_radian = static_cast<float>(reference_density);
  source.anisotropy = anisotropy;
  const texture_levels levels(s, rays, stored_rules_of(opened.settings()).player_radius,
                              static_cast<double>(anisotropy));
  std::vector<cell_levels> cells(opened.cell_count());
  for (std::uint32_t done = 0; done < cells.size();) {
    const auto end = std::min(done + group, static_cast<std::uint32_t>(cells.size()));
    for (std::uint32_t cell = done; cell < end; ++cell)
      require_stored(sets.source_ids(cell, cells[cell].polygons), name);
    tbb::parallel_for(done, end, [&](std::uint32_t cell) {
      const std::vector<double> texels = levels.texels_of(region_of(opened, cell, name), cells[cell].polygons);
      for (std::size_t i = 0; i < texels.size(); ++i)
        cells[cell].levels.push_back(
            level_number(texels[i] / reference_density, format::coarsest_level(source.textures[i])));
      cells[cell].polygons = {};
    });
    done = end;
    if (on_progress && !on_progress(done, opened.cell_count())) return false;
  }
  source.get = [&](std::uint32_t cell, std::span<std::uint8_t> out) {
    std::copy(cells[cell].levels.begin(), cells[cell].levels.end(), out.begin());
    return format::status::ok;
  };
  std::vector<std::byte> made;
  require_stored(format::put_residency(file, source, made), name);
  file = std::move(made);
  return true;
}

file_completion residency_of(const settings& how, const scene::scene& s, const ray_scene& rays,
                             const std::filesystem::path& output, const callbacks& events) {
  if (!how.file.residency) return {};
  return [&](std::vector<std::byte>& file) {
    return add_residency(file, output.string(), s, rays, how.file.anisotropy, [&](std::uint32_t, std::uint32_t total) {
      progress now;
      now.phase = bake_phase::writing_file;
      now.cells_done = now.cells_checked = now.cells_total = total;
      return !events.on_progress || events.on_progress(now);
    });
  };
}

void carry_residency(const format::reader& from, std::vector<std::byte>& file, const std::string& name,
                     std::span<const std::uint32_t> grown) {
  format::residency_table before;
  const format::status opened = format::residency_table::open(from, before);
  if (opened == format::status::absent) return;
  require_stored(opened, name);
  std::vector<std::byte> memory(format::residency_table::codes_size());
  const format::residency_codes* codes = nullptr;
  require_stored(before.make_codes(memory, codes), name);
  format::residency_source source;
  for (std::uint32_t i = 0; i < before.texture_count(); ++i) source.textures.push_back(before.texture(i));
  source.pixels_per_radian = before.pixels_per_radian();
  source.anisotropy = before.anisotropy();
  source.get = [&](std::uint32_t cell, std::span<std::uint8_t> out) {
    if (std::find(grown.begin(), grown.end(), cell) == grown.end()) return before.decode(cell, codes, out);
    std::fill(out.begin(), out.end(), format::finest_level);
    return format::status::ok;
  };
  std::vector<std::byte> made;
  require_stored(format::put_residency(file, source, made), name);
  file = std::move(made);
}

}  // namespace sightcell::bake
