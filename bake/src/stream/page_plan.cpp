#include "stream/page_plan.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "stream/group_similar.h"
#include "stream/patches.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t polygons_of_chunk = 128;
constexpr std::uint32_t json_bytes = 1'300;  // of a page with one set of attributes

enum class page_kind : std::uint8_t { of_cells, of_every_cell, of_no_cell };
constexpr std::array<page_kind, 3> page_kinds = {page_kind::of_every_cell, page_kind::of_cells, page_kind::of_no_cell};

// Polygons of one geometry that share a page.
struct polygon_chunk {
  scene::page_part part;
  sketch seen = sketch_table::nothing();
  glm::vec3 place{0.0f};  // in the world
  std::uint32_t bytes = 0;
  page_kind kind = page_kind::of_cells;
};

glm::vec3 middle_of(const scene::geometry& g, std::uint32_t polygon) {
  glm::vec3 sum(0.0f);
  for (std::size_t k = 0; k < 3; ++k) sum += g.positions[g.indices[3 * std::size_t{polygon} + k]];
  return sum / 3.0f;
}

// Returns, by geometry, the number of a draw that shows where it is; no_index for a geometry of no draw.
std::vector<std::uint32_t> first_draws(const scene::gltf_pager& pager) {
  std::vector<std::uint32_t> out(pager.geometries().size(), scene::no_index);
  const std::vector<std::uint32_t>& geometry_of = pager.geometry_of_draw();
  for (std::uint32_t number = 0; number < geometry_of.size(); ++number)
    if (out[geometry_of[number]] == scene::no_index) out[geometry_of[number]] = number;
  return out;
}

glm::vec3 in_world(const scene::draw& d, const glm::vec3& local) {
  const glm::vec3 p(d.to_world * glm::dvec4(glm::dvec3(local), 1.0));
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) ? p : glm::vec3(0.0f);
}

class chunk_maker {
 public:
  chunk_maker(const scene::gltf_pager& pager, const polygon_numbers& numbers, const sketch_table& seen)
      : pager_(pager), numbers_(numbers), seen_(seen), first_draw_(first_draws(pager)) {
    in_every_cell_.resize(pager.geometries().size(), false);
    for (std::uint32_t number = 0; number < pager.content().draws.size(); ++number)
      if (is_in_every_cell(pager.content().draws[number])) in_every_cell_[pager.geometry_of_draw()[number]] = true;
  }

  std::vector<polygon_chunk> chunks_of(std::uint32_t geometry) const {
    std::vector<polygon_chunk> out;
    if (first_draw_[geometry] == scene::no_index) return out;
    const scene::draw& d = pager_.content().draws[first_draw_[geometry]];
    const scene::geometry& shape = pager_.content().geometries[d.geometry];
    std::array<std::vector<std::uint32_t>, page_kinds.size()> polygons;
    for (std::uint32_t polygon = 0; polygon < pager_.geometries()[geometry].polygon_count; ++polygon)
      if (pager_.is_drawn(geometry, polygon))
        polygons[static_cast<std::size_t>(kind_of(geometry, polygon))].push_back(polygon);
    for (const page_kind kind : page_kinds) {
      std::vector<patch> patches = patches_in(geometry, shape, polygons[static_cast<std::size_t>(kind)]);
      std::vector<grouped_item> items;
      for (std::uint32_t i = 0; i < patches.size(); ++i)
        items.push_back(
            {&patches[i].seen, patches[i].place, static_cast<std::uint32_t>(patches[i].polygons.size()), i});
      for (const std::span<grouped_item> group : group_similar(items, polygons_of_chunk))
        out.push_back(chunk_of(geometry, d, group, patches, kind));
    }
    return out;
  }

 private:
  struct patch {
    std::vector<std::uint32_t> polygons;
    sketch seen = sketch_table::nothing();
    glm::vec3 place{0.0f};
  };

  page_kind kind_of(std::uint32_t geometry, std::uint32_t polygon) const {
    if (in_every_cell_[geometry]) return page_kind::of_every_cell;
    return sketch_of(geometry, polygon)[0] == unseen_component ? page_kind::of_no_cell : page_kind::of_cells;
  }

  const sketch& sketch_of(std::uint32_t geometry, std::uint32_t polygon) const {
    return seen_[numbers_.begin_of(geometry) + polygon];
  }

