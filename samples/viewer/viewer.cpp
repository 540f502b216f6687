#include "viewer.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <filesystem>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "baked_scene.h"
#include "controls.h"
#include "draw_lists.h"
#include "hud.h"
#include "scene_renderer.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/picture.h"
#include "visible_lists.h"
#include "window.h"

namespace viewer {
namespace {

namespace picture = sightcell::picture;
namespace scene = sightcell::scene;
using sightcell::error;
using sightcell::error_kind;

constexpr float radians = std::numbers::pi_v<float> / 180.0f;
// Linear. The cell the camera is in, the cell that is drawn when frozen, its grown box, all others.
constexpr glm::vec4 cell_color(1.0f, 0.78f, 0.05f, 1.0f), frozen_color(0.1f, 0.9f, 1.0f, 1.0f);
constexpr glm::vec4 grown_color(1.0f, 0.3f, 0.02f, 0.8f), other_color(1.0f, 1.0f, 1.0f, 0.8f);
constexpr float line_pixels = 2.0f;
constexpr float frozen_eye_size = 0.15f;  // meters

// GPU time of the scene, known two frames later: nobody waits for it.
class gpu_timer {
 public:
  gpu_timer() { glGenQueries(2, queries_.data()); }
  ~gpu_timer() { glDeleteQueries(2, queries_.data()); }
  gpu_timer(const gpu_timer&) = delete;
  gpu_timer& operator=(const gpu_timer&) = delete;

  void begin() {
    const GLuint query = queries_[frame_ % 2];
    if (frame_ >= 2) {
      GLuint64 nanoseconds = 0;
      glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
      milliseconds_ = 1e-6 * static_cast<double>(nanoseconds);
    }
    glBeginQuery(GL_TIME_ELAPSED, query);
  }
  void end() {
    glEndQuery(GL_TIME_ELAPSED);
    ++frame_;
  }
  double milliseconds() const { return milliseconds_; }

 private:
  std::array<GLuint, 2> queries_{};
  std::size_t frame_ = 0;
  double milliseconds_ = 0.0;
};

class frame_rate {
 public:
  void tick() {
    const auto now = std::chrono::steady_clock::now();
    times_.push_back(now);
    while (times_.size() > 2 && now - times_.front() > std::chrono::seconds(1)) times_.pop_front();
  }
  double per_second() const {
    if (times_.size() < 2) return 0.0;
    const double seconds = std::chrono::duration<double>(times_.back() - times_.front()).count();
    return seconds > 0.0 ? static_cast<double>(times_.size() - 1) / seconds : 0.0;
  }

 private:
  std::deque<std::chrono::steady_clock::time_point> times_;
};

const cell& cell_at(const baked_scene& baked, std::uint32_t number, const char* option) {
  if (number < baked.cells.size()) return baked.cells[number];
  throw error(error_kind::wrong_use, "viewer.no-such-cell", std::string(option) + " " + std::to_string(number),
              "there are " + std::to_string(baked.cells.size()) + " cells", "count from 0");
}

// In the named cell, else the first one, else outside of the scene, looking at it.
fly_camera first_camera(const options& chosen, const baked_scene& baked) {
  fly_camera camera;
  if (chosen.cell) {
    camera.eye = cell_at(baked, *chosen.cell, "--cell").eye;
  } else if (!baked.cells.empty()) {
    camera.eye = baked.cells[0].eye;
  } else {
    const float reach = std::max(glm::distance(baked.min, baked.max), 0.1f);
    camera.pitch = -0.5f;
    camera.eye = 0.5f * (baked.min + baked.max) - 0.7f * reach * camera.forward();
  }
  if (chosen.eye) camera.eye = {(*chosen.eye)[0], (*chosen.eye)[1], (*chosen.eye)[2]};
  if (chosen.look) {
    camera.yaw = radians * (*chosen.look)[0];
    camera.pitch = std::clamp(radians * (*chosen.look)[1], -1.55f, 1.55f);
  }
  return camera;
}

controls first_state(const options& chosen, const baked_scene& baked) {
  controls state;
  state.camera = first_camera(chosen, baked);
  // Where there are no cells the whole scene is before the eye: not longer than half a minute through all of it.
  if (baked.cells.empty()) state.speed = std::clamp(glm::distance(baked.min, baked.max) / 30.0f, state.speed, 1000.0f);
  state.pvs = chosen.mode != draw_mode::all;
  state.tint = chosen.mode == draw_mode::tint;
  state.frozen = chosen.frozen_from.has_value();
  if (state.frozen) (void)cell_at(baked, *chosen.frozen_from, "--frozen-from");
  return state;
}

class session {
 public:
  session(const options& chosen, const controls& start, const baked_scene& baked, const draw_groups& groups,
          scene_renderer& renderer, float text_scale)
      : baked_(baked), renderer_(renderer), lists_(baked, groups), hud_(text_scale), state_(start) {
    const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    facts_.renderer = name != nullptr ? name : "unknown";
    visited_ = chosen.cell.value_or(0);
    if (chosen.frozen_from) lists_.move(baked.cells[*chosen.frozen_from].eye, false);
  }

  controls& state() { return state_; }

  void teleport() {
    if (state_.cell_steps == 0 || baked_.cells.empty()) return;
    visited_ = cell_after(baked_.cells, visited_, lists_.here().cell, state_.camera.eye, state_.cell_steps);
    state_.camera.eye = baked_.cells[visited_].eye;
  }

