#include "session.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>

#include "sightcell/base/error.h"

namespace stream_client {
namespace {

constexpr float vertical_fov = 1.2f;        // radians
constexpr std::size_t spare_transfers = 2;  // that wait in the queue of the network, so that a connection never does
constexpr std::chrono::milliseconds longest_wait{100}, frame_time{16}, picture_time{100};
constexpr std::chrono::seconds ahead_age{10};     // files that were loaded ahead are kept for so long
constexpr std::uint64_t bytes_per_page_byte = 8;  // in memory, before a page is decoded
constexpr std::uint32_t front_tag = 0xFFFFFFFFu;

std::uint64_t tag_of(std::uint32_t session, std::uint32_t file) {
  return std::uint64_t{session} << 32 | file;
}

bool is_gone(long http_status) {
  return http_status == 404 || http_status == 410;
}

std::vector<instance> instances_of(const sightcell_stream* stream, std::uint32_t count, std::size_t materials) {
  std::vector<sightcell_stream_draw> draws(count);
  std::size_t written = 0;
  require(sightcell_stream_draws(stream, draws.data(), draws.size(), &written), "sightcell_stream_draws");
  std::vector<instance> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const sightcell_stream_draw& d = draws[i];
    // The last one is the default material.
    out[i] = {d.geometry, std::min(d.material, static_cast<std::uint32_t>(materials - 1)), d.object, d.level, {}};
    std::copy(std::begin(d.matrix), std::end(d.matrix), std::begin(out[i].matrix));
  }
  return out;
}

std::string json_of(const sightcell_stream* stream) {
  std::size_t size = 0;
  sightcell_stream_json(stream, nullptr, 0, &size);
  std::string text(size, ' ');
  require(sightcell_stream_json(stream, text.data(), text.size(), &size), "sightcell_stream_json");
  return text;
}

}  // namespace

std::chrono::milliseconds backoff(const client_settings& settings, unsigned failures, std::uint64_t file) {
  const double spread = 0.5 + static_cast<double>(file * 2654435761u % 1024) / 1024.0;
  const double doubled = static_cast<double>(settings.first_backoff.count()) * std::exp2(std::min(failures, 16u) - 1.0);
  const double longest = static_cast<double>(settings.longest_backoff.count());
  return std::chrono::milliseconds(static_cast<long>(spread * std::min(doubled, longest)));
}

bool accepts_encoding(unsigned failures) {
  return failures % 2 == 0;
}

session::session(const shared_run& run, std::uint32_t number, stream_owner stream, std::vector<std::uint8_t> front,
                 gl_thread* device)
    : run_(run),
      number_(number),
      stream_(std::move(stream)),
      front_(std::move(front)),
      info_([this] {
        sightcell_stream_info info{};
        info.struct_size = sizeof info;
        require(sightcell_stream_describe(stream_.get(), &info), "sightcell_stream_describe");
        return info;
      }()),
      resident_(stream_.get(), run.settings.memory, [this](std::uint32_t file) { remove(file); }),
      decoders_(run.settings.decode_threads, info_.geometry_count, run.bell),
      device_(device),
      shown_((info_.draw_count + 63) / 64) {
  sightcell_stream_view* view = nullptr;
  require(sightcell_stream_view_create(stream_.get(), &view), "sightcell_stream_view_create");
  view_.reset(view);
  mark_unsupported();
  if (device_ == nullptr) return;
  std::vector<material> materials = read_materials(json_of(stream_.get()));
  std::vector<instance> instances = instances_of(stream_.get(), info_.draw_count, materials.size());
  const glm::vec3 size(info_.max[0] - info_.min[0], info_.max[1] - info_.min[1], info_.max[2] - info_.min[2]);
  device_->run([&] {
    renderer_ = std::make_unique<renderer>(device_->context(), std::move(materials), std::move(instances),
                                           info_.geometry_count, glm::length(size));
  });
}

session::~session() {
  if (device_ == nullptr) return;
  try {
    device_->run([this] { renderer_.reset(); });
  } catch (const std::exception&) {  // of a picture that nothing waits for
  }
}

