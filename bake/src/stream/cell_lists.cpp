#include "stream/cell_lists.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>

#include "sightcell/format/importance_classes.h"

namespace sightcell::bake {
namespace {

constexpr std::uint8_t least_weight = 255;

// Returns b for the share 2^(-b / 8) of a weight.
std::uint8_t share_of(float weight, float whole) {
  if (!(weight > 0.0f) || !(whole > 0.0f)) return least_weight;
  const double eighths = std::round(-8.0 * std::log2(static_cast<double>(weight) / static_cast<double>(whole)));
  return static_cast<std::uint8_t>(std::clamp(eighths, 0.0, static_cast<double>(least_weight)));
}

// A column over all cells of a chunk.
template <class Get>
void put_box_columns(std::span<const streamed_cell* const> cells, payload& out, const Get& get) {
  std::vector<float> column(cells.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < cells.size(); ++i) column[i] = get(cells[i]->box)[axis];
    out.put_floats(column);
  }
}

template <class Item>
void put_weighted(std::span<const streamed_cell* const> cells, payload& out, std::vector<Item> streamed_cell::*list) {
  std::vector<std::uint32_t> numbers;
  for (const streamed_cell* cell : cells) out.put_varint(static_cast<std::uint32_t>((cell->*list).size()));
  for (const streamed_cell* cell : cells) {
    numbers.clear();
    for (const Item& w : cell->*list) numbers.push_back(w.number);
    out.put_gaps(numbers);
  }
  std::vector<std::uint8_t> shares;
  for (const streamed_cell* cell : cells)
    for (const Item& w : cell->*list) shares.push_back(share_of(w.weight, cell->weight));
  out.put_bytes(shares);
}

void put_sectors(std::span<const streamed_cell* const> cells, payload& out) {
  std::vector<std::uint8_t> sectors;
  for (const streamed_cell* cell : cells)
    for (const listed_page& page : cell->pages) sectors.push_back(page.sectors);
  out.put_bytes(sectors);
}

void put_draws(std::span<const streamed_cell* const> cells, payload& out) {
  payload runs;
  for (const streamed_cell* cell : cells) {
    std::uint32_t count = 0, end = 0;
    for (std::size_t i = 0; i < cell->draws.size(); ++count) {
      const std::uint32_t first = cell->draws[i];
      std::uint32_t length = 1;
      while (++i < cell->draws.size() && cell->draws[i] == first + length) ++length;
      runs.put_varint(first - end);
      runs.put_varint(length - 1);
      end = first + length;
    }
    out.put_varint(count);
  }
  out.put(runs);
}

std::vector<std::uint8_t> chunk_file(std::span<const streamed_cell> cells) {
  std::vector<const streamed_cell*> pointers;
  for (const streamed_cell& cell : cells) pointers.push_back(&cell);
  const payload content = chunk_payload(pointers);
  payload file;
  file.put_u32(static_cast<std::uint32_t>(content.bytes().size()));
  file.put_bytes(deflated(content.bytes()));
  return {file.bytes().begin(), file.bytes().end()};
}

// A range of headings in sectors of 45 degrees.
struct heading_range {
  double middle = 0.0, half = 4.0;  // 4: all
};

// Returns the headings of a polygon from anywhere in a cell. Headings are about +y, from +x to +z.
// center, radius: of the cell, in x and z.
heading_range headings_of(const scene::draw& d, const scene::geometry& g, std::uint32_t polygon,
                          const std::array<double, 2>& center, double radius) {
  std::array<glm::dvec2, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec4 local(glm::dvec3(g.positions[g.indices[3 * std::size_t{polygon} + k]]), 1.0);
    const glm::dvec4 p = d.to_world * local;
    corners[k] = {p.x - center[0], p.z - center[1]};
  }
  const glm::dvec2 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
  double extent = 0.0;
  for (const glm::dvec2& corner : corners) extent = std::max(extent, glm::distance(corner, middle));
  const double distance = glm::length(middle), reach = radius + extent;
  if (!(distance > reach)) return {};
  constexpr double sectors_per_radian = 4.0 / std::numbers::pi;
  return {std::atan2(middle.y, middle.x) * sectors_per_radian, std::asin(reach / distance) * sectors_per_radian};
}

// Spreads the weight evenly over the range.
void add_headings(std::array<double, 8>& sums, const heading_range& range, double weight) {
  if (range.half >= 4.0) {
    for (double& sum : sums) sum += weight / static_cast<double>(sums.size());
    return;
  }
  const double half = std::max(range.half, 1e-6), begin = range.middle - half, end = range.middle + half;
  const auto last = static_cast<int>(std::floor(end));
  for (int sector = static_cast<int>(std::floor(begin)); sector <= last; ++sector) {
    const double within = std::min(end, sector + 1.0) - std::max(begin, static_cast<double>(sector));
    sums[static_cast<std::size_t>((sector + 16) % 8)] += weight * within / (end - begin);
  }
}

float center_of(const streamed_cell& cell, std::size_t axis) {
  return 0.5f * (cell.box.min[axis] + cell.box.max[axis]);
}

// Returns the axis along which the centers of cells are farthest apart.
std::size_t longest_axis_of(std::span<const streamed_cell> cells) {
  std::size_t longest = 0;
  float length = -1.0f;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax_element(cells.begin(), cells.end(), [axis](const auto& a, const auto& b) {
      return center_of(a, axis) < center_of(b, axis);
    });
    const float here = center_of(*high, axis) - center_of(*low, axis);
    if (here > length) length = here, longest = axis;
  }
  return longest;
}

}  // namespace

