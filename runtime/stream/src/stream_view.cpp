#include "stream_view.h"

#include <algorithm>
#include <limits>
#include <new>

#include "request_list.h"

namespace runtime = sightcell::runtime;
namespace streaming = sightcell::streaming;

namespace {

runtime::point eye_of(const sightcell_stream_pose& pose) noexcept {
  return {static_cast<double>(pose.eye[0]), static_cast<double>(pose.eye[1]), static_cast<double>(pose.eye[2])};
}

bool contains(const sightcell::format::box& box, const float eye[3]) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(box.min[axis] <= eye[axis] && eye[axis] < box.max[axis])) return false;
  return true;
}

// Of cells that contain the eye, whether a comes before b.
bool is_finer(const streaming::chunk_cell& a, const streaming::chunk_cell& b) noexcept {
  const double volume = runtime::volume_of(a.box), other = runtime::volume_of(b.box);
  return volume != other ? volume < other : a.number < b.number;
}

}  // namespace

std::uint64_t sightcell_stream_view::size() const noexcept {
  return sizeof(sightcell_stream_view) + std::uint64_t{4} * stream_.front().file_count();
}

sightcell_status sightcell_stream_view::create(sightcell_stream& stream, sightcell_stream_view** out) noexcept {
  const std::uint64_t size = sizeof(sightcell_stream_view) + std::uint64_t{4} * stream.front().file_count();
  void* const place = runtime::allocate(stream.allocator(), size);
  if (place == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* const made = new (place) sightcell_stream_view(stream);
  made->listed_at_ = reinterpret_cast<std::uint32_t*>(static_cast<std::byte*>(place) + sizeof(sightcell_stream_view));
  std::fill_n(made->listed_at_, stream.front().file_count(), 0u);
  stream.add(*made);
  *out = made;
  return SIGHTCELL_OK;
}

void sightcell_stream_view::destroy(sightcell_stream_view* view) noexcept {
  if (view == nullptr) return;
  sightcell_stream& stream = view->stream_;
  {
    const runtime::latch_guard guard(stream.latch());
    view->hold(view->cell_, {});
    view->hold(view->complete_, {});
  }
  stream.remove(*view);
  const std::uint64_t size = view->size();
  view->~sightcell_stream_view();
  runtime::release(stream.allocator(), view, size);
}

void sightcell_stream_view::hold(streaming::held_cell& place, const streaming::held_cell& cell) noexcept {
  if (cell.cell != nullptr) stream_.pin(cell.chunk);
  if (place.cell != nullptr) {
    stream_.touch_files_of(*place.cell);
    stream_.unpin(place.chunk);
  }
  place = cell;
}

streaming::held_cell sightcell_stream_view::find_cell(bool& may_be_elsewhere) noexcept {
  const runtime::point eye = eye_of(pose_);
  streaming::held_cell best;
  may_be_elsewhere = false;
  const std::span<const streaming::listed_chunk> chunks = stream_.front().chunks();
  for (std::uint32_t i = 0; i < chunks.size(); ++i) {
    if (!runtime::holds(chunks[i].box, eye)) continue;
    stream_.touch(i);
    const streaming::cell_chunk* const chunk = stream_.chunk(i);
    if (chunk == nullptr) {
      may_be_elsewhere |= stream_.state_of(i) != SIGHTCELL_STREAM_FAILED;
      continue;
    }
    for (const streaming::chunk_cell& cell : chunk->cells())
      if (contains(cell.box, pose_.eye) && (best.cell == nullptr || is_finer(cell, *best.cell))) best = {i, &cell};
  }
  return best;
}

streaming::held_cell sightcell_stream_view::nearest_cell() noexcept {
  const std::uint32_t nearest = streaming::nearest_chunk(stream_, eye_of(pose_));
  if (nearest == stream_.front().counts().chunks || stream_.chunk(nearest) == nullptr) return {};
  streaming::held_cell best;
  double least = std::numeric_limits<double>::infinity();
  for (const streaming::chunk_cell& cell : stream_.chunk(nearest)->cells()) {
    const double away = runtime::squared_distance(runtime::widened(cell.box), eye_of(pose_));
    if (away < least) least = away, best = {nearest, &cell};
  }
  return best;
}

void sightcell_stream_view::count_files(sightcell_stream_frame& frame) const noexcept {
  const streaming::front& front = stream_.front();
  const auto count_page = [&](std::uint32_t page) {
    const std::uint8_t state = stream_.state_of(front.file_of_page(page));
    frame.failed += state == SIGHTCELL_STREAM_FAILED;
    frame.missing += state == SIGHTCELL_STREAM_ABSENT || state == SIGHTCELL_STREAM_REQUESTED;
    return state == SIGHTCELL_STREAM_PRESENT;
  };
  for (const std::uint32_t page : front.pages_everywhere()) (void)count_page(page);
  for (const std::uint32_t image : front.images_everywhere()) frame.missing += !stream_.is_settled(image);
  if (cell_.cell == nullptr) return;
  for (const streaming::listed_page& page : cell_.cell->pages) {
    const float weight = streaming::weight_of(cell_.cell->weight, page.share);
    frame.weight += weight;
    if (count_page(page.page)) frame.weight_present += weight;
  }
  for (const streaming::listed_image& image : cell_.cell->images) frame.missing += !stream_.is_settled(image.image);
}

void sightcell_stream_view::move(const sightcell_stream_pose& pose, sightcell_stream_frame& frame) noexcept {
  pose_ = pose;
  frame = {};
  const runtime::latch_guard guard(stream_.latch());
  (void)stream_.advance();
  const streaming::held_cell cell_before = cell_, complete_before = complete_;
  bool may_be_elsewhere = false;
  streaming::held_cell found = find_cell(may_be_elsewhere);
  if (found.cell == nullptr) {
    frame.flags |= SIGHTCELL_STREAM_OUTSIDE;
    found = cell_.cell != nullptr ? cell_ : nearest_cell();
    may_be_elsewhere |= found.cell == nullptr && stream_.front().counts().chunks > 0;
  }
  if (found != cell_) hold(cell_, found);
  count_files(frame);
  if (frame.missing == 0 && cell_.cell != nullptr && complete_ != cell_) hold(complete_, cell_);
  if (!has_moved_ || cell_ != cell_before || complete_ != complete_before) frame.flags |= SIGHTCELL_STREAM_CHANGED;
  if (may_be_elsewhere) frame.flags |= SIGHTCELL_STREAM_UNKNOWN_CELL;
  if (may_be_elsewhere || frame.missing > 0) frame.flags |= SIGHTCELL_STREAM_PENDING;
  has_moved_ = true;
  frame.cell = cell_.cell != nullptr ? cell_.cell->number : SIGHTCELL_NO_CELL;
  frame.complete_cell = complete_.cell != nullptr ? complete_.cell->number : SIGHTCELL_NO_CELL;
}

std::size_t sightcell_stream_view::list_requests(double seconds, std::span<sightcell_stream_request> dst) noexcept {
  if (!has_moved_) return 0;
  if (++lists_ == 0) {  // wrapped around
    std::fill_n(listed_at_, stream_.front().file_count(), 0u);
    lists_ = 1;
  }
  const runtime::latch_guard guard(stream_.latch());
  streaming::request_list list(stream_, pose_, {listed_at_, stream_.front().file_count()}, lists_, dst);
  list.add_lookup(cell_.cell == nullptr);
  list.add_everywhere();
  if (cell_.cell != nullptr) list.add_cell(*cell_.cell);
  if (seconds > 0.0) list.add_next(seconds);
  return list.size();
}

void sightcell_stream_view::write_draws(std::uint64_t* bits) const noexcept {
  const std::span<const sightcell_stream_draw> draws = stream_.front().draws();
  std::fill_n(bits, (draws.size() + 63) / 64, std::uint64_t{0});
  const auto set = [bits](std::size_t draw) { bits[draw / 64] |= std::uint64_t{1} << draw % 64; };
  for (std::size_t i = 0; i < draws.size(); ++i)
    if ((draws[i].flags & SIGHTCELL_STREAM_ALWAYS) != 0) set(i);
  for_each_held([&](const streaming::chunk_cell& cell) {
    for (const streaming::draw_run& run : cell.runs)
      for (std::uint32_t i = 0; i < run.count; ++i) set(run.first + std::size_t{i});
  });
}