sightcell_stream_file session::describe(std::uint32_t file) const {
  sightcell_stream_file out{};
  require(sightcell_stream_describe_file(stream_.get(), file, &out), "sightcell_stream_describe_file");
  return out;
}

// Images that this client has no decoder for are never requested.
void session::mark_unsupported() {
  for (std::uint32_t file = info_.file_count - info_.image_file_count; file < info_.file_count; ++file) {
    const std::uint32_t type = describe(file).image_type;
    if (type == SIGHTCELL_STREAM_PNG || type == SIGHTCELL_STREAM_JPEG || type == SIGHTCELL_STREAM_WEBP) continue;
    require(sightcell_stream_set_state(stream_.get(), file, SIGHTCELL_STREAM_FAILED), "sightcell_stream_set_state");
    ++run_.result.unsupported_images;
  }
}

std::uint64_t session::estimate(const sightcell_stream_file& file) const {
  if (file.kind == SIGHTCELL_STREAM_CHUNK) return 0;  // the library has its own limit
  if (file.kind == SIGHTCELL_STREAM_IMAGE && file.width != 0) return std::uint64_t{file.width} * file.height * 16 / 3;
  return file.size * bytes_per_page_byte;
}

std::size_t session::most_transfers() const {
  return spare_transfers + (run_.result.http2 ? run_.settings.network.streams : run_.settings.network.connections);
}

void session::start(std::uint32_t file) {
  const sightcell_stream_file what = describe(file);
  require(sightcell_stream_set_state(stream_.get(), file, SIGHTCELL_STREAM_REQUESTED), "sightcell_stream_set_state");
  resident_.expect(file, estimate(what));
  ++in_transfer_;
  ++run_.result.requests;
  const auto failed = failures_.find(file);
  if (failed != failures_.end()) ++run_.result.refetches;
  run_.log.request(run_.seconds(), what.name);
  run_.network.start({tag_of(number_, file), what.name, what.size, true,
                      accepts_encoding(failed == failures_.end() ? 0 : failed->second.count)});
}

// Waits before another attempt; the file stays REQUESTED meanwhile. After the last attempt it is FAILED.
// gone: the server does not have it.
void session::fail(std::uint32_t file, const std::string& cause, bool gone) {
  ++run_.result.errors;
  failed_attempts& attempts = failures_[file];
  ++attempts.count;
  attempts.cause = cause;
  resident_.forget(file);
  not_needed_.erase(file);
  if (attempts.count < run_.settings.attempts) {
    waiting_.emplace(clock::now() + backoff(run_.settings, attempts.count, file), file);
    return;
  }
  require(sightcell_stream_set_state(stream_.get(), file, SIGHTCELL_STREAM_FAILED), "sightcell_stream_set_state");
  changed_ = true;
  // A new front may have replaced ours, and its files ours.
  if (gone && !front_checked_) {
    front_checked_ = front_requested_ = true;
    ++run_.result.requests;
    run_.log.request(run_.seconds(), front_name);
    run_.network.start({tag_of(number_, front_tag), front_name, most_front_bytes, false, true});
  }
}

void session::save(const std::string& name, const std::vector<std::uint8_t>& bytes) const {
  if (run_.settings.save.empty()) return;
  const std::filesystem::path path = run_.settings.save / name;
  std::error_code failure;
  std::filesystem::create_directories(path.parent_path(), failure);
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) {
    throw sightcell::error(sightcell::error_kind::failed, "client.save", path.string(), "cannot be written",
                           "name another folder");
  }
}

