#include "request_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "way_ahead.h"

namespace sightcell::streaming {
namespace {

constexpr double walking_speed = 1.5;  // meters per second: a camera that stands still may start to walk
constexpr std::uint32_t all_ahead = 64, none_ahead = 0;

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

// x and z of the unit vectors with the headings atan2(z, x) in the middle of each eighth of sectors 0 and 1.
constexpr std::array<std::array<double, 2>, 16> middles{{{0.9987954562051724, 0.0490676743274180},
                                                         {0.9891765099647810, 0.1467304744553617},
                                                         {0.9700312531945440, 0.2429801799032639},
                                                         {0.9415440651830208, 0.3368898533922201},
                                                         {0.9039892931234433, 0.4275550934302821},
                                                         {0.8577286100002721, 0.5141027441932217},
                                                         {0.8032075314806449, 0.5956993044924333},
                                                         {0.7409511253549590, 0.6715589548470183},
                                                         {0.6715589548470183, 0.7409511253549590},
                                                         {0.5956993044924333, 0.8032075314806449},
                                                         {0.5141027441932217, 0.8577286100002721},
                                                         {0.4275550934302821, 0.9039892931234433},
                                                         {0.3368898533922201, 0.9415440651830208},
                                                         {0.2429801799032639, 0.9700312531945440},
                                                         {0.1467304744553617, 0.9891765099647810},
                                                         {0.0490676743274180, 0.9987954562051724}}};

// Returns x and z of the unit vector in the middle of eighth k of all headings, 0 to 63.
std::array<double, 2> middle_of(std::size_t k) noexcept {
  const std::array<double, 2>& m = middles[k % 16];
  switch (k / 16) {
    case 0:
      return m;
    case 1:
      return {-m[1], m[0]};
    case 2:
      return {-m[0], -m[1]};
    default:
      return {m[1], -m[0]};
  }
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
  sectors_.fill(whole);
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

  look_around(forward);
}

// An eighth of a sector counts if a direction with the heading in its middle, up or down by any angle, is in the
// frustum, or if the view's own heading is in it. So a view that contains the vertical has all headings.
void view_region::look_around(const runtime::point& forward) noexcept {
  sectors_.fill(0);
  std::size_t nearest = 0;
  double most = -1.0;
  for (std::size_t k = 0; k < 64; ++k) {
    const auto [x, z] = middle_of(k);
    const double along = x * forward[0] + z * forward[2];
    if (along > most) most = along, nearest = k;
    // (x, y, z) is inside all planes for y from low to high.
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    for (const runtime::point& normal : planes_) {
      const double level = normal[0] * x + normal[2] * z;
      if (normal[1] > 0.0) low = std::max(low, -level / normal[1]);
      if (normal[1] < 0.0) high = std::min(high, -level / normal[1]);
      if (normal[1] == 0.0 && !(level > 0.0)) high = -std::numeric_limits<double>::infinity();
    }
    if (low < high) ++sectors_[k / 8];
  }
  std::uint8_t& own = sectors_[nearest / 8];
  own = std::max<std::uint8_t>(own, 1);
}

std::uint32_t view_region::share_of(std::uint8_t headings) const noexcept {
  std::uint32_t sum = 0, count = 0;
  for (std::size_t k = 0; k < sectors_.size(); ++k)
    if ((headings >> k & 1) != 0) sum += sectors_[k], ++count;
  return count == 0 ? none_ahead : sum * all_ahead / (count * whole);
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
  return static_cast<double>(request.weight) / size * std::max(request.ahead, 1u);
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
void request_list::add(std::uint32_t file, float weight, std::uint32_t ahead) noexcept {
  if (stream_.state_of(file) != SIGHTCELL_STREAM_ABSENT || listed_at_[file] == number_) return;
  listed_at_[file] = number_;
  const auto before = [this](const auto& a, const auto& b) { return is_before(a, b); };
  const sightcell_stream_request request{file, reason_, weight, ahead};
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
    if (runtime::holds(chunks[i].box, eye)) add(i, 0.0f, none_ahead);
  if (is_lost && size_ == 0)
    if (const std::uint32_t nearest = nearest_chunk(stream_, eye); nearest < chunks.size())
      add(nearest, 0.0f, none_ahead);
  end_part();
}

void request_list::add_everywhere() noexcept {
  begin_part(SIGHTCELL_STREAM_FOR_ALL);
  for (const std::uint32_t page : stream_.front().pages_everywhere())
    add(stream_.front().file_of_page(page), 0.0f, none_ahead);
  for (const std::uint32_t image : stream_.front().images_everywhere()) add_first_image(image, 0.0f);
  end_part();
}

void request_list::add_pages(const chunk_cell& cell) noexcept {
  for (const listed_page& page : cell.pages) {
    const std::uint32_t file = stream_.front().file_of_page(page.page);
    if (stream_.state_of(file) != SIGHTCELL_STREAM_ABSENT) continue;
    const bool may_show = region_.may_show(stream_.front().box_of_page(page.page));
    add(file, weight_of(cell.weight, page.share), may_show ? region_.share_of(page.headings) : none_ahead);
  }
  for (const listed_image& image : cell.images) add_first_image(image.image, weight_of(cell.weight, image.share));
}

// The smallest version that has not FAILED, if the image has none and waits for none. Where an image is seen is not
// known, so all of it counts as ahead.
void request_list::add_first_image(std::uint32_t image, float weight) noexcept {
  const std::uint32_t begin = stream_.front().files_begin(image), end = stream_.front().files_begin(image + 1);
  std::uint32_t first = end;
  for (std::uint32_t file = end; file-- > begin;) {
    const std::uint8_t state = stream_.state_of(file);
    if (state == SIGHTCELL_STREAM_PRESENT || state == SIGHTCELL_STREAM_REQUESTED) return;
    if (state == SIGHTCELL_STREAM_ABSENT) first = file;
  }
  if (first < end) add(first, weight, all_ahead);
}

// The version after the largest one that is there or requested.
void request_list::add_larger_image(std::uint32_t image, float weight) noexcept {
  const std::uint32_t begin = stream_.front().files_begin(image), end = stream_.front().files_begin(image + 1);
  std::uint32_t larger = end;
  for (std::uint32_t file = end; file-- > begin;) {
    const std::uint8_t state = stream_.state_of(file);
    if (state == SIGHTCELL_STREAM_REQUESTED) return;
    if (state == SIGHTCELL_STREAM_PRESENT) {
      if (larger < end) add(larger, weight, all_ahead);
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
      add(w.part, 0.0f, none_ahead);
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
