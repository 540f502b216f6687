#include "sampler/nir04.h"

#include <algorithm>
#include <array>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

#include "search/boundary_face.h"

namespace sightcell::bake {
namespace {

// Corners are at multiples of the length of a face / 4096, so that adjacent quads share them: 12 divisions.
constexpr std::uint32_t steps = 4096;
constexpr int deepest_part = 6;  // limit on the halvings of a cell

struct corner {
  bool free = false;
  corner_view seen;
};

struct quad {
  double difference = 0.0;
  std::uint32_t face = 0, x = 0, y = 0, size = steps;  // corner and side length in steps
  // Returns an estimate of what is missing inside the quad: an equal difference counts more on a larger area.
  double priority() const { return difference * size * size; }
  // Orders by priority. Of equals the largest quad comes first, then the order of faces and rows decides.
  bool operator<(const quad& other) const {
    return std::tuple(priority(), size, ~face, ~y, ~x) <
           std::tuple(other.priority(), other.size, ~other.face, ~other.y, ~other.x);
  }
};

// Samples one box: a cell or a part of one.
class part_sampling {
 public:
  part_sampling(const nir04_options& how, const box& where, const std::function<bool(const glm::vec3&)>& is_valid,
                double pixels, hemicubes& cell)
      : how_(how), faces_(faces_of(where.min, where.max)), is_valid_(is_valid), pixels_(pixels), cell_(cell) {}

  // Renders at most budget hemicubes.
  void sample(std::uint32_t budget) {
    budget_ = budget;
    start();
    while (!quads_.empty() && left() > 0) {
      const quad next = quads_.top();
      quads_.pop();
      if (next.difference <= how_.difference || next.size == 1) continue;
      divide(next);
    }
  }

  // Returns the number of polygons that all corners show together.
  std::size_t polygons() const {
    std::vector<std::uint32_t> ids;
    for (const auto& face : corners_)
      for (const auto& [at, one] : face)
        for (const seen_polygon& s : one.seen) ids.push_back(s.id);
    std::sort(ids.begin(), ids.end());
    return static_cast<std::size_t>(std::unique(ids.begin(), ids.end()) - ids.begin());
  }

 private:
  using place = std::pair<std::uint32_t, std::uint32_t>;

  std::uint32_t left() const { return std::min(budget_ - std::min(budget_, taken_), cell_.left()); }

  void start() {
    const std::size_t each = budget_ / faces_.size();
    if (each < 4) {
      for (std::uint32_t face = 0; face < faces_.size(); ++face) want(face, {steps / 2, steps / 2});
      render_queued();
      return;
    }
    const std::uint32_t size = each < 9 ? steps : steps / 2;
    for (std::uint32_t face = 0; face < faces_.size(); ++face)
      for (std::uint32_t y = 0; y <= steps; y += size)
        for (std::uint32_t x = 0; x <= steps; x += size) want(face, {x, y});
    render_queued();
    for (std::uint32_t face = 0; face < faces_.size(); ++face)
      for (std::uint32_t y = 0; y < steps; y += size)
        for (std::uint32_t x = 0; x < steps; x += size) add_quad({0.0, face, x, y, size}, 0.0);
  }

  void divide(const quad& whole) {
    const std::uint32_t half = whole.size / 2;
    for (std::uint32_t y = 0; y <= 2; ++y)
      for (std::uint32_t x = 0; x <= 2; ++x) want(whole.face, {whole.x + x * half, whole.y + y * half});
    render_queued();
    for (std::uint32_t y = 0; y < 2; ++y)
      for (std::uint32_t x = 0; x < 2; ++x)
        add_quad({0.0, whole.face, whole.x + x * half, whole.y + y * half, half}, whole.difference);
  }

  // parent: difference of the quad that contains it, used where walls leave fewer than two corners.
  void add_quad(quad one, double parent) {
    std::array<const corner_view*, 4> seen{};
    std::size_t count = 0;
    for (const place& at : {place{one.x, one.y},
                            {one.x + one.size, one.y},
                            {one.x, one.y + one.size},
                            {one.x + one.size, one.y + one.size}}) {
      const auto found = corners_[one.face].find(at);
      if (found != corners_[one.face].end() && found->second.free) seen[count++] = &found->second.seen;
    }
    one.difference = count < 2 ? parent : quad_difference(std::span(seen).first(count), pixels_);
    quads_.push(one);
  }

