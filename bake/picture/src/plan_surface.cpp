#include "plan_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace sightcell::picture {
namespace {

// Cuts are at these steps, so that walls can be cut with horizontal planes. The offset keeps them from the heights that
// people build at.
constexpr double step = 0.25, offset = 0.11;  // meters
constexpr double steep = 0.8;                 // vertical part of the normal; what is steeper is a wall
constexpr std::int32_t tile = 16;             // pixels

// Where each area ends is a border of squares; a square has the ground of an area in it or near it.
class ground_map {
 public:
  ground_map(const plan_shape& shape, const std::vector<plan_area>& areas) {
    double narrowest = std::numeric_limits<double>::infinity();
    for (const plan_area& a : areas)
      narrowest = std::min(narrowest,
                           static_cast<double>(std::min(a.where.max_x - a.where.min_x, a.where.max_z - a.where.min_z)));
    side_ = std::max(std::floor(narrowest * shape.scale), 2.0);
    width_ = static_cast<std::int32_t>(std::ceil(shape.width / side_));
    height_ = static_cast<std::int32_t>(std::ceil(shape.height / side_));
    const std::size_t squares = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    squares_.assign(squares, no_surface);
    highest_.assign(squares, no_surface);
    steps_.assign(squares, 0);
    for (const plan_area& a : areas) put(shape, a);
    for (std::size_t i = 0; i < squares; ++i)
      if (squares_[i] != no_surface) squares_[i] = 0.5f * (squares_[i] + highest_[i]);
    spread();
    ledge_ = std::max(side_ / shape.scale, 1.5);
  }

  // x, y: pixels.
  float at(std::int32_t x, std::int32_t y) const {
    const double u = (x + 0.5) / side_ - 0.5, v = (y + 0.5) / side_ - 0.5;
    const auto left = static_cast<std::int32_t>(std::floor(u)), upper = static_cast<std::int32_t>(std::floor(v));
    const std::array<double, 4> near{of(left, upper), of(left + 1, upper), of(left, upper + 1),
                                     of(left + 1, upper + 1)};
    const auto [low, high] = std::minmax_element(near.begin(), near.end());
    if (*high - *low > ledge_)
      return static_cast<float>(of(static_cast<std::int32_t>(u + 0.5), static_cast<std::int32_t>(v + 0.5)));
    const double s = u - left, t = v - upper;
    return static_cast<float>((1 - t) * ((1 - s) * near[0] + s * near[1]) + t * ((1 - s) * near[2] + s * near[3]));
  }

  // Returns whether an area is in this square or the one beside it.
  bool is_near_area(std::int32_t x, std::int32_t y) const {
    return steps_[number(static_cast<std::int32_t>(x / side_), static_cast<std::int32_t>(y / side_))] <= 1;
  }

 private:
  std::size_t number(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, height_ - 1)) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(std::clamp(x, 0, width_ - 1));
  }
  double of(std::int32_t x, std::int32_t y) const { return static_cast<double>(squares_[number(x, y)]); }

  void put(const plan_shape& shape, const plan_area& a) {
    const auto first = [&](float at, double from) {
      return static_cast<std::int32_t>(std::floor((static_cast<double>(at) - from) * shape.scale / side_ + 0.25));
    };
    const auto last = [&](float at, double from) {
      return static_cast<std::int32_t>(std::ceil((static_cast<double>(at) - from) * shape.scale / side_ - 0.25)) - 1;
    };
    for (std::int32_t y = first(a.where.min_z, shape.min_z); y <= last(a.where.max_z, shape.min_z); ++y)
      for (std::int32_t x = first(a.where.min_x, shape.min_x); x <= last(a.where.max_x, shape.min_x); ++x) {
        float& ground = squares_[number(x, y)];
        ground = ground == no_surface ? a.ground : std::min(ground, a.ground);
        highest_[number(x, y)] = std::max(highest_[number(x, y)], a.ground);
      }
  }

  // Squares without an area take the ground of the nearest one.
  void spread() {
    std::vector<std::size_t> border;
    for (std::size_t i = 0; i < squares_.size(); ++i)
      if (squares_[i] != no_surface) border.push_back(i);
    for (std::size_t next = 0; next < border.size(); ++next) {
      const auto x = static_cast<std::int32_t>(border[next] % static_cast<std::size_t>(width_));
      const auto y = static_cast<std::int32_t>(border[next] / static_cast<std::size_t>(width_));
      for (const auto [dx, dy] : std::array<std::array<std::int32_t, 2>, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}}) {
        const std::size_t to = number(x + dx, y + dy);
        if (squares_[to] != no_surface) continue;
        squares_[to] = squares_[border[next]];
        steps_[to] = static_cast<std::uint16_t>(std::min(steps_[border[next]] + 1, 0xFFFF));
        border.push_back(to);
      }
    }
  }

  double side_ = 1.0;   // pixels
  double ledge_ = 0.0;  // meters: a larger difference between neighbors is no slope, and stays sharp
  std::int32_t width_ = 0, height_ = 0;
  std::vector<float> squares_, highest_;
  std::vector<std::uint16_t> steps_;  // to the nearest area
};

