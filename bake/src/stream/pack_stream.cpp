#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "file/readable_file.h"
#include "sightcell/bake/stream.h"
#include "sightcell/format/layout.h"
#include "sightcell/scene/stream_pages.h"
#include "stream/cell_lists.h"
#include "stream/front_payload.h"
#include "stream/page_plan.h"
#include "stream/polygon_numbers.h"
#include "stream/site_folder.h"
#include "stream/sketches.h"
#include "stream/smaller_images.h"
#include "stream/tileset.h"
#include "stream/visible_polygons.h"

namespace sightcell::bake {
namespace {

// A client waits for a chunk before its first page. Cells are halved until they fit, so chunks take 8 KB in the mean.
constexpr std::size_t chunk_bytes = 10'900;
constexpr std::size_t pages_at_a_time = 64;
constexpr std::uint64_t many_pixels = std::uint64_t{1} << 22;
constexpr std::array<const char*, 5> image_extensions = {"png", "jpg", "webp", "ktx2", "bin"};

class stream_packer {
 public:
  stream_packer(const std::filesystem::path& scene_path, int scene_index, std::span<const std::byte> file,
                const std::string& name, const stream_settings& how, const stream_progress& on_progress)
      : how_(how), report_(on_progress), polygons_(file, name), pager_(scene_path, scene_index) {
    require_scene(polygons_.file(), pager_.content(), name);
    result_.warnings = pager_.content().warnings;
    warn_of_sections_left_out(name);
  }

  stream_result write(const std::filesystem::path& output) {
    std::vector<std::string> warnings;
    pager_.prepare({how_.grid, how_.textures, how_.all_attributes}, warnings);
    for (std::string& warning : warnings)  // missing base colors were reported before
      if (std::find(result_.warnings.begin(), result_.warnings.end(), warning) == result_.warnings.end())
        result_.warnings.push_back(std::move(warning));
    const polygon_numbers numbers(pager_);
    const page_plan plan = plan_of(numbers);
    site_folder site(output, how_.copies);
    std::vector<std::vector<listed_image>> images = write_images(site);
    if (how_.tileset) tiles_.emplace(pager_, plan.pages.size(), site, image_uris(images));
    front_content front{pager_, plan, write_pages(plan, site), std::move(images), {}};
    front.chunks = write_cells(numbers, plan, front.pages, site);
    const std::vector<std::byte> bytes = front_file(front);
    site.finish("scene.front", bytes);
    result_.front_bytes = bytes.size();
    if (tiles_) write_tileset(site);
    result_.files_written = site.written();
    result_.files_kept = site.kept();
    count(numbers, plan, front);
    return std::move(result_);
  }

 private:
  // Clients draw what cells show, and have no sets for shadow maps.
  void warn_of_sections_left_out(const std::string& name) {
    for (const auto& [section, what] : {std::pair(format::layout::section_casters, "shadow casters"),
                                        std::pair(format::layout::section_lights, "lights")}) {
      std::span<const std::byte> bytes;
      if (polygons_.file().skipped_section(section, bytes) != format::status::absent)
        result_.warnings.push_back("the streamed scene has no " + std::string(what) + ": those of " + name +
                                   " are left out");
    }
  }

  void report(stream_phase phase, std::uint64_t done, std::uint64_t total) const {
    if (report_) report_(phase, done, total);
  }

  page_plan plan_of(const polygon_numbers& numbers) {
    const std::uint32_t cells = polygons_.file().cell_count();
    sketch_table seen(numbers.count());
    for (std::uint32_t cell = 0; cell < cells; ++cell) {
      polygons_.read(cell);
      seen.begin_cell(cell);
      for (std::size_t i = 0; i < polygons_.source_ids().size(); ++i)
        seen.add(numbers.number_of(polygons_.source_ids()[i]), polygons_.classes()[i]);
      report(stream_phase::reading_sets, cell + 1, cells);
    }
    const std::size_t geometries = pager_.geometries().size();
    return plan_pages(pager_, numbers, seen, how_.page_bytes,
                      [&](std::uint64_t done) { report(stream_phase::grouping_polygons, done, geometries); });
  }

  std::vector<listed_file> write_pages(const page_plan& plan, site_folder& site) {
    std::vector<listed_file> out(plan.pages.size());
    sent_.resize(out.size());
    for (std::size_t begin = 0; begin < out.size(); begin += pages_at_a_time) {
      const std::size_t end = std::min(out.size(), begin + pages_at_a_time);
      tbb::parallel_for(begin, end, [&](std::size_t page) {
        const std::vector<std::byte> bytes = pager_.page(plan.pages[page]);
        const added_file added = site.add_with_copies("pages", "glb", bytes);
        out[page] = added.file;
        sent_[page] = added.sent;
        if (tiles_) tiles_->add(static_cast<std::uint32_t>(page), plan.pages[page], out[page], bytes);
      });
      report(stream_phase::writing_pages, end, out.size());
    }
    for (const listed_file& file : out) result_.page_bytes += file.bytes;
    for (const sent_bytes& sent : sent_) result_.sent_pages.add(sent);
    return out;
  }