void session::take_transfers() {
  for (transfer_result& r : run_.network.take()) {
    run_.result.bytes += r.received;
    run_.result.http2 = run_.result.http2 || r.http2;
    if (r.tag >> 32 != number_) continue;
    const auto file = static_cast<std::uint32_t>(r.tag);
    if (file == front_tag) {
      front_requested_ = false;
      front_changed_ = r.failure.empty() && r.body != front_;
      continue;
    }
    --in_transfer_;
    if (!r.failure.empty()) {
      fail(file, r.failure, is_gone(r.http_status));
      continue;
    }
    const sightcell_status status = sightcell_stream_deliver(stream_.get(), file, r.body.data(), r.body.size());
    if (status != SIGHTCELL_OK) {
      fail(file, sightcell_status_text(status), false);
      continue;
    }
    save(r.path, r.body);
    if (file < info_.chunk_count) {
      failures_.erase(file);
      not_needed_.erase(file);
      continue;
    }
    ++decoding_;
    decoders_.start({file, file < info_.chunk_count + info_.page_count, std::move(r.body)});
  }
}

void session::take_decoded() {
  for (decoded_file& decoded : decoders_.take()) {
    --decoding_;
    if (!decoded.failure.empty()) {
      // The hash is right: another transfer gives the same bytes.
      failures_[decoded.file].count = run_.settings.attempts;
      fail(decoded.file, decoded.failure, false);
      continue;
    }
    failures_.erase(decoded.file);
    not_needed_.erase(decoded.file);
    resident_.forget(decoded.file);
    resident_.make_room(decoded.bytes(), {});
    resident_.add(decoded.file, decoded.bytes());
    require(sightcell_stream_set_state(stream_.get(), decoded.file, SIGHTCELL_STREAM_PRESENT),
            "sightcell_stream_set_state");
    changed_ = true;
    show(decoded);
  }
}

void session::show(decoded_file& decoded) {
  if (decoded.polygons) {
    if (device_ == nullptr) return;
    device_->post([this, number = decoded.file - info_.chunk_count,
                   polygons = std::make_shared<const page>(std::move(*decoded.polygons))] {
      renderer_->add_page(number, *polygons);
    });
    return;
  }
  // Of the files of an image, the largest one that is there.
  const std::uint32_t image = describe(decoded.file).number;
  const auto [shown, first] = shown_file_.emplace(image, decoded.file);
  if (!first && shown->second > decoded.file) {
    resident_.add(decoded.file, 0);
    return;
  }
  if (!first && shown->second != decoded.file) resident_.add(shown->second, 0);
  shown->second = decoded.file;
  if (device_ == nullptr) return;
  device_->post(
      [this, image, pixels = std::make_shared<const sightcell::scene::image_pixels>(std::move(*decoded.pixels))] {
        renderer_->add_image(image, *pixels);
      });
}

void session::remove(std::uint32_t file) {
  changed_ = true;
  if (file < info_.chunk_count + info_.page_count) {
    if (device_ != nullptr) device_->post([this, page = file - info_.chunk_count] { renderer_->remove_page(page); });
    return;
  }
  const std::uint32_t image = describe(file).number;
  const auto shown = shown_file_.find(image);
  if (shown == shown_file_.end() || shown->second != file) return;
  shown_file_.erase(shown);
  if (device_ != nullptr) device_->post([this, image] { renderer_->remove_image(image); });
  // Smaller versions, which it has replaced, are gone too.
  std::uint32_t first_file = 0, count = 0;
  require(sightcell_stream_image_files(stream_.get(), image, &first_file, &count), "sightcell_stream_image_files");
  for (std::uint32_t other = first_file; other < file; ++other) {
    if (sightcell_stream_state(stream_.get(), other) != SIGHTCELL_STREAM_PRESENT) continue;
    require(sightcell_stream_set_state(stream_.get(), other, SIGHTCELL_STREAM_ABSENT), "sightcell_stream_set_state");
    resident_.forget(other);
  }
}

void session::release_backoffs() {
  const clock::time_point now = clock::now();
  while (!waiting_.empty() && waiting_.begin()->first <= now) {
    const std::uint32_t file = waiting_.begin()->second;
    waiting_.erase(waiting_.begin());
    require(sightcell_stream_set_state(stream_.get(), file, SIGHTCELL_STREAM_ABSENT), "sightcell_stream_set_state");
  }
}

