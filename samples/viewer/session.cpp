#include "session.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "sightcell/base/error.h"
#include "start_view.h"

namespace viewer {
namespace {

using sightcell::error;
using sightcell::error_kind;

constexpr float radians = std::numbers::pi_v<float> / 180.0f;
// Linear. The cell the camera is in, the cell that is drawn when frozen, its grown box, all others.
constexpr glm::vec4 cell_color(1.0f, 0.78f, 0.05f, 1.0f), frozen_color(0.1f, 0.9f, 1.0f, 1.0f);
constexpr glm::vec4 grown_color(1.0f, 0.3f, 0.02f, 0.8f), other_color(1.0f, 1.0f, 1.0f, 0.8f);
constexpr float line_pixels = 2.0f;
constexpr float frozen_eye_size = 0.15f;                           // meters
constexpr float shortest_frustum = 4.0f, longest_frustum = 60.0f;  // meters, as it is drawn
constexpr float frustum_over_scene = 0.15f;

const cell& cell_at(const baked_scene& baked, std::uint32_t number, const char* option) {
  if (number < baked.cells.size()) return baked.cells[number];
  throw error(error_kind::wrong_use, "viewer.no-such-cell", std::string(option) + " " + std::to_string(number),
              "there are " + std::to_string(baked.cells.size()) + " cells", "count from 0");
}

// Outside of the scene, with all of it in view.
fly_camera camera_outside(const baked_scene& baked) {
  fly_camera camera;
  camera.pitch = -0.5f;
  camera.eye =
      0.5f * (baked.min + baked.max) - 0.7f * std::max(glm::distance(baked.min, baked.max), 0.1f) * camera.forward();
  return camera;
}

std::vector<glm::vec3> eyes_of(const baked_scene& baked) {
  std::vector<glm::vec3> eyes;
  for (const cell& c : baked.cells) eyes.push_back(c.eye);
  return eyes;
}

// In the cell or at the eye of the options; else in the cell of a start of the scene, or where most is in view.
fly_camera first_camera(const options& chosen, const baked_scene& baked, const loaded_scene& s,
                        const std::function<const triangle_tree&()>& tree) {
  fly_camera camera;
  std::vector<glm::vec3> eyes;
  if (chosen.eye) {
    eyes = {{(*chosen.eye)[0], (*chosen.eye)[1], (*chosen.eye)[2]}};
  } else if (chosen.cell) {
    eyes = {baked.cells[*chosen.cell].eye};
  } else if (!baked.cells.empty()) {
    eyes = eyes_of(baked);
    if (!s.facts.starts.empty()) {
      const std::array<float, 3>& start = s.facts.starts.front().position;
      eyes = {eyes[nearest_eye(eyes, {start[0], start[1], start[2]})]};
    }
  }
  if (eyes.empty()) {
    camera = camera_outside(baked);
  } else if (chosen.look || (chosen.eye && baked.cells.empty())) {
    camera.eye = eyes.front();
  } else {
    camera = best_view(tree(), eyes);
  }
  if (chosen.look) {
    camera.yaw = radians * (*chosen.look)[0];
    camera.pitch = std::clamp(radians * (*chosen.look)[1], -1.55f, 1.55f);
  }
  if (chosen.fov) camera.vertical_fov = radians * *chosen.fov;
  return camera;
}

controls first_state(const options& chosen, const baked_scene& baked) {
  controls state;
  // Where there are no cells the whole scene is before the eye: not longer than half a minute through all of it.
  if (baked.cells.empty()) state.speed = std::clamp(glm::distance(baked.min, baked.max) / 30.0f, state.speed, 1000.0f);
  state.pvs = chosen.mode != draw_mode::all;
  state.tint = chosen.mode == draw_mode::tint;
  state.objects = chosen.objects;
  state.frustum = chosen.frustum;
  state.walking = chosen.walk;
  state.frozen = chosen.frozen_from.has_value();
  if (chosen.brightness) state.brightness = *chosen.brightness;
  return state;
}

nlohmann::json bake_json(const background_bake& bake) {
  const char* const steps[] = {"idle", "running", "done", "failed", "stopped"};
  return {{"step", steps[static_cast<std::size_t>(bake.now())]},
          {"output", bake.output()},
          {"cells", bake.cells()},
          {"cells_total", bake.cells_total()},
          {"cells_shown", bake.finished().size()},
          {"error", bake.error()}};
}

}  // namespace

void check_cells(const options& chosen, const baked_scene& baked) {
  if (chosen.cell) (void)cell_at(baked, *chosen.cell, "--cell");
  if (chosen.frozen_from) (void)cell_at(baked, *chosen.frozen_from, "--frozen-from");
}

gpu_timer::gpu_timer() {
  glGenQueries(2, queries_.data());
}

gpu_timer::~gpu_timer() {
  glDeleteQueries(2, queries_.data());
}

void gpu_timer::begin() {
  const GLuint query = queries_[frame_ % 2];
  if (frame_ >= 2) {
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
    milliseconds_ = 1e-6 * static_cast<double>(nanoseconds);
  }
  glBeginQuery(GL_TIME_ELAPSED, query);
}

void gpu_timer::end() {
  glEndQuery(GL_TIME_ELAPSED);
  ++frame_;
}

void frame_rate::add(double milliseconds) {
  constexpr std::size_t most = 30;
  milliseconds_.push_back(milliseconds);
  if (milliseconds_.size() > most) milliseconds_.pop_front();
}

double frame_rate::per_second() const {
  const double sum = std::accumulate(milliseconds_.begin(), milliseconds_.end(), 0.0);
  return sum > 0.0 ? 1e3 * static_cast<double>(milliseconds_.size()) / sum : 0.0;
}

session::session(const options& chosen, const loaded_scene& s, std::unique_ptr<loaded_file> file,
                 scene_renderer& renderer, float text_scale)
    : scene_(s),
      file_(std::move(file)),
      renderer_(renderer),
      panel_(text_scale),
      state_(first_state(chosen, file_->baked)) {
  state_.camera = first_camera(chosen, baked(), s, [this]() -> const triangle_tree& { return tree(); });
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  facts_.renderer = name != nullptr ? name : "unknown";
  visited_ = chosen.cell.value_or(0);
  frozen_camera_ = state_.camera;
  was_frozen_ = state_.frozen;
  if (chosen.frozen_from) {
    frozen_camera_ = best_view(tree(), std::vector<glm::vec3>{baked().cells[*chosen.frozen_from].eye});
    frozen_camera_.vertical_fov = state_.camera.vertical_fov;
    file_->lists.move(frozen_camera_.eye, false);
  }
}

void session::took(double milliseconds) {
  rate_.add(milliseconds);
  facts_.frame_milliseconds = milliseconds;
  facts_.frames_per_second = rate_.per_second();
}

const triangle_tree& session::tree() {
  if (!tree_) tree_.emplace(scene_.world.positions, scene_.world.indices);
  return *tree_;
}

void session::go_to(const fly_camera& camera) {
  const float fov = state_.camera.vertical_fov;
  state_.camera = camera;
  state_.camera.vertical_fov = fov;
  walker_.reset();
}

void session::go_to_cell(std::uint32_t number) {
  visited_ = number;
  state_.camera.eye = baked().cells[number].eye;
  walker_.reset();
}

void session::follow() {
  if (state_.walking != was_walking_) {
    was_walking_ = state_.walking;
    walker_.reset();
  }
  if (state_.walking) {
    state_.camera.eye = walker_.move(tree(), state_.camera.eye, state_.velocity, state_.jump, state_.seconds);
  }
  if (state_.cell_steps != 0 && !baked().cells.empty()) {
    go_to_cell(cell_after(baked().cells, visited_, here().cell, state_.camera.eye, state_.cell_steps));
  }
}

chosen_lists session::lists_for(bool pvs, bool tint, const view_volume* volume) {
  return file_->lists.choose({.pvs = pvs, .objects = state_.objects, .tint = tint, .volume = volume},
                             state_.camera.eye);
}

void session::draw_scene(bool pvs, std::uint32_t width, std::uint32_t height) {
  file_->lists.move(state_.camera.eye, state_.frozen);
  const view_volume volume(state_.camera, static_cast<float>(width) / static_cast<float>(height));
  const chosen_lists chosen = lists_for(pvs, false, state_.frustum ? &volume : nullptr);
  renderer_.begin(state_.camera, state_.brightness, width, height);
  renderer_.draw(file_->groups, chosen.lists, chosen.blended, file_->lists.everything(), false);
  facts_.polygons_drawn = chosen.polygons;
  facts_.ranges_drawn = chosen.ranges;
  facts_.calls = renderer_.calls();
}

void session::brighten(std::uint32_t width, std::uint32_t height) {
  constexpr double wanted = 70.0, least = 50.0;  // mean of the bytes of a picture
  constexpr float brightest = 3.0f;
  draw_scene(true, width, height);
  const sightcell::picture::image_rgba image = renderer_.read();
  double sum = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 4) sum += std::max(image.pixels[i], image.pixels[i + 1]);
  const double mean = sum / std::max(1.0, 0.25 * static_cast<double>(image.pixels.size()));
  // Bytes are about the 2.2nd root of light.
  if (mean < least)
    state_.brightness = std::min(brightest, static_cast<float>(std::pow(wanted / std::max(mean, 1.0), 2.2)));
}

