#include "measurement.h"

#include <algorithm>
#include <cmath>

#include "cpu_time.h"

namespace gpu_driven {
namespace {

// The PVS comes first, because its bits are needed to count those of the other modes.
constexpr std::array order = {draw_mode::pvs,      draw_mode::frustum,      draw_mode::last_frame,
                              draw_mode::two_pass, draw_mode::pvs_two_pass, draw_mode::leaves};

void add(section& to, const std::array<tally, mode_count>& counted) {
  ++to.frames;
  const tally& any = counted[static_cast<std::size_t>(draw_mode::frustum)];
  to.seen += any.seen;
  to.seen_in_set += any.seen_in_set;
  for (std::size_t m = 0; m < mode_count; ++m) {
    mode_sums& sums = to.modes[m];
    const tally& own = counted[m];
    sums.clusters += own.clusters;
    sums.triangles += own.triangles;
    sums.clusters_in_set += own.clusters_in_set;
    sums.missed += own.missed;
    sums.missed_with_wrong += own.missed_with_wrong;
    sums.wrong_pixels += own.wrong_pixels;
    sums.ties += own.ties;
    sums.differing += own.differing;
    sums.difference += own.difference / (3.0 * 255.0);
    sums.most_wrong_pixels = std::max<std::uint64_t>(sums.most_wrong_pixels, own.wrong_pixels);
  }
}

std::vector<float> bounds_of(const sightcell::db& db) {
  std::vector<float> out(db.cell_count(), 0.0f);
  const sightcell::list_result got = db.error_bounds(out);
  if (got.status != SIGHTCELL_OK) std::fill(out.begin(), out.end(), 0.0f);
  return out;
}

}  // namespace

double section::beyond_bound(draw_mode mode) const {
  const auto wrong = static_cast<double>(modes[static_cast<std::size_t>(mode)].wrong_pixels);
  return std::max(0.0, wrong - std::ceil(allowed_pixels));
}

measurement::measurement(const sightcell::db& db, const std::string& file, const sightcell::scene::scene& s,
                         const host_scene& host, const renderer::settings& wanted, std::uint32_t leave_out)
    : bounds_(bounds_of(db)),
      renderer_(s, host, wanted),
      for_pvs_(db, file, host, leave_out),
      for_both_(db, file, host, leave_out),
      comparison_(host, renderer_) {
  for (timer& t : timers_) glCreateQueries(GL_TIMESTAMP, 2, t.queries);
}

measurement::~measurement() {
  for (const timer& t : timers_) glDeleteQueries(2, t.queries);
}

visibility* measurement::visible_in(draw_mode mode) {
  if (mode == draw_mode::pvs) return &for_pvs_;
  return mode == draw_mode::pvs_two_pass ? &for_both_ : nullptr;
}

void measurement::draw_mode_timed(draw_mode mode, const camera& view) {
  timer& own = timers_[static_cast<std::size_t>(mode)];
  glQueryCounter(own.queries[0], GL_TIMESTAMP);
  const double begin = thread_milliseconds();
  visibility* const visible = visible_in(mode);
  if (visible != nullptr) cell_ = visible->move(view.eye).cell;
  renderer_.draw(mode, visible);
  own.host_milliseconds = thread_milliseconds() - begin;
  glQueryCounter(own.queries[1], GL_TIMESTAMP);
}

// is_same_view: as in the frame before, so its picture of everything can stay.
void measurement::draw_frame(const tour_frame& frame, bool is_same_view) {
  const bool is_measured = frame.kind != frame_kind::unmeasured;
  renderer_.begin(frame.view);
  if (is_measured && !is_same_view) draw_mode_timed(draw_mode::everything, frame.view);
  if (is_measured) comparison_.begin_frame();
  if (is_measured && renderer_.has_levels()) comparison_.add(draw_mode::everything, for_pvs_.bits());  // counts the cut
  for (const draw_mode mode : order) {
    if (!renderer_.draws(mode)) continue;
    draw_mode_timed(mode, frame.view);
    if (is_measured) comparison_.add(mode, for_pvs_.bits());
  }
}

void measurement::collect(const tour_frame& frame, sections& out) {
  const std::array<tally, mode_count> counted = comparison_.read();  // waits, so all queries have results
  std::vector<section*> into;
  if (frame.kind == frame_kind::cut) into = {&out.cuts};
  if (frame.kind == frame_kind::settled) into = {&out.settled};
  if (frame.kind == frame_kind::walk) into = {&out.walk};
  if (frame.kind == frame_kind::turn) into = {&out.walk, &out.turns};
  const double pixels = double{static_cast<double>(renderer_.size().width)} * renderer_.size().height;
  for (section* to : into) {
    add(*to, counted);
    to->allowed_pixels += cell_ < bounds_.size() ? pixels * static_cast<double>(bounds_[cell_]) : 0.0;
    for (std::size_t m = 0; m < mode_count; ++m) {
      if (!renderer_.draws(static_cast<draw_mode>(m))) continue;
      GLuint64 begin = 0, end = 0;
      glGetQueryObjectui64v(timers_[m].queries[0], GL_QUERY_RESULT, &begin);
      glGetQueryObjectui64v(timers_[m].queries[1], GL_QUERY_RESULT, &end);
      to->modes[m].device_milliseconds += 1e-6 * static_cast<double>(end - begin);
      to->modes[m].host_milliseconds += timers_[m].host_milliseconds;
    }
  }
}

void measurement::run(std::span<const tour_frame> tour, sections& out) {
  if (tour.empty()) return;
  // Drivers compile at the first use.
  draw_frame({tour.front().view, frame_kind::walk}, false);
  static_cast<void>(comparison_.read());
  bool has_full = false;  // of the view of the last frame
  for (std::size_t i = 0; i < tour.size(); ++i) {
    const bool is_same = i > 0 && tour[i].view.eye == tour[i - 1].view.eye && tour[i].view.yaw == tour[i - 1].view.yaw;
    has_full = has_full && is_same;
    draw_frame(tour[i], has_full);
    if (tour[i].kind == frame_kind::unmeasured) continue;
    has_full = true;
    collect(tour[i], out);
  }
}

void measurement::draw(const camera& view, draw_mode mode) {
  for (int i = 0; i < 3; ++i) {  // modes with a history have one then
    renderer_.begin(view);
    draw_mode_timed(mode, view);
  }
}

}  // namespace gpu_driven