  void draw(std::uint32_t width, std::uint32_t height) {
    lists_.move(state_.camera.eye, state_.frozen);
    const std::vector<painted_list> lists = lists_.lists(state_.pvs, state_.tint);
    timer_.begin();
    renderer_.begin(state_.camera, width, height);
    renderer_.draw(lists, state_.wireframe);
    renderer_.draw_outlines(outlines(), line_pixels);
    timer_.end();
    facts_.polygons_drawn = lists.front().list->polygons();
    facts_.gpu_milliseconds = timer_.milliseconds();
    rate_.tick();
    facts_.frames_per_second = rate_.per_second();
    if (state_.hud) hud_.draw(baked_, state_, lists_, facts_, width, height);
  }

  nlohmann::json facts() const {
    const auto number_or_null = [](std::uint32_t cell) {
      return cell == SIGHTCELL_NO_CELL ? nlohmann::json() : nlohmann::json(cell);
    };
    return {{"polygons", baked_.polygon_count},
            {"polygons_drawn", facts_.polygons_drawn},
            {"ranges", lists_.range_count()},
            {"cell", number_or_null(lists_.here().cell)},
            {"shown_cell", number_or_null(lists_.shown().cell)},
            {"flags", flags_text(lists_.shown().flags & ~SIGHTCELL_FRAME_CHANGED)},
            {"frozen", state_.frozen},
            {"cells", baked_.cells.size()},
            {"renderer", facts_.renderer},
            {"gpu_milliseconds", facts_.gpu_milliseconds},
            {"frames_per_second", facts_.frames_per_second},
            {"move_milliseconds", lists_.move_milliseconds()},
            {"change_milliseconds", lists_.change_milliseconds()}};
  }

 private:
  std::vector<outline> outlines() const {
    std::vector<outline> out;
    if (state_.all_cells) {
      for (const cell& c : baked_.cells) out.push_back({c.min, c.max, other_color});
    }
    if (!state_.box) return out;
    const auto add = [&](std::uint32_t number, const glm::vec4& color) {
      if (number >= baked_.cells.size()) return;
      const cell& c = baked_.cells[number];
      out.push_back({c.min - baked_.margin, c.max + baked_.margin, grown_color});
      out.push_back({c.min, c.max, color});
    };
    if (lists_.here().cell != lists_.shown().cell) add(lists_.here().cell, cell_color);
    add(lists_.shown().cell, state_.frozen ? frozen_color : cell_color);
    if (state_.frozen) {
      out.push_back({lists_.shown_from() - frozen_eye_size, lists_.shown_from() + frozen_eye_size, frozen_color});
    }
    return out;
  }

  const baked_scene& baked_;
  scene_renderer& renderer_;
  visible_lists lists_;
  hud hud_;
  controls state_;
  gpu_timer timer_;
  frame_rate rate_;
  frame_facts facts_;
  std::uint32_t visited_ = 0;
};

std::string next_screenshot_name() {
  for (int i = 1;; ++i) {
    std::string name = fmt::format("sightcell-viewer-{:03}.png", i);
    if (!std::filesystem::exists(name)) return name;
  }
}

void fly(session& s, window& w, const scene_renderer& renderer) {
  while (!w.closing()) {
    step(s.state(), w.poll());
    if (s.state().quit) return;
    s.teleport();
    const std::uint32_t width = w.width(), height = w.height();
    if (width == 0 || height == 0) continue;  // minimised
    s.draw(width, height);
    if (s.state().screenshot) {
      const std::string name = next_screenshot_name();
      picture::write_png(name, renderer.read());
      fmt::print("{}\n", name);
      std::fflush(stdout);
    }
    renderer.show_in_window();
    w.present();
    check_gl("drawing");
  }
}

void take_screenshot(session& s, const scene_renderer& renderer, const options& chosen) {
  controls& state = s.state();
  state.hud = chosen.hud;
  state.box = chosen.box;
  state.all_cells = chosen.all_cells;
  state.wireframe = chosen.wireframe;
  for (std::uint32_t i = 0; i < chosen.frames; ++i) {
    s.draw(chosen.width, chosen.height);
    glFinish();
  }
  check_gl("drawing");
  picture::write_png(chosen.screenshot, renderer.read());
  fmt::print("{}\n", s.facts().dump());
}

}  // namespace

void run(const options& chosen) {
  scene::scene s = scene::load_gltf(chosen.scene_file, chosen.scene);
  scene::world_geometry world = scene::flatten(s);
  const baked_scene baked = open_baked(s, world, chosen.pvs_file, chosen.cells_file);
  const draw_groups groups(s, baked.draws);
  const controls start = first_state(chosen, baked);
  const bool flying = chosen.screenshot.empty();
  window w(s.name + " - Sightcell", chosen.width, chosen.height, flying);
  scene_renderer renderer(s, world, groups);
  // All that is drawn lies on the device now, but for the index lists.
  s = {};
  world = {};
  session now(chosen, start, baked, groups, renderer, flying ? w.scale() : 1.0f);
  if (flying) {
    fly(now, w, renderer);
  } else {
    take_screenshot(now, renderer, chosen);
  }
}

}  // namespace viewer