  std::vector<patch> patches_in(std::uint32_t geometry, const scene::geometry& shape,
                                std::span<const std::uint32_t> polygons) const {
    const auto seen = [&](std::uint32_t polygon) -> const sketch& { return sketch_of(geometry, polygon); };
    std::vector<patch> out;
    for (std::vector<std::uint32_t>& some : patches_of(polygons, shape.indices, seen)) {
      patch& made = out.emplace_back();
      for (const std::uint32_t polygon : some) {
        join(made.seen, seen(polygon));
        made.place += middle_of(shape, polygon);
      }
      made.place /= static_cast<float>(some.size());
      made.polygons = std::move(some);
    }
    return out;
  }

  polygon_chunk chunk_of(std::uint32_t geometry, const scene::draw& d, std::span<const grouped_item> group,
                         const std::vector<patch>& patches, page_kind kind) const {
    polygon_chunk out;
    out.kind = kind;
    out.part.geometry = geometry;
    glm::vec3 sum(0.0f);
    for (const grouped_item& item : group) {
      const std::vector<std::uint32_t>& polygons = patches[item.number].polygons;
      out.part.polygons.insert(out.part.polygons.end(), polygons.begin(), polygons.end());
      join(out.seen, *item.seen);
      sum += item.place;
    }
    std::sort(out.part.polygons.begin(), out.part.polygons.end());
    out.place = in_world(d, sum / static_cast<float>(group.size()));
    out.bytes = pager_.coded_size(out.part);
    return out;
  }

  const scene::gltf_pager& pager_;
  const polygon_numbers& numbers_;
  const sketch_table& seen_;
  std::vector<std::uint32_t> first_draw_;
  std::vector<bool> in_every_cell_;
};

std::vector<scene::page_part> parts_of(std::span<const grouped_item> group, const std::vector<polygon_chunk>& chunks) {
  std::vector<scene::page_part> parts;
  for (const grouped_item& item : group) parts.push_back(chunks[item.number].part);
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.geometry < b.geometry; });
  std::vector<scene::page_part> out;
  for (scene::page_part& part : parts) {
    if (out.empty() || out.back().geometry != part.geometry) {
      out.push_back(std::move(part));
      continue;
    }
    std::vector<std::uint32_t>& polygons = out.back().polygons;
    const auto middle = static_cast<std::ptrdiff_t>(polygons.size());
    polygons.insert(polygons.end(), part.polygons.begin(), part.polygons.end());
    std::inplace_merge(polygons.begin(), polygons.begin() + middle, polygons.end());
  }
  return out;
}

}  // namespace

bool is_in_every_cell(const scene::draw& d) {
  return d.moves || d.tags.always;
}

page_plan plan_pages(const scene::gltf_pager& pager, const polygon_numbers& numbers, const sketch_table& seen,
                     std::uint32_t page_bytes, const std::function<void(std::uint64_t)>& on_progress) {
  const chunk_maker maker(pager, numbers, seen);
  std::vector<std::vector<polygon_chunk>> by_geometry(pager.geometries().size());
  constexpr std::size_t step = 64;
  for (std::size_t begin = 0; begin < by_geometry.size(); begin += step) {
    const std::size_t end = std::min(by_geometry.size(), begin + step);
    tbb::parallel_for(begin, end,
                      [&](std::size_t g) { by_geometry[g] = maker.chunks_of(static_cast<std::uint32_t>(g)); });
    if (on_progress) on_progress(end);
  }
  std::vector<polygon_chunk> chunks;
  for (std::vector<polygon_chunk>& some : by_geometry) std::move(some.begin(), some.end(), std::back_inserter(chunks));

  page_plan plan;
  plan.page_of.assign(numbers.count(), no_page);
  // Groups are halved until they fit, which leaves them at three quarters of the limit in the mean.
  const std::uint64_t limit =
      (page_bytes > 2 * json_bytes ? page_bytes - json_bytes : page_bytes / 2) * std::uint64_t{4} / 3;
  for (const page_kind kind : page_kinds) {
    std::vector<grouped_item> items;
    for (std::uint32_t i = 0; i < chunks.size(); ++i)
      if (chunks[i].kind == kind) items.push_back({&chunks[i].seen, chunks[i].place, chunks[i].bytes, i});
    for (const std::span<grouped_item> group : group_similar(items, limit)) {
      const auto page = static_cast<std::uint32_t>(plan.pages.size());
      plan.pages.push_back(parts_of(group, chunks));
      if (kind == page_kind::of_every_cell) plan.always.push_back(page);
      for (const scene::page_part& part : plan.pages.back())
        for (const std::uint32_t polygon : part.polygons)
          plan.page_of[numbers.begin_of(part.geometry) + polygon] = page;
    }
  }
  return plan;
}

}  // namespace sightcell::bake
