#include "cells/voxel_field.h"

#include <Recast.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <new>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

namespace sightcell::bake {
namespace {

// Several per thread, because threads come and go.
static_assert(highest_voxel == RC_SPAN_MAX_HEIGHT);
constexpr int strips_of_thread = 4, most_strips = 8;

bool is_floor(const std::array<glm::dvec3, 3>& at, double slope_limit, bool double_sided) {
  const glm::dvec3 normal = glm::cross(at[1] - at[0], at[2] - at[0]);
  const double length = glm::length(normal);
  const double up = double_sided ? std::abs(normal.y) : normal.y;
  return length > 0.0 && up >= slope_limit * length;
}

// The polygons that become voxels, in an order that does not depend on their numbers.
struct raster_order {
  std::vector<std::uint32_t> floors, others;
};

// Sorts polygons by their highest corner, and those with equal ones by all corners.
void sort_from_the_top(const scene::world_geometry& geometry, std::vector<std::uint32_t>& polygons) {
  struct item {
    float top;  // in the item, because looking corners up for each comparison takes five times as long
    std::uint32_t polygon;
  };
  std::vector<item> items;
  items.reserve(polygons.size());
  for (const std::uint32_t p : polygons) {
    const auto y = [&](std::size_t i) { return geometry.positions[geometry.indices[3 * std::size_t{p} + i]].y; };
    items.push_back({std::max({y(0), y(1), y(2)}), p});
  }
  const auto place = [&](std::uint32_t p) {
    const auto at = double_corners(geometry, p);
    const auto numbers = [](const glm::dvec3& v) { return std::array{v.x, v.y, v.z}; };
    return std::tuple(numbers(at[0]), numbers(at[1]), numbers(at[2]));
  };
  tbb::parallel_sort(items.begin(), items.end(), [&](const item& a, const item& b) {
    return a.top != b.top ? a.top > b.top : place(a.polygon) < place(b.polygon);
  });
  for (std::size_t i = 0; i < items.size(); ++i) polygons[i] = items[i].polygon;
}

// Where spans of several polygons overlap, Recast takes the larger area of the new span and one that ends above it or
// at most a voxel below it. So floors come first: then a wall that stands on a floor is no floor at its top, and one
// below a floor changes nothing. The others follow from the highest to the lowest, so that each that ends a voxel above
// a floor does not make a floor of one that ends a voxel above itself.
raster_order order_of_polygons(const scene::world_geometry& geometry, const field_shape& shape, const settings& how) {
  // The cosine of the slope, rounded down so that the slope itself counts.
  const double slope_limit = std::cos(static_cast<double>(how.player.slope) * std::numbers::pi / 180.0) - 1e-5;
  // Recast converts distances to int before it clips them, so polygons far outside would overflow.
  const double reach = 1e9 * shape.voxel;
  raster_order order;
  for (std::uint32_t p = 0; p < geometry.kinds.size(); ++p) {
    const scene::polygon_kind kind = geometry.kinds[p];
    if (!is_obstacle(kind)) continue;
    const auto at = double_corners(geometry, p);
    const glm::dvec3 low = glm::min(glm::min(at[0], at[1]), at[2]);
    const glm::dvec3 high = glm::max(glm::max(at[0], at[1]), at[2]);
    if (low.x < shape.world.min.x - reach || low.z < shape.world.min.z - reach || high.x > shape.world.max.x + reach ||
        high.z > shape.world.max.z + reach)
      continue;
    const bool floor = is_floor(at, slope_limit, kind.double_sided || how.all_double_sided);
    (floor ? order.floors : order.others).push_back(p);
  }
  sort_from_the_top(geometry, order.others);
  return order;
}

struct row_range {
  int first = 0, last = 0;
};

// Returns the rows of a polygon, by the steps that Recast takes.
row_range rows_of(const scene::world_geometry& geometry, const field_shape& shape, std::uint32_t polygon) {
  const auto z = [&](std::size_t i) { return geometry.positions[geometry.indices[3 * std::size_t{polygon} + i]].z; };
  const float begin = static_cast<float>(shape.world.min.z), per_meter = 1.0f / static_cast<float>(shape.voxel);
  const auto row = [&](float at) { return static_cast<int>((at - begin) * per_meter); };
  return {std::clamp(row(std::min({z(0), z(1), z(2)})), 0, shape.depth - 1),
          std::clamp(row(std::max({z(0), z(1), z(2)})), 0, shape.depth - 1)};
}

// Divides the rows so that about as many polygons begin in each strip. Returns where strips begin, and the end.
std::vector<int> strips_of(const std::vector<row_range>& rows, int depth, int strips) {
  std::vector<std::size_t> begun(static_cast<std::size_t>(depth));
  for (const row_range& r : rows) ++begun[static_cast<std::size_t>(r.first)];
  std::vector<int> begins{0};
  std::size_t seen = 0;
  for (int row = 0; row < depth; ++row) {
    if (seen * static_cast<std::size_t>(strips) >= rows.size() * begins.size() && row > begins.back())
      begins.push_back(row);
    seen += begun[static_cast<std::size_t>(row)];
  }
  begins.push_back(depth);
  return begins;
}

// A field from row 0 on. The pointers of its rows are zeros that take memory only once they are written, unlike those
// that Recast makes: most rows before a strip stay empty.
class strip_field {
 public:
  strip_field(const field_shape& shape, int rows, rcContext& context)
      : field_(rcAllocHeightfield()),
        pointers_(static_cast<rcSpan**>(
            std::calloc(static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(rows), sizeof(rcSpan*)))) {
    const glm::vec3 min(shape.world.min), max(shape.world.max);
    if (!field_ || !pointers_ ||
        !rcCreateHeightfield(&context, *field_, shape.width, 1, &min.x, &max.x, static_cast<float>(shape.voxel),
                             static_cast<float>(shape.step)))
      throw std::bad_alloc();
    field_->height = rows;
    std::swap(field_->spans, own_);
    field_->spans = pointers_.get();
  }
  ~strip_field() { std::swap(field_->spans, own_); }
  strip_field(const strip_field&) = delete;
  strip_field& operator=(const strip_field&) = delete;
  rcHeightfield& operator*() { return *field_; }