  std::vector<std::vector<listed_image>> write_images(site_folder& site) {
    const std::vector<scene::streamed_image>& images = pager_.images();
    std::vector<std::vector<listed_image>> out(images.size());
    std::vector<std::uint8_t> unreadable(images.size(), 0);
    const auto write = [&](std::size_t i) {
      const scene::streamed_image& image = images[i];
      const smaller_images made = smaller_images_of(image);
      const auto add = [&](scene::image_type type, std::span<const std::uint8_t> bytes) {
        return site.add("images", image_extensions[static_cast<std::size_t>(type)], std::as_bytes(bytes));
      };
      for (const smaller_image& v : made.versions)
        out[i].push_back({add(scene::image_type::webp, v.bytes), v.width, v.height, scene::image_type::webp});
      out[i].push_back({add(image.type, image.bytes), made.width, made.height, image.type});
      unreadable[i] = made.is_unreadable ? 1 : 0;
    };
    // Large ones one at a time, because of their memory.
    const auto is_large = [&](std::size_t i) {
      return std::uint64_t{images[i].width} * images[i].height > many_pixels || images[i].width == 0;
    };
    tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t i) {
      if (!is_large(i)) write(i);
    });
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (is_large(i)) write(i);
      report(stream_phase::writing_images, i + 1, images.size());
      if (unreadable[i] != 0)
        result_.warnings.push_back("images/" + std::to_string(images[i].number) +
                                   " has no smaller versions: it is damaged, or too large to decode");
      for (const listed_image& version : out[i]) result_.image_bytes += version.file.bytes;
      result_.first_image_bytes += out[i].front().file.bytes;
    }
    return out;
  }

  // Returns the address of each image from the folder of the tiles: of its last file, which is the largest one.
  std::vector<std::string> image_uris(const std::vector<std::vector<listed_image>>& images) const {
    std::vector<std::string> out(pager_.image_count());
    for (std::size_t i = 0; i < images.size(); ++i) {
      const listed_image& largest = images[i].back();
      const char* const extension = image_extensions[static_cast<std::size_t>(largest.type)];
      out[pager_.images()[i].number] = "../" + path_in_site("images", largest.file.name, extension);
    }
    return out;
  }

  void write_tileset(site_folder& site) {
    const std::string text = tiles_->tileset();
    site.finish_with_copies("tileset.json", std::as_bytes(std::span(text)));
    result_.tiles = tiles_->count();
    result_.tile_bytes = tiles_->tile_bytes();
    result_.sent_tiles = tiles_->sent();
    result_.tileset_bytes = text.size();
  }

  std::vector<listed_chunk> write_cells(const polygon_numbers& numbers, const page_plan& plan,
                                        const std::vector<listed_file>& pages, site_folder& site) {
    const std::uint32_t count = polygons_.file().cell_count();
    cell_lists lists(pager_, numbers, plan);
    std::vector<streamed_cell> cells;
    double bytes = 0.0, gzip_bytes = 0.0;
    for (std::uint32_t cell = 0; cell < count; ++cell) {
      polygons_.read(cell);
      cells.push_back(lists.list_of(cell, polygons_));
      for (const listed_page& page : cells.back().pages) {
        bytes += pages[page.number].bytes;
        gzip_bytes += static_cast<double>(sent_[page.number].gzip);
      }
      report(stream_phase::writing_cells, cell + 1, count);
    }
    result_.mean_cell_bytes = count == 0 ? 0.0 : bytes / count;
    result_.mean_cell_gzip_bytes = count == 0 ? 0.0 : gzip_bytes / count;
    std::vector<listed_chunk> out;
    write_chunks(cells, chunk_bytes, [&](std::vector<std::uint8_t> file, std::span<const streamed_cell> some) {
      listed_chunk chunk{site.add("cells", "cells", std::as_bytes(std::span(file))),
                         static_cast<std::uint32_t>(some.size()), some.front().box};
      for (const streamed_cell& cell : some)
        for (std::size_t k = 0; k < 3; ++k) {
          chunk.box.min[k] = std::min(chunk.box.min[k], cell.box.min[k]);
          chunk.box.max[k] = std::max(chunk.box.max[k], cell.box.max[k]);
        }
      result_.chunk_bytes += file.size();
      out.push_back(chunk);
    });
    return out;
  }

  void count(const polygon_numbers& numbers, const page_plan& plan, const front_content& front) {
    const scene::scene& s = pager_.content();
    result_.polygons = s.polygon_count;
    result_.draws = static_cast<std::uint32_t>(s.draws.size());
    result_.geometries = static_cast<std::uint32_t>(pager_.geometries().size());
    result_.cells = polygons_.file().cell_count();
    result_.pages = static_cast<std::uint32_t>(front.pages.size());
    result_.chunks = static_cast<std::uint32_t>(front.chunks.size());
    result_.images = static_cast<std::uint32_t>(front.images.size());
    for (std::uint32_t id = 0; id < s.polygon_count; ++id)
      result_.polygons_left_out += plan.page_of[numbers.number_of(id)] == no_page;
  }

  const stream_settings& how_;
  const stream_progress& report_;
  visible_polygons polygons_;
  scene::gltf_pager pager_;
  std::optional<tileset_writer> tiles_;
  std::vector<sent_bytes> sent_;  // by page
  stream_result result_;
};

}  // namespace

stream_result pack_stream(const std::filesystem::path& scene_path, int scene_index, std::span<const std::byte> file,
                          const std::string& name, const std::filesystem::path& output, const stream_settings& how,
                          const stream_progress& on_progress) {
  return stream_packer(scene_path, scene_index, file, name, how, on_progress).write(output);
}

}  // namespace sightcell::bake
