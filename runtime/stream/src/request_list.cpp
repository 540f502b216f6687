#include "request_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "way_ahead.h"

namespace sightcell::streaming {
namespace {

constexpr double view_factor = 16.0;   // of files in the direction of the view
constexpr double walking_speed = 1.5;  // meters per second: a camera that stands still may start to walk
constexpr int samples_across = 33;     // of the horizontal angle of view

runtime::point from(const float v[3]) noexcept {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

runtime::point cross(const runtime::point& a, const runtime::point& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const runtime::point& a, const runtime::point& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Returns false for a vector without a direction.
bool normalize(runtime::point& v) noexcept {
  const double length = std::sqrt(dot(v, v));
  if (!(length > 0.0)) return false;
  for (double& c : v) c /= length;
  return true;
}

// a + s * b + t * c
runtime::point sum(const runtime::point& a, double s, const runtime::point& b, double t = 0.0,
                   const runtime::point& c = {}) noexcept {
  return {a[0] + s * b[0] + t * c[0], a[1] + s * b[1] + t * c[1], a[2] + s * b[2] + t * c[2]};
}

// Returns the sector of the heading atan2(z, x): k for 45 k to 45 (k + 1) degrees.
unsigned sector_of(double x, double z) noexcept {
  const bool below = z < 0.0 || (z == 0.0 && x < 0.0);  // 180 degrees begin sector 4
  if (below) x = -x, z = -z;
  const unsigned half = x > 0.0 ? (z < x ? 0u : 1u) : (z > -x ? 2u : 3u);
  return half + (below ? 4u : 0u);
}

}  // namespace

std::uint32_t nearest_chunk(const sightcell_stream& stream, const runtime::point& eye) noexcept {
  const std::span<const listed_chunk> chunks = stream.front().chunks();
  auto best = static_cast<std::uint32_t>(chunks.size());
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < chunks.size(); ++i) {
    if (stream.state_of(i) == SIGHTCELL_STREAM_FAILED) continue;
    const double away = runtime::squared_distance(chunks[i].box, eye);
    if (away < least) least = away, best = i;
  }
  return best;
}

view_region::view_region(const sightcell_stream_pose& pose) noexcept : eye_(from(pose.eye)) {
  runtime::point forward = from(pose.forward), up = from(pose.up);
  runtime::point right = cross(forward, up);
  if (!normalize(forward) || !normalize(right)) return;
  up = cross(right, forward);
  has_direction_ = true;
  const auto wide = static_cast<double>(pose.half_width), high = static_cast<double>(pose.half_height);
  const auto plane = [&forward](double tangent, const runtime::point& side) {
    runtime::point out = side;
    for (std::size_t axis = 0; axis < 3; ++axis) out[axis] += tangent * forward[axis];
    return out;
  };
  const runtime::point left{-right[0], -right[1], -right[2]}, down{-up[0], -up[1], -up[2]};
  planes_ = {forward, plane(wide, right), plane(wide, left), plane(high, up), plane(high, down)};

  const runtime::point vertical{0.0, forward[1] < 0.0 ? -1.0 : 1.0, 0.0};
  const bool is_steep = std::all_of(planes_.begin(), planes_.end(),
                                    [&vertical](const runtime::point& normal) { return dot(normal, vertical) > 0.0; });
  if (is_steep) return;  // it shows all headings
  headings_ = 0;
  for (int k = 0; k < samples_across; ++k)
    for (const double row : {-high, 0.0, high}) {
      const runtime::point ahead = sum(forward, wide * (2.0 * k / (samples_across - 1) - 1.0), right, row, up);
      headings_ = static_cast<std::uint8_t>(headings_ | 1u << sector_of(ahead[0], ahead[2]));
    }
}

bool view_region::may_show(const runtime::wide_box& box) const noexcept {
  if (!has_direction_) return true;
  return std::all_of(planes_.begin(), planes_.end(), [&](const runtime::point& normal) {
    runtime::point farthest;
    for (std::size_t axis = 0; axis < 3; ++axis)
      farthest[axis] = (normal[axis] > 0.0 ? box.max[axis] : box.min[axis]) - eye_[axis];
    return dot(farthest, normal) > 0.0;
  });
}

request_list::request_list(sightcell_stream& stream, const sightcell_stream_pose& pose,
                           std::span<std::uint32_t> listed_at, std::uint32_t number,
                           std::span<sightcell_stream_request> dst) noexcept
    : stream_(stream), pose_(pose), region_(pose), listed_at_(listed_at), number_(number), dst_(dst) {}

double request_list::priority_of(const sightcell_stream_request& request) const noexcept {
  const std::uint32_t size = std::max(1u, stream_.front().files()[request.file].size);
  return static_cast<double>(request.weight) / size * (request.ahead != 0 ? view_factor : 1.0);
}

bool request_list::is_before(const sightcell_stream_request& a, const sightcell_stream_request& b) const noexcept {
  const double first = priority_of(a), second = priority_of(b);
  return first != second ? first > second : a.file < b.file;
}

void request_list::begin_part(std::uint32_t reason) noexcept {
  reason_ = reason;
  part_begin_ = size_;
}

void request_list::end_part() noexcept {
  const auto before = [this](const auto& a, const auto& b) { return is_before(a, b); };
  std::sort_heap(dst_.begin() + static_cast<std::ptrdiff_t>(part_begin_),
                 dst_.begin() + static_cast<std::ptrdiff_t>(size_), before);
  part_begin_ = size_;
}

// The requests of this part are a heap, the last one of their order on top.
void request_list::add(std::uint32_t file, float weight, bool ahead) noexcept {
  if (stream_.state_of(file) != SIGHTCELL_STREAM_ABSENT || listed_at_[file] == number_) return;
  listed_at_[file] = number_;
  const auto before = [this](const auto& a, const auto& b) { return is_before(a, b); };
  const sightcell_stream_request request{file, reason_, weight, ahead ? 1u : 0u};
  const auto begin = dst_.begin() + static_cast<std::ptrdiff_t>(part_begin_);
  if (size_ == dst_.size()) {
    if (part_begin_ == size_ || !is_before(request, *begin)) return;
    std::pop_heap(begin, dst_.end(), before);
    --size_;
  }
  dst_[size_++] = request;
  std::push_heap(begin, dst_.begin() + static_cast<std::ptrdiff_t>(size_), before);
}

void request_list::add_lookup(bool is_lost) noexcept {
  begin_part(SIGHTCELL_STREAM_FOR_LOOKUP);
  const runtime::point eye = from(pose_.eye);
  const std::span<const listed_chunk> chunks = stream_.front().chunks();
  for (std::uint32_t i = 0; i < chunks.size(); ++i)
    if (runtime::holds(chunks[i].box, eye)) add(i, 0.0f, false);
  if (is_lost && size_ == 0)
    if (const std::uint32_t nearest = nearest_chunk(stream_, eye); nearest < chunks.size()) add(nearest, 0.0f, false);
  end_part();
}

void request_list::add_everywhere() noexcept {
  begin_part(SIGHTCELL_STREAM_FOR_ALL);
  for (const std::uint32_t page : stream_.front().pages_everywhere())
    add(stream_.front().file_of_page(page), 0.0f, false);
  for (const std::uint32_t image : stream_.front().images_everywhere()) add_first_image(image, 0.0f);
  end_part();
}

void request_list::add_pages(const chunk_cell& cell) noexcept {
  for (const listed_page& page : cell.pages) {
    const std::uint32_t file = stream_.front().file_of_page(page.page);
    if (stream_.state_of(file) != SIGHTCELL_STREAM_ABSENT) continue;
    const bool ahead =
        (page.headings & region_.headings()) != 0 && region_.may_show(stream_.front().box_of_page(page.page));
    add(file, weight_of(cell.weight, page.share), ahead);
  }
  for (const listed_image& image : cell.images) add_first_image(image.image, weight_of(cell.weight, image.share));
}

// The smallest version that has not FAILED, if the image has none and waits for none. Where an image is seen is not
// known, so it counts as ahead.
void request_list::add_first_image(std::uint32_t image, float weight) noexcept {
  const std::uint32_t begin = stream_.front().files_begin(image), end = stream_.front().files_begin(image + 1);
  std::uint32_t first = end;
  for (std::uint32_t file = end; file-- > begin;) {
    const std::uint8_t state = stream_.state_of(file);
    if (state == SIGHTCELL_STREAM_PRESENT || state == SIGHTCELL_STREAM_REQUESTED) return;
    if (state == SIGHTCELL_STREAM_ABSENT) first = file;
  }
  if (first < end) add(first, weight, true);
}

// The version after the largest one that is there or requested.
void request_list::add_larger_image(std::uint32_t image, float weight) noexcept {
  const std::uint32_t begin = stream_.front().files_begin(image), end = stream_.front().files_begin(image + 1);
  std::uint32_t larger = end;
  for (std::uint32_t file = end; file-- > begin;) {
    const std::uint8_t state = stream_.state_of(file);
    if (state == SIGHTCELL_STREAM_REQUESTED) return;
    if (state == SIGHTCELL_STREAM_PRESENT) {
      if (larger < end) add(larger, weight, true);
      return;
    }
    if (state == SIGHTCELL_STREAM_ABSENT) larger = file;
  }
}

void request_list::add_cell(const chunk_cell& cell) noexcept {
  begin_part(SIGHTCELL_STREAM_FOR_CELL);
  add_pages(cell);
  end_part();
  begin_part(SIGHTCELL_STREAM_FOR_DETAIL);
  for (const listed_image& image : cell.images) add_larger_image(image.image, weight_of(cell.weight, image.share));
  for (const std::uint32_t image : stream_.front().images_everywhere()) add_larger_image(image, 0.0f);
  end_part();
}

void request_list::add_next(double seconds) noexcept {
  const runtime::way_ahead way(from(pose_.eye), from(pose_.velocity), seconds, 0.0, walking_speed);
  const std::span<const listed_chunk> chunks = stream_.front().chunks();
  const auto chunk_count = static_cast<std::uint32_t>(chunks.size());
  // Parts: chunks that are not in memory, then cells, in the order of the chunks.
  runtime::first_wishes first;
  for (std::uint32_t i = 0; i < chunk_count; ++i) {
    runtime::wish w;
    w.part = i;
    if (!way.reaches(chunks[i].box, w)) continue;
    stream_.touch(i);
    const cell_chunk* const chunk = stream_.chunk(i);
    if (chunk == nullptr) {
      first.take(w);
      continue;
    }
    for (std::uint32_t k = 0; k < chunk->cells().size(); ++k) {
      w.part = chunk_count + chunks[i].first_cell + k;
      if (way.reaches(runtime::widened(chunk->cells()[k].box), w)) first.take(w);
    }
  }
  for (const runtime::wish& w : first.wishes()) {
    if (size_ == dst_.size()) return;
    begin_part(SIGHTCELL_STREAM_FOR_NEXT);
    if (w.part < chunk_count) {
      add(w.part, 0.0f, false);
    } else {
      const std::uint32_t cell = w.part - chunk_count;
      const auto after =
          std::upper_bound(chunks.begin(), chunks.end(), cell,
                           [](std::uint32_t value, const auto& chunk) { return value < chunk.first_cell; });
      const auto chunk = static_cast<std::uint32_t>(after - chunks.begin() - 1);
      const chunk_cell& listed = stream_.chunk(chunk)->cells()[cell - chunks[chunk].first_cell];
      stream_.touch_files_of(listed);
      add_pages(listed);
    }
    end_part();
  }
}

}  // namespace sightcell::streaming