 private:
  struct release {
    void operator()(rcHeightfield* field) const { rcFreeHeightField(field); }
    void operator()(rcSpan** pointers) const { std::free(pointers); }
  };
  std::unique_ptr<rcHeightfield, release> field_;
  std::unique_ptr<rcSpan*[], release> pointers_;
  rcSpan** own_ = nullptr;  // what Recast made and frees
};

struct rasterized {
  std::vector<std::unique_ptr<strip_field>> strips;  // have the spans
  std::vector<const rcSpan*> columns;                // the lowest span of each, or null
};

// Recast adds one polygon after the other. In each column only their order counts, so strips of rows are rasterized at
// once, each with the polygons that reach it. A strip is a field from row 0 to its last row: the rows of a polygon are
// clipped one after the other from the first on, and have the same spans as in the whole field for that reason. What it
// has in rows before its own is not used.
rasterized rasterize(const scene::world_geometry& geometry, const field_shape& shape, const player_moves& moves,
                     const settings& how, int threads, const stop_request* stop) {
  constexpr std::size_t between_checks = 1024;  // polygons
  rasterized made;
  made.columns.resize(static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.depth));
  const raster_order order = order_of_polygons(geometry, shape, how);
  std::vector<row_range> rows;
  rows.reserve(order.floors.size() + order.others.size());
  for (const auto* polygons : {&order.floors, &order.others})
    for (const std::uint32_t p : *polygons) rows.push_back(rows_of(geometry, shape, p));
  const std::vector<int> begins = strips_of(rows, shape.depth, std::clamp(strips_of_thread * threads, 1, most_strips));
  made.strips.resize(begins.size() - 1);
  const auto rasterize_strip = [&](std::size_t s) {
    rcContext context(false);
    made.strips[s] = std::make_unique<strip_field>(shape, begins[s + 1], context);
    rcHeightfield& field = **made.strips[s];
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (stop && i % between_checks == 0) stop->check();
      if (rows[i].first >= begins[s + 1] || rows[i].last < begins[s]) continue;
      const bool is_floor = i < order.floors.size();
      const std::uint32_t p = is_floor ? order.floors[i] : order.others[i - order.floors.size()];
      const auto corner = [&](std::size_t k) {
        return &geometry.positions[geometry.indices[3 * std::size_t{p} + k]].x;
      };
      const unsigned char area = is_floor ? RC_WALKABLE_AREA : RC_NULL_AREA;
      if (!rcRasterizeTriangle(&context, corner(0), corner(1), corner(2), area, field)) throw std::bad_alloc();
    }
    rcFilterLowHangingWalkableObstacles(&context, moves.step, field);
    rcFilterWalkableLowHeightSpans(&context, moves.height, field);
    const auto width = static_cast<std::ptrdiff_t>(shape.width);
    std::copy(field.spans + begins[s] * width, field.spans + begins[s + 1] * width,
              made.columns.begin() + begins[s] * width);
  };
  tbb::parallel_for(std::size_t{0}, made.strips.size(), rasterize_strip);
  return made;
}

}  // namespace

std::array<glm::dvec3, 3> double_corners(const scene::world_geometry& geometry, std::size_t polygon) {
  std::array<glm::dvec3, 3> at;
  for (std::size_t i = 0; i < 3; ++i) at[i] = glm::dvec3(geometry.positions[geometry.indices[3 * polygon + i]]);
  return at;
}

open_field open_spaces(const scene::world_geometry& geometry, const field_shape& shape, const player_moves& moves,
                       const settings& how, int threads, const stop_request* stop) {
  const rasterized field = rasterize(geometry, shape, moves, how, threads, stop);
  open_field open;
  open.width = static_cast<std::size_t>(shape.width);
  open.depth = static_cast<std::size_t>(shape.depth);
  const std::size_t columns = open.width * open.depth;
  open.begins.reserve(columns + 1);
  for (std::size_t column = 0; column < columns; ++column) {
    open.begins.push_back(static_cast<std::uint32_t>(open.spaces.size()));
    for (const rcSpan* span = field.columns[column]; span != nullptr; span = span->next) {
      const auto floor = static_cast<std::int32_t>(span->smax);
      const auto ceiling =
          span->next != nullptr ? static_cast<std::int32_t>(span->next->smin) : std::int32_t{highest_voxel};
      if (ceiling - floor >= moves.height) open.spaces.push_back({floor, ceiling, span->area != RC_NULL_AREA});
    }
  }
  open.begins.push_back(static_cast<std::uint32_t>(open.spaces.size()));
  return open;
}

}  // namespace sightcell::bake