std::uint64_t session::count_wrong_pixels(std::uint32_t width, std::uint32_t height) {
  const frame_facts before = facts_;
  draw_scene(false, width, height);
  const sightcell::picture::image_rgba full = renderer_.read();
  draw_scene(true, width, height);
  const sightcell::picture::image_rgba culled = renderer_.read();
  facts_ = before;
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < full.pixels.size(); i += 4) {
    wrong += !std::equal(full.pixels.begin() + static_cast<std::ptrdiff_t>(i),
                         full.pixels.begin() + static_cast<std::ptrdiff_t>(i + 4),
                         culled.pixels.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return wrong;
}

void session::draw(std::uint32_t width, std::uint32_t height, bool whole) {
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  if (state_.frozen && !was_frozen_) frozen_camera_ = state_.camera;
  was_frozen_ = state_.frozen;
  file_->lists.move(state_.camera.eye, state_.frozen);
  facts_.wrong_pixels.reset();
  facts_.pixels = std::uint64_t{width} * height;
  if (state_.count_wrong && baked().db) facts_.wrong_pixels = count_wrong_pixels(width, height);
  const view_volume volume(state_.frozen ? frozen_camera_ : state_.camera, aspect);
  const chosen_lists chosen = lists_for(state_.pvs, state_.tint, state_.frustum ? &volume : nullptr);
  timer_.begin();
  renderer_.begin(state_.camera, state_.brightness, width, height);
  renderer_.draw(file_->groups, chosen.lists, chosen.blended, file_->lists.everything(), state_.wireframe);
  renderer_.draw_lines(lines(aspect), line_pixels);
  timer_.end();
  facts_.polygons_drawn = chosen.polygons;
  facts_.ranges_drawn = chosen.ranges;
  facts_.calls = renderer_.calls();
  facts_.gpu_milliseconds = timer_.milliseconds();
  const bool changed = here().cell != last_cell_;
  if (changed && last_cell_ != SIGHTCELL_NO_CELL) ++facts_.cell_changes;
  last_cell_ = here().cell;
  history_.add(facts_, changed);
  const fly_camera& now = state_.camera;
  still_ = now.eye == last_camera_.eye && now.yaw == last_camera_.yaw && now.pitch == last_camera_.pitch;
  last_camera_ = now;
  if (!state_.hud) {
    panel_.hide();
    return;
  }
  const auto clicked =
      panel_.draw(baked(), state_, file_->lists, facts_, history_, map_to_show(), width, height, whole);
  if (clicked) go_where_clicked(*clicked);
}

cell_map* session::map_to_show() {
  if (preview_ && preview_->map() != nullptr) return preview_->map();
  return baked().cells.empty() ? nullptr : &file_->map;
}

void session::go_where_clicked(std::uint32_t number) {
  if (map_to_show() == &file_->map) return go_to_cell(number);
  state_.camera.eye = facts_.bake->finished()[number].middle();
  walker_.reset();
}

void session::follow_bake(const background_bake& bake, bool file_exists) {
  facts_.bake = &bake;
  facts_.file_beside = file_exists;
  const bool running = bake.now() == background_bake::step::running;
  if (!running) {
    preview_.reset();
    return;
  }
  if (!preview_) preview_.emplace(scene_.world);
  preview_->update(bake.finished(), state_.camera.eye, bake.cells() == bake.cells_total());
}

void session::replace(std::unique_ptr<loaded_file> file) {
  const bool first = baked().cells.empty() && !file->baked.cells.empty();
  if (const cell_map* const before = map_to_show(); before != nullptr) file->map.color_as(*before);
  file_ = std::move(file);
  if (facts_.bake != nullptr) file_->map.take_seconds(facts_.bake->finished());
  last_cell_ = SIGHTCELL_NO_CELL;
  visited_ = 0;
  if (state_.frozen) file_->lists.move(frozen_camera_.eye, false);
  if (!first) return;
  file_->lists.move(state_.camera.eye, false);
  if (here().cell != SIGHTCELL_NO_CELL) return;
  go_to(first_camera({}, baked(), scene_, [this]() -> const triangle_tree& { return tree(); }));
}

std::vector<segment> session::lines(float aspect) const {
  std::vector<segment> out;
  if (state_.all_cells) {
    for (const cell& c : baked().cells) add_box(out, c.min, c.max, other_color);
  }
  if (state_.frozen) {
    const float reach =
        std::clamp(frustum_over_scene * glm::distance(baked().min, baked().max), shortest_frustum, longest_frustum);
    if (state_.box) add_frustum(out, frozen_camera_, aspect, reach, frozen_color);
  }
  if (!state_.box) return out;
  const auto add = [&](std::uint32_t number, const glm::vec4& color) {
    if (number >= baked().cells.size()) return;
    const cell& c = baked().cells[number];
    // Lines before the eye are in the way: the grown box is shown from outside.
    const glm::vec3 min = c.min - baked().margin, max = c.max + baked().margin, &eye = state_.camera.eye;
    const bool inside = glm::all(glm::lessThan(min, eye)) && glm::all(glm::lessThan(eye, max));
    if (!inside) add_box(out, min, max, grown_color);
    add_box(out, c.min, c.max, color);
  };
  const visible_lists& lists = file_->lists;
  if (lists.here().cell != lists.shown().cell) add(lists.here().cell, cell_color);
  add(lists.shown().cell, state_.frozen ? frozen_color : cell_color);
  if (state_.frozen)
    add_box(out, lists.shown_from() - frozen_eye_size, lists.shown_from() + frozen_eye_size, frozen_color);
  return out;
}

nlohmann::json session::report() const {
  const auto number_or_null = [](std::uint32_t cell) {
    return cell == SIGHTCELL_NO_CELL ? nlohmann::json() : nlohmann::json(cell);
  };
  const visible_lists& lists = file_->lists;
  const fly_camera& c = state_.camera;
  nlohmann::json box;
  if (here().cell < baked().cells.size()) {
    const cell& now = baked().cells[here().cell];
    box = {{now.min.x, now.min.y, now.min.z}, {now.max.x, now.max.y, now.max.z}};
  }
  return {{"polygons", baked().polygon_count},
          {"polygons_drawn", facts_.polygons_drawn},
          {"ranges", lists.range_count()},
          {"ranges_drawn", facts_.ranges_drawn},
          {"calls", facts_.calls},
          {"cell", number_or_null(lists.here().cell)},
          {"cell_box", box},
          {"shown_cell", number_or_null(lists.shown().cell)},
          {"cell_changes", facts_.cell_changes},
          {"flags", flags_text(lists.shown().flags & ~SIGHTCELL_FRAME_CHANGED)},
          {"frozen", state_.frozen},
          {"walking", state_.walking},
          {"on_floor", walker_.on_floor()},
          {"eye", {c.eye.x, c.eye.y, c.eye.z}},
          {"look", {c.yaw / radians, c.pitch / radians}},
          {"wrong_pixels", facts_.wrong_pixels ? nlohmann::json(*facts_.wrong_pixels) : nlohmann::json()},
          {"message", facts_.message},
          {"bake", facts_.bake != nullptr ? bake_json(*facts_.bake) : nlohmann::json()},
          {"cells", baked().cells.size()},
          {"cells_timed", file_->map.timed()},
          {"renderer", facts_.renderer},
          {"gpu_milliseconds", facts_.gpu_milliseconds},
          {"frames_per_second", facts_.frames_per_second},
          {"move_milliseconds", lists.move_milliseconds()},
          {"change_milliseconds", lists.change_milliseconds()}};
}

}  // namespace viewer