  void want(std::uint32_t face, const place& at) {
    const auto [found, is_new] = corners_[face].try_emplace(at);
    if (!is_new) return;
    const pose where = faces_[face].at(glm::vec2{at.first, at.second} / static_cast<float>(steps));
    if (!is_valid_(where.eye)) return;
    queued_.push_back(&found->second);
    poses_.push_back(where);
  }

  // If the budget ends within a batch, the first poses get it.
  void render_queued() {
    const std::size_t count = std::min<std::size_t>(left(), poses_.size());
    views_.resize(count);
    cell_.take(std::span(poses_).first(count), views_);
    taken_ += static_cast<std::uint32_t>(count);
    for (std::size_t i = 0; i < count; ++i) {
      queued_[i]->free = true;
      queued_[i]->seen = std::move(views_[i].seen);
    }
    queued_.clear();
    poses_.clear();
  }

  const nir04_options& how_;
  const std::array<boundary_face, 6> faces_;
  const std::function<bool(const glm::vec3&)>& is_valid_;
  const double pixels_;
  hemicubes& cell_;
  std::uint32_t budget_ = 0, taken_ = 0;
  std::array<std::map<place, corner>, 6> corners_;  // pointers into it stay valid
  std::priority_queue<quad> quads_;
  std::vector<corner*> queued_;
  std::vector<pose> poses_;
  std::vector<hemicube_view> views_;
};

// In the original a hierarchy of cells ends where a cell sees few enough polygons. Here cells are given, so a cell
// that sees more is halved across its longest side, and the sets of the halves are joined.
void sample_part(const nir04_options& how, const box& where, const std::function<bool(const glm::vec3&)>& is_valid,
                 double pixels, hemicubes& cell, std::uint32_t budget, int depth) {
  const bool may_cut = how.part_polygons > 0 && depth < deepest_part;
  part_sampling part(how, where, is_valid, pixels, cell);
  const std::uint32_t before = cell.taken();
  part.sample(may_cut ? (budget + 2) / 3 : budget);
  budget -= std::min(budget, cell.taken() - before);
  if (!may_cut || budget < 12 || part.polygons() <= how.part_polygons) return;
  const glm::vec3 size = where.max - where.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.z >= size.y ? 2 : 1);
  box low = where, high = where;
  low.max[axis] = high.min[axis] = 0.5f * (where.min[axis] + where.max[axis]);
  const std::uint32_t half = budget / 2;
  sample_part(how, low, is_valid, pixels, cell, half, depth + 1);
  sample_part(how, high, is_valid, pixels, cell, budget - half, depth + 1);
}

}  // namespace

double quad_difference(std::span<const corner_view* const> corners, double pixels) {
  if (corners.size() < 2) return 0.0;
  std::array<std::size_t, 4> at{};
  std::array<double, 4> missing{};
  for (;;) {
    std::uint32_t id = UINT32_MAX, most = 0;
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (at[i] < corners[i]->size()) id = std::min(id, (*corners[i])[at[i]].id);
    if (id == UINT32_MAX) break;
    std::array<bool, 4> has{};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (at[i] == corners[i]->size() || (*corners[i])[at[i]].id != id) continue;
      has[i] = true;
      most = std::max(most, (*corners[i])[at[i]++].pixels);
    }
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (!has[i]) missing[i] += most;
  }
  return *std::max_element(missing.begin(), missing.end()) / pixels;
}

void sample_nir04(const nir04_options& how, const box& grown, const std::function<bool(const glm::vec3&)>& is_valid,
                  hemicubes& cell) {
  const double pixels = 3.0 * cell.resolution() * cell.resolution();
  sample_part(how, grown, is_valid, pixels, cell, cell.left(), 0);
}

}  // namespace sightcell::bake