void cell_lists::sums::add(std::uint32_t number, double weight) {
  if (!is_used[number]) {
    is_used[number] = true;
    used.push_back(number);
  }
  weights[number] += weight;
}

std::vector<weighted_number> cell_lists::sums::take() {
  std::sort(used.begin(), used.end());
  std::vector<weighted_number> out;
  for (const std::uint32_t number : used) {
    out.push_back({number, static_cast<float>(weights[number])});
    weights[number] = 0.0;
    is_used[number] = false;
  }
  used.clear();
  return out;
}

cell_lists::cell_lists(const scene::gltf_pager& pager, const polygon_numbers& numbers, const page_plan& plan)
    : pager_(pager), numbers_(numbers), plan_(plan) {
  const auto resize = [](sums& s, std::size_t size) { s.weights.resize(size), s.is_used.resize(size); };
  resize(pages_, plan.pages.size());
  sectors_.resize(plan.pages.size(), {});
  resize(draws_, pager.content().draws.size());
  resize(images_, pager.image_count());
}

streamed_cell cell_lists::list_of(std::uint32_t cell, const visible_polygons& polygons) {
  streamed_cell out;
  out.cell = cell;
  (void)polygons.file().cell_box(cell, out.box);  // checked when the file was opened
  double whole = 0.0;
  const auto half = [&](std::size_t axis) {
    return 0.5 * (static_cast<double>(out.box.max[axis]) - static_cast<double>(out.box.min[axis]));
  };
  const std::array<double, 2> center = {static_cast<double>(out.box.min[0]) + half(0),
                                        static_cast<double>(out.box.min[2]) + half(2)};
  const double radius = std::hypot(half(0), half(2));
  for (std::size_t i = 0; i < polygons.source_ids().size(); ++i) {
    const std::uint32_t id = polygons.source_ids()[i];
    const std::uint32_t draw = numbers_.draw_of(id);
    if (is_in_every_cell(pager_.content().draws[draw])) continue;
    const std::uint32_t page = plan_.page_of[numbers_.number_of(id)];
    if (page == no_page) continue;
    const double weight = static_cast<double>(format::solid_angle_of_class(polygons.classes()[i]));
    whole += weight;
    draws_.add(draw, weight);
    // A page that is in every cell, because another draw is, needs no second mention.
    if (std::binary_search(plan_.always.begin(), plan_.always.end(), page)) continue;
    pages_.add(page, weight);
    const scene::draw& d = pager_.content().draws[draw];
    add_headings(sectors_[page],
                 headings_of(d, pager_.content().geometries[d.geometry], id - d.first_source, center, radius), weight);
  }
  out.weight = static_cast<float>(whole);
  out.pages = with_sectors(pages_.take());
  for (const weighted_number& draw : draws_.take()) {
    out.draws.push_back(draw.number);
    for (const std::uint32_t image : pager_.images_of(pager_.content().draws[draw.number].material))
      images_.add(image, static_cast<double>(draw.weight));
  }
  out.images = images_.take();
  return out;
}

std::vector<listed_page> cell_lists::with_sectors(const std::vector<weighted_number>& pages) {
  constexpr double least_share = 1.0 / 16.0;  // of the page's weight
  std::vector<listed_page> out;
  for (const weighted_number& page : pages) {
    listed_page& made = out.emplace_back(listed_page{page.number, page.weight, 0});
    std::array<double, 8>& of_page = sectors_[page.number];
    for (unsigned k = 0; k < of_page.size(); ++k)
      if (of_page[k] >= least_share * static_cast<double>(page.weight))
        made.sectors = static_cast<std::uint8_t>(made.sectors | 1u << k);
    of_page = {};
  }
  return out;
}

payload chunk_payload(std::span<const streamed_cell* const> cells) {
  payload out;
  std::vector<std::uint32_t> numbers;
  std::vector<float> weights;
  for (const streamed_cell* cell : cells) numbers.push_back(cell->cell), weights.push_back(cell->weight);
  out.put_varint(static_cast<std::uint32_t>(cells.size()));
  out.put_deltas(numbers);
  put_box_columns(cells, out, [](const format::box& b) { return b.min; });
  put_box_columns(cells, out, [](const format::box& b) { return b.max; });
  out.put_floats(weights);
  put_weighted(cells, out, &streamed_cell::pages);
  put_sectors(cells, out);
  put_draws(cells, out);
  put_weighted(cells, out, &streamed_cell::images);
  return out;
}

void write_chunks(
    std::span<streamed_cell> cells, std::size_t limit,
    const std::function<void(std::vector<std::uint8_t> file, std::span<const streamed_cell> cells)>& use) {
  if (cells.empty()) return;
  std::vector<std::uint8_t> file = chunk_file(cells);
  if (file.size() <= limit || cells.size() == 1) return use(std::move(file), cells);
  const std::size_t axis = longest_axis_of(cells), half = cells.size() / 2;
  std::sort(cells.begin(), cells.end(), [axis](const streamed_cell& a, const streamed_cell& b) {
    const float x = center_of(a, axis), y = center_of(b, axis);
    return x != y ? x < y : a.cell < b.cell;
  });
  write_chunks(cells.first(half), limit, use);
  write_chunks(cells.subspan(half), limit, use);
}

}  // namespace sightcell::bake