// A corner in pixels; h in meters.
struct corner {
  double x = 0.0, y = 0.0, h = 0.0;
};

class cutter {
 public:
  cutter(const plan_shape& shape, const std::vector<plan_area>& areas) : shape_(shape) {
    const std::size_t pixels = static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.height);
    surface.ground.resize(pixels);
    surface.top.assign(pixels, no_surface);
    surface.light.assign(pixels, 0);
    surface.flags.assign(pixels, 0);
    above_.assign(pixels, std::numeric_limits<float>::max());
    cut_.resize(pixels);
    tiles_wide_ = (shape.width + tile - 1) / tile;
    const std::int32_t tiles_high = (shape.height + tile - 1) / tile;
    tiles_.assign(static_cast<std::size_t>(tiles_wide_) * static_cast<std::size_t>(tiles_high), {});
    const ground_map grounds(shape, areas);
    for (std::int32_t y = 0; y < shape.height; ++y)
      for (std::int32_t x = 0; x < shape.width; ++x) {
        const float ground = grounds.at(x, y);
        const auto level =
            static_cast<std::int32_t>(std::floor((static_cast<double>(ground) + plan_cut - offset) / step));
        surface.ground[pixel(x, y)] = ground;
        if (grounds.is_near_area(x, y)) surface.flags[pixel(x, y)] = plan_near;
        cut_[pixel(x, y)] = level;
        levels& of_tile = tiles_[tile_of(x, y)];
        of_tile.low = std::min(of_tile.low, level);
        of_tile.high = std::max(of_tile.high, level);
      }
  }

  void add(const std::array<glm::vec3, 3>& at, bool two_sided) {
    const glm::dvec3 a(at[0]), b(at[1]), c(at[2]);
    const glm::dvec3 across = glm::cross(b - a, c - a);
    const double length = glm::length(across);
    if (!(length > 0.0)) return;
    const glm::dvec3 normal = across / length;
    const std::array<corner, 3> corners{corner_of(a), corner_of(b), corner_of(c)};
    const auto [low_x, high_x] = std::minmax({corners[0].x, corners[1].x, corners[2].x});
    const auto [low_y, high_y] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
    if (high_x < 0.0 || high_y < 0.0 || low_x > shape_.width || low_y > shape_.height) return;
    const auto inside = [](double value, std::int32_t size) {
      return static_cast<std::int32_t>(std::clamp(std::floor(value), 0.0, static_cast<double>(size - 1)));
    };
    const std::array<std::int32_t, 4> box{inside(low_x, shape_.width), inside(low_y, shape_.height),
                                          inside(high_x, shape_.width), inside(high_y, shape_.height)};
    if (std::abs(normal.y) > 1e-4) cover(corners, box, normal, two_sided);
    if (std::abs(normal.y) < steep) cut(corners, box);
  }

  plan_surface surface;

 private:
  struct levels {
    std::int32_t low = std::numeric_limits<std::int32_t>::max(), high = std::numeric_limits<std::int32_t>::min();
  };

  std::size_t pixel(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(shape_.width) + static_cast<std::size_t>(x);
  }
  std::size_t tile_of(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y / tile) * static_cast<std::size_t>(tiles_wide_) +
           static_cast<std::size_t>(x / tile);
  }
  corner corner_of(const glm::dvec3& p) const {
    return {(p.x - shape_.min_x) * shape_.scale, (p.z - shape_.min_z) * shape_.scale, p.y};
  }

  // Fills the pixels whose centers are in the polygon.
  void cover(const std::array<corner, 3>& c, const std::array<std::int32_t, 4>& box, const glm::dvec3& normal,
             bool two_sided) {
    // The plane, per pixel.
    const double along_x = -normal.x / (normal.y * shape_.scale), along_y = -normal.z / (normal.y * shape_.scale);
    const bool back = normal.y < 0.0 && !two_sided, front_below = normal.y > 0.0 && !two_sided;
    const glm::dvec3 up = normal.y < 0.0 ? -normal : normal;
    constexpr double west = -0.37, high = 0.85, north = -0.37;  // where the light is
    const double lit = std::clamp(up.x * west + up.y * high + up.z * north, 0.0, 1.0);
    for (std::int32_t y = box[1]; y <= box[3]; ++y) {
      const double row = y + 0.5;
      double from = std::numeric_limits<double>::infinity(), to = -from;
      for (std::size_t i = 0; i < 3; ++i) {
        const corner &p = c[i], &q = c[(i + 1) % 3];
        if ((p.y <= row) == (q.y <= row)) continue;
        const double x = p.x + (q.x - p.x) * (row - p.y) / (q.y - p.y);
        from = std::min(from, x);
        to = std::max(to, x);
      }
      if (!(from <= to)) continue;
      const double first = std::max(std::ceil(from - 0.5), 0.0);
      const double last = std::min(std::ceil(to - 0.5) - 1.0, shape_.width - 1.0);
      for (double x = first; x <= last; x += 1.0) {
        const double h = c[0].h + (x + 0.5 - c[0].x) * along_x + (row - c[0].y) * along_y;
        put(pixel(static_cast<std::int32_t>(x), y), static_cast<float>(h), lit, back, front_below);
      }
    }
  }

  // back: seen from behind from above. up: seen from behind from below.
  void put(std::size_t at, float h, double lit, bool back, bool up) {
    std::uint8_t& flags = surface.flags[at];
    if (static_cast<double>(h) <= cut_[at] * step + offset) {
      if (h <= surface.top[at]) return;
      surface.top[at] = h;
      surface.light[at] = static_cast<std::uint8_t>(255.0 * lit + 0.5);
      flags = static_cast<std::uint8_t>(back ? flags | plan_lower_back : flags & ~plan_lower_back);
    } else if (h < above_[at]) {
      above_[at] = h;
      flags = static_cast<std::uint8_t>(up ? flags | plan_upper_back : flags & ~plan_upper_back);
    }
  }

  // Marks the pixels where the polygon passes through the cut.
  void cut(const std::array<corner, 3>& c, const std::array<std::int32_t, 4>& box) {
    levels here;
    for (std::int32_t y = box[1] / tile; y <= box[3] / tile; ++y)
      for (std::int32_t x = box[0] / tile; x <= box[2] / tile; ++x) {
        const levels& of_tile = tiles_[tile_of(x * tile, y * tile)];
        here.low = std::min(here.low, of_tile.low);
        here.high = std::max(here.high, of_tile.high);
      }
    const auto [low, high] = std::minmax({c[0].h, c[1].h, c[2].h});
    const auto level_above = [](double h) { return std::clamp(std::ceil((h - offset) / step), -1e6, 1e6); };
    here.low = std::max(here.low, static_cast<std::int32_t>(level_above(low)));
    here.high = std::min(here.high, static_cast<std::int32_t>(level_above(high)) - 1);
    for (std::int32_t level = here.low; level <= here.high; ++level) cut_at(c, level);
  }

  void cut_at(const std::array<corner, 3>& c, std::int32_t level) {
    const double h = level * step + offset;
    std::array<corner, 2> ends;
    std::size_t found = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const corner &p = c[i], &q = c[(i + 1) % 3];
      if ((p.h <= h) == (q.h <= h) || found == 2) continue;
      const double t = (h - p.h) / (q.h - p.h);
      ends[found++] = {p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t, h};
    }
    if (found < 2) return;
    const double dx = ends[1].x - ends[0].x, dy = ends[1].y - ends[0].y;
    // Only the part in the picture: walls can be longer than it by far.
    double from = 0.0, to = 1.0;
    const auto clip = [&](double at, double along, double size) {
      if (along == 0.0) {
        if (at < 0.0 || at > size) to = -1.0;
        return;
      }
      const double a = -at / along, b = (size - at) / along;
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    };
    clip(ends[0].x, dx, shape_.width);
    clip(ends[0].y, dy, shape_.height);
    if (from > to) return;
    const double pixels = (to - from) * std::max(std::abs(dx), std::abs(dy));
    const auto steps = static_cast<std::int64_t>(std::ceil(pixels)) + 1;
    for (std::int64_t i = 0; i <= steps; ++i) {
      const double t = from + (to - from) * static_cast<double>(i) / static_cast<double>(steps);
      const auto x = static_cast<std::int32_t>(std::floor(ends[0].x + t * dx));
      const auto y = static_cast<std::int32_t>(std::floor(ends[0].y + t * dy));
      if (x < 0 || y < 0 || x >= shape_.width || y >= shape_.height) continue;
      if (cut_[pixel(x, y)] == level) surface.flags[pixel(x, y)] |= plan_wall;
    }
  }

  plan_shape shape_;
  std::vector<float> above_;       // of the lowest polygon above the cut
  std::vector<std::int32_t> cut_;  // level of the cut
  std::int32_t tiles_wide_ = 0;
  std::vector<levels> tiles_;
};

}  // namespace

plan_surface look_from_above(const scene::world_geometry& geometry, const plan_shape& shape,
                             const std::vector<plan_area>& areas) {
  cutter made(shape, areas);
  for (std::size_t p = 0; p < geometry.kinds.size(); ++p) {
    const scene::polygon_kind kind = geometry.kinds[p];
    if (kind.absent || kind.alpha == scene::alpha_mode::blend) continue;
    std::array<glm::vec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = geometry.positions[geometry.indices[3 * p + i]];
    made.add(corners, kind.double_sided || kind.alpha == scene::alpha_mode::mask);
  }
  for (std::uint8_t& flags : made.surface.flags)
    if ((flags & (plan_lower_back | plan_upper_back)) != 0) flags |= plan_inside;
  return std::move(made.surface);
}

}  // namespace sightcell::picture
