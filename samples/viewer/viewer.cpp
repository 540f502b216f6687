#include "viewer.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "background_bake.h"
#include "benchmark.h"
#include "camera_path.h"
#include "session.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/picture.h"
#include "window.h"

namespace viewer {
namespace {

namespace picture = sightcell::picture;

std::string next_screenshot_name() {
  for (int i = 1;; ++i) {
    std::string name = fmt::format("sightcell-viewer-{:03}.png", i);
    if (!std::filesystem::exists(name)) return name;
  }
}

void say(const nlohmann::json& facts) {
  fmt::print("{}\n", facts.dump());
  std::fflush(stdout);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Frame by frame along a recorded path, never faster than it was recorded.
class replay {
 public:
  explicit replay(std::vector<path_pose> path) : path_(std::move(path)) {}
  bool running() const { return next_ < path_.size(); }

  // Returns true once, when the last pose was drawn.
  bool ended() {
    const bool now = next_ == path_.size() && !path_.empty() && !told_;
    told_ |= now;
    return now;
  }
  void follow(session& s) {
    if (!running() || seconds_since(start_) < path_[next_].seconds - path_.front().seconds) return;
    s.go_to(path_[next_++].camera);
  }

 private:
  std::vector<path_pose> path_;
  std::size_t next_ = 0;
  bool told_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// The .pvs file of the window: one that is named and may change, or one that is baked or opened later.
class file_of_window {
 public:
  // References must outlive the object. A bake of the options begins at once.
  file_of_window(const options& chosen, const loaded_scene& loaded)
      : loaded_(loaded),
        scene_file_(chosen.scene_file),
        scene_number_(chosen.scene),
        pvs_file_(chosen.pvs_file),
        cells_file_(chosen.cells_file),
        watch_(chosen.pvs_file) {
    if (!chosen.pvs_file.empty()) return;
    bake_.emplace(bake_command{chosen.scene_file, chosen.scene, chosen.cells_file, file_beside(chosen.scene_file)});
    if (!chosen.bake.empty()) bake_->start(chosen.bake);
  }

  // After each frame: does what the panel asks for, and reads the file again when it has changed.
  void follow(session& s) {
    if (watch_.changed()) read(s);
    if (!bake_) return;
    const controls& asked = s.state();
    if (asked.bake_quality != nullptr) bake_->start(asked.bake_quality);
    if (asked.stop_bake) bake_->stop();
    if (bake_->poll() || asked.open_file) {
      pvs_file_ = bake_->output();
      watch_ = file_watch(pvs_file_);
      read(s);
    }
    s.follow_bake(*bake_, output_exists());
  }

  // What is to be shown in place of the scene of now: the scene has been edited, and the .pvs file is of that version.
  std::optional<opened_scene>& next() { return next_; }

 private:
  // A broken file is named, and the old one stays.
  void read(session& s) {
    try {
      if (std::optional<baked_scene> baked = opened()) {
        s.replace(std::make_unique<loaded_file>(loaded_, std::move(*baked)));
        fmt::print(stderr, "sightcell-viewer: {} was read: {} cells\n", pvs_file_, s.baked().cells.size());
      } else {
        next_ = open_scene(scene_file_, scene_number_, pvs_file_, cells_file_);
        fmt::print(stderr, "sightcell-viewer: {} and {} were read: {} cells\n", scene_file_, pvs_file_,
                   next_->baked.cells.size());
      }
      s.show_message("");
    } catch (const sightcell::error& e) {
      s.show_message(std::string(e.what()) + "; the old file is kept");
      fmt::print(stderr, "sightcell-viewer: {}; the old file is kept\n", e.what());
    }
  }

  // Returns nothing if the file is of another version of the scene.
  std::optional<baked_scene> opened() const {
    try {
      return open_baked(loaded_.facts, loaded_.world, pvs_file_, cells_file_);
    } catch (const sightcell::error& e) {
      if (e.id() != other_scene) throw;
      return std::nullopt;
    }
  }

  // Asks the file system once per second at most.
  bool output_exists() {
    const auto now = std::chrono::steady_clock::now();
    if (now - asked_ < std::chrono::seconds(1)) return exists_;
    asked_ = now;
    std::error_code ignored;
    exists_ = std::filesystem::exists(bake_->output(), ignored);
    return exists_;
  }

  const loaded_scene& loaded_;
  std::string scene_file_;
  int scene_number_;
  std::string pvs_file_, cells_file_;
  std::optional<opened_scene> next_;
  file_watch watch_;
  std::optional<background_bake> bake_;
  std::chrono::steady_clock::time_point asked_{};
  bool exists_ = false;
};

void answer_requests(session& s, const scene_renderer& renderer) {
  if (s.state().screenshot) {
    const std::string name = next_screenshot_name();
    picture::write_png(name, renderer.read());
    fmt::print("{}\n", name);
    std::fflush(stdout);
  }
  if (s.state().print) say(s.report());
}

volatile std::sig_atomic_t asked_to_end = 0;

// Lets signals end the window as its user would, so that a bake of it ends too.
void take_signals() {
  for (const int one : {SIGINT, SIGTERM, SIGHUP}) std::signal(one, [](int) { asked_to_end = 1; });
}

// How long a still picture waits for an event, in seconds. A frame of a software rasterizer takes the processor from
// the bake that its panel shows, so that pictures are drawn for a fifth of the time at most, but one per second.
double rest_after(double frame_seconds) {
  return std::clamp(4.0 * frame_seconds, 0.03, 1.0);
}

// What follows the camera or leads it, over all versions of a scene.
struct flight {
  flight(const options& chosen, const std::vector<path_pose>& path) : recorded(path), note(chosen.camera_file) {
    if (!chosen.record.empty()) recorder.emplace(chosen.record);
  }

  replay recorded;
  std::optional<path_recorder> recorder;
  camera_note note;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

// Flies until the window is closed, or the file has the next version of the scene.
void fly(session& s, window& w, const scene_renderer& renderer, file_of_window& file, flight& with) {
  w.set_taken([&s](const glm::vec2& pixel) { return s.over().covers(pixel); });
  file.follow(s);
  take_signals();
  double frame_seconds = 0.0;
  while (!w.closing() && asked_to_end == 0 && !file.next()) {
    const input in = w.poll(s.still() && !with.recorded.running() ? rest_after(frame_seconds) : 0.0);
    const auto begun = std::chrono::steady_clock::now();
    step(s.state(), in);
    s.over().take_input(in);
    if (s.state().quit) break;
    w.set_mouse_look(s.state().mouse_look);
    s.follow();
    with.recorded.follow(s);
    const std::uint32_t width = w.width(), height = w.height();
    if (width == 0 || height == 0) continue;  // minimised
    if (with.recorder) with.recorder->add(seconds_since(with.start), s.state().camera);
    with.note.follow(s.state().camera);
    s.draw(width, height, false);
    answer_requests(s, renderer);
    file.follow(s);
    if (with.recorded.ended()) say(s.report());
    renderer.show_in_window();
    w.present();
    check_gl("drawing");
    frame_seconds = seconds_since(begun);
    s.took(1e3 * frame_seconds);
  }
  if (!with.recorder || file.next()) return;
  with.recorder->finish();
  nlohmann::json facts = s.report();
  facts["recorded"] = with.recorder->poses();
  say(facts);
}

void take_screenshot(session& s, const scene_renderer& renderer, const options& chosen) {
  controls& state = s.state();
  state.hud = chosen.hud;
  state.map = chosen.map;
  state.box = chosen.box;
  state.all_cells = chosen.all_cells;
  state.wireframe = chosen.wireframe;
  state.count_wrong = chosen.wrong;
  for (std::uint32_t i = 0; i < chosen.frames; ++i) {
    const auto begun = std::chrono::steady_clock::now();
    s.draw(chosen.width, chosen.height, true);
    glFinish();
    s.took(1e3 * seconds_since(begun));
  }
  check_gl("drawing");
  picture::write_png(chosen.screenshot, renderer.read());
  say(s.report());
}

void drop_what_is_on_the_device(loaded_scene& loaded) {
  loaded.facts.images = {};
  loaded.facts.geometries = {};
  loaded.world.masked = {};
  loaded.world.masks = {};
  loaded.world.opacity = {};
}

// Shows a version of the scene. Returns the next one; nothing if the window is closed or was none.
// path: of a benchmark or replay. state: of the version before; receives that of this one.
std::optional<opened_scene> show(const options& chosen, opened_scene now, const std::vector<path_pose>& path, window& w,
                                 flight& with, std::optional<controls>& state) {
  loaded_scene& loaded = *now.scene;
  scene_renderer renderer(loaded.facts, loaded.world);
  drop_what_is_on_the_device(loaded);
  file_of_window file(chosen, loaded);
  options of_version = chosen;
  if (state) {  // cells have other numbers
    of_version.eye = {state->camera.eye.x, state->camera.eye.y, state->camera.eye.z};
    of_version.cell.reset();
    of_version.frozen_from.reset();
    state->frozen = false;
  }
  const bool flying = chosen.screenshot.empty() && chosen.benchmark.empty();
  session s(of_version, loaded, std::make_unique<loaded_file>(loaded, std::move(now.baked)), renderer,
            flying ? w.scale() : 1.0f);
  if (!chosen.benchmark.empty()) {
    run_benchmark(s, chosen.poses > 0 ? thinned(path, chosen.poses) : path, chosen);
  } else if (!flying) {
    take_screenshot(s, renderer, chosen);
  } else {
    if (state)
      s.state() = *state;
    else if (!chosen.brightness)
      s.brighten(w.width(), w.height());
    fly(s, w, renderer, file, with);
    state = s.state();
  }
  return std::move(file.next());
}

}  // namespace

void run(const options& chosen) {
  // Before the window: a file that is broken needs no display to be named.
  std::optional<opened_scene> now = open_scene(chosen.scene_file, chosen.scene, chosen.pvs_file, chosen.cells_file);
  check_cells(chosen, now->baked);
  const std::vector<path_pose> path = chosen.replay.empty() ? std::vector<path_pose>() : read_path(chosen.replay);
  window w(now->scene->facts.name + " - Sightcell", chosen.width, chosen.height,
           chosen.screenshot.empty() && chosen.benchmark.empty());
  flight with(chosen, path);
  std::optional<controls> state;
  while (now) now = show(chosen, std::move(*now), path, w, with, state);
}

}  // namespace viewer