void session::move(const walk& way, double seconds) {
  pose_ = way.at(seconds);
  const glm::vec3 up = std::abs(pose_.forward.y) > 0.99f * glm::length(pose_.forward) ? glm::vec3(0.0f, 0.0f, 1.0f)
                                                                                      : glm::vec3(0.0f, 1.0f, 0.0f);
  sightcell_stream_pose pose{};
  for (int i = 0; i < 3; ++i) {
    pose.eye[i] = pose_.eye[i];
    pose.velocity[i] = pose_.velocity[i];
    pose.forward[i] = pose_.forward[i];
    pose.up[i] = up[i];
  }
  const float half_height = std::tan(0.5f * vertical_fov);
  pose.half_height = half_height;
  pose.half_width = half_height * static_cast<float>(run_.settings.width) / static_cast<float>(run_.settings.height);
  require(sightcell_stream_view_move(view_.get(), &pose, &frame_), "sightcell_stream_view_move");
  if ((frame_.flags & SIGHTCELL_STREAM_CHANGED) != 0) {
    require(sightcell_stream_view_draws(view_.get(), shown_.data(), shown_.size()), "sightcell_stream_view_draws");
    changed_ = true;
  }
  measure(frame_);
  run_.log.frame(run_.seconds(), seconds, frame_, run_.result);
}

void session::measure(const sightcell_stream_frame& frame) {
  constexpr double rounding = 1e-6;  // of sums of floats
  report& r = run_.result;
  const double now = run_.seconds();
  if (frame.cell == SIGHTCELL_NO_CELL || (frame.flags & SIGHTCELL_STREAM_UNKNOWN_CELL) != 0) return;
  if (frame.cell != last_cell_) ++r.cells_entered;
  last_cell_ = frame.cell;
  const bool pending = (frame.flags & SIGHTCELL_STREAM_PENDING) != 0;
  if (pending && pending_since_ < 0.0) pending_since_ = now;
  if (!pending && pending_since_ >= 0.0) {
    r.pending_seconds += now - pending_since_;
    r.longest_pending = std::max(r.longest_pending, now - pending_since_);
    pending_since_ = not_reached;
  }
  if (r.first_cell == SIGHTCELL_NO_CELL) {
    r.first_cell = frame.cell;
    r.first_cell_weight = static_cast<double>(frame.weight);
  }
  if (frame.cell != r.first_cell) return;
  const auto weight = static_cast<double>(frame.weight), present = static_cast<double>(frame.weight_present);
  for (level& l : r.levels) {
    if (l.seconds >= 0.0 || present < weight * (l.percent / 100.0 - rounding)) continue;
    l.seconds = now;
    l.bytes = r.bytes;
    l.requests = r.requests;
  }
  if (!pending && r.first_cell_complete < 0.0) r.first_cell_complete = now;
}

// Cells have priority: what is loaded ahead of need, and larger images, must fit beside them. A cell that is larger
// than the limit is loaded nevertheless, but not before what it does not need has arrived, so that it can be removed.
bool session::may_load(const sightcell_stream_request& request) {
  const std::uint64_t bytes = estimate(describe(request.file));
  if (request.reason == SIGHTCELL_STREAM_FOR_NEXT) return resident_.make_room(bytes, ahead_age);
  return resident_.make_room(bytes, {}) || (request.reason <= SIGHTCELL_STREAM_FOR_CELL && not_needed_.empty());
}

// Returns whether anything is left that can be requested.
bool session::request_files(bool at_rest) {
  std::array<sightcell_stream_request, 64> wanted;
  std::size_t count = 0;
  require(sightcell_stream_view_requests(view_.get(), at_rest ? 0.0f : run_.settings.lookahead, wanted.data(),
                                         wanted.size(), &count),
          "sightcell_stream_view_requests");
  for (std::size_t i = 0; i < count; ++i) {
    if (in_transfer_ >= most_transfers()) return true;
    const bool is_needed = wanted[i].reason <= SIGHTCELL_STREAM_FOR_CELL;
    if (!may_load(wanted[i])) {
      if (is_needed) return true;
      continue;
    }
    if (!is_needed) not_needed_.insert(wanted[i].file);
    start(wanted[i].file);
  }
  return false;
}

void session::draw_if_due() {
  if (device_ == nullptr || !changed_ || drawing_ || !run_.settings.log.pictures.empty() ||
      clock::now() - last_picture_ < picture_time)
    return;
  changed_ = false;
  drawing_ = true;
  last_picture_ = clock::now();
  ++run_.result.frames_drawn;
  device_->post([this, view = camera(), shown = shown_] {
    renderer_->draw(view, run_.settings.width, run_.settings.height, shown);
    drawing_ = false;
    run_.bell.ring();
  });
}

sightcell::picture::camera session::camera() const {
  return {pose_.eye, pose_.forward, {0.0f, 1.0f, 0.0f}, vertical_fov};
}

// Where the camera waits for its cell, it does so for the larger images too, and for what is loaded ahead of need.
void session::picture_of_walk(bool loading) {
  if (device_ != nullptr && !(run_.settings.wait && loading)) run_.log.picture(picture());
}

sightcell::picture::image_rgba session::picture() {
  sightcell::picture::image_rgba drawn;
  if (device_ == nullptr) return drawn;
  changed_ = false;
  device_->run([&] {
    drawn = renderer_->draw(camera(), run_.settings.width, run_.settings.height, shown_);
    run_.result.polygons_drawn = renderer_->polygons_of_last_draw();
  });
  last_picture_ = clock::now();
  ++run_.result.frames_drawn;
  return drawn;
}

session::outcome session::run(const walk& way, double& walked) {
  constexpr std::uint32_t unfinished = SIGHTCELL_STREAM_PENDING | SIGHTCELL_STREAM_UNKNOWN_CELL;
  frame_.flags = unfinished;
  bool loading = true, due = false;
  for (clock::time_point last = clock::now();;) {
    take_transfers();
    take_decoded();
    release_backoffs();
    if (front_changed_) return outcome::new_front;
    clock::duration passed = clock::now() - last;
    last += passed;
    // Where files have failed, the cell may never be complete.
    if (run_.settings.wait && ((frame_.flags & unfinished) != 0 || due) && loading) passed = {};
    if (run_.settings.wait) passed = std::min<clock::duration>(passed, frame_time);
    walked += std::chrono::duration<double>(passed).count();
    const bool at_rest = walked >= way.seconds();
    // Pictures are of the same places in each run along the same walk.
    const double place = run_.log.next_picture();
    due = walked >= place && place <= way.seconds();
    move(way, due ? place : walked);
    loading = request_files(at_rest) || !idle();
    if (due) picture_of_walk(loading);
    if (at_rest && !loading && !due) return outcome::done;
    draw_if_due();
    clock::time_point end = clock::now() + (at_rest ? longest_wait : frame_time);
    if (!waiting_.empty()) end = std::min(end, waiting_.begin()->first);
    run_.bell.wait_until(end);
  }
}

void session::finish_report() {
  report& r = run_.result;
  if (device_ != nullptr) device_->run([&] { r.polygons_drawn = renderer_->polygons_of_last_draw(); });
  r.peak_memory = std::max(r.peak_memory, resident_.peak());
  r.removed += resident_.removed();
  r.failed.clear();
  r.present.clear();
  for (std::uint32_t file = 0; file < info_.file_count; ++file) {
    const std::uint32_t state = sightcell_stream_state(stream_.get(), file);
    if (state == SIGHTCELL_STREAM_PRESENT) r.present.emplace_back(describe(file).name);
    const auto failure = failures_.find(file);
    if (state == SIGHTCELL_STREAM_FAILED && failure != failures_.end())
      r.failed.push_back({describe(file).name, failure->second.cause});
  }
  r.complete = (frame_.flags & (SIGHTCELL_STREAM_PENDING | SIGHTCELL_STREAM_UNKNOWN_CELL)) == 0 && frame_.failed == 0;
}

}  // namespace stream_client
