#include "progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <stop_token>
#include <system_error>

#include "console.h"
#include "number_text.h"
#include "progress_text.h"

namespace sightcell::cli {

namespace {

constexpr std::chrono::milliseconds terminal_pause{100};
constexpr std::chrono::seconds log_pause{10};    // a log is read later: few lines
constexpr std::chrono::seconds phase_moment{2};  // a log has no line of a phase that is shorter
constexpr std::chrono::seconds tick_pause{1};
constexpr std::size_t log_columns = 1000;

}  // namespace

progress_line::progress_line(progress_mode mode) : mode_(mode), terminal_(isatty(STDERR_FILENO) == 1) {}

progress_line::~progress_line() {
  end();
}

void progress_line::loading(const std::filesystem::path& scene) {
  const std::scoped_lock lock(mutex_);
  last_.phase = bake::bake_phase::loading;
  begin("loading " + scene.filename().string(), false);
}

void progress_line::phase(bake::bake_phase phase) {
  const std::scoped_lock lock(mutex_);
  if (phase == last_.phase && !what_.empty()) return;  // the bake goes on loading
  last_.phase = phase;
  last_.slow.reset();
  begin(std::string(phase_text(phase)), is_counted(phase));
}

// Shows the phase at once on a terminal, and in a log when it has lasted for a moment.
void progress_line::begin(const std::string& what, bool is_counted) {
  what_ = what;
  counted_ = is_counted;
  shown_ = stopping_ = false;
  began_ = clock::now();
  // Tools divide by the number of cells: their first line is the first progress.
  if (mode_ == progress_mode::json && last_.cells_total > 0) print_json();
  if (mode_ != progress_mode::automatic) return;
  if (terminal_) show(text());
  if (ticker_.joinable()) return;
  try {
    ticker_ = std::jthread([this](const std::stop_token& stop) {
      std::unique_lock hold(mutex_);
      while (!wake_.wait_for(hold, stop, tick_pause, [&] { return stop.stop_requested(); })) tick();
    });
  } catch (const std::system_error&) {
    // Without another thread the line does not count seconds.
  }
}

void progress_line::tick() {
  if (what_.empty() || (counted_ && terminal_)) return;
  if (terminal_ || due()) show(text());
}

std::string progress_line::text() const {
  if (stopping_) return stopping_text(last_, width());
  if (counted_) return progress_text(last_, width());
  return waiting_text(what_, std::chrono::duration<double>(clock::now() - began_).count(), width());
}

bool progress_line::due() const {
  const auto now = clock::now();
  if (terminal_) return now - last_shown_ >= terminal_pause;
  return shown_ ? now - last_shown_ >= log_pause : now - began_ >= phase_moment;
}

std::size_t progress_line::width() const {
  return terminal_ ? terminal_columns() - 1 : log_columns;  // a full line would wrap on some terminals
}

void progress_line::update(const bake::progress& now) {
  const std::scoped_lock lock(mutex_);
  if (now.phase != last_.phase) shown_ = false, began_ = clock::now();
  last_ = now;
  what_ = phase_text(now.phase);
  counted_ = is_counted(now.phase);
  if (mode_ == progress_mode::json) print_json();
  last_.bounded = {};  // valid during this call
  if (mode_ != progress_mode::automatic || !counted_) return;
  if (is_last(now))
    keep(text());
  else if (due())
    show(text());
}

void progress_line::stopping(const bake::progress& now) {
  const std::scoped_lock lock(mutex_);
  last_ = now;
  stopping_ = counted_ = true;
  if (mode_ == progress_mode::json) print_json();
  last_.bounded = {};
  if (mode_ == progress_mode::automatic && due()) show(text());
}

void progress_line::update(std::uint32_t done, std::uint32_t total) {
  const std::scoped_lock lock(mutex_);
  what_.clear();
  const std::string checked = fmt::format("{} of {} cells checked", grouped(done), grouped(total));
  if (mode_ == progress_mode::json)
    say_line(nlohmann::ordered_json{{"cells", done}, {"cells_total", total}}.dump());
  else if (mode_ == progress_mode::automatic && done == total)
    keep(checked);
  else if (mode_ == progress_mode::automatic && due())
    show(cut_to(checked, width()));
}

void progress_line::print_json() {
  nlohmann::ordered_json slow = nullptr;
  if (last_.slow) slow = {{"cell", last_.slow->cell}, {"center", last_.slow->center}, {"seconds", last_.slow->seconds}};
  nlohmann::ordered_json bounded = nlohmann::ordered_json::array();
  for (const bake::bounded_cell& c : last_.bounded) {
    bounded.push_back({{"cell", c.cell},
                       {"min", c.min},
                       {"max", c.max},
                       {"polygons", c.polygons},
                       {"upper_bound", c.bound},
                       {"seconds", c.seconds >= 0.0 ? nlohmann::ordered_json(c.seconds) : nullptr}});
  }
  const nlohmann::ordered_json line = {{"phase", phase_name(last_.phase)},
                                       {"cells", last_.cells_done},
                                       {"cells_total", last_.cells_total},
                                       {"cells_checked", last_.cells_checked},
                                       {"cells_in_work", last_.cells_in_work},
                                       {"slow_cell", slow},
                                       {"bounded_cells", bounded},
                                       {"target", last_.target},
                                       {"prepared", last_.prepared},
                                       {"importance", last_.importance},
                                       {"seconds", last_.seconds},
                                       {"seconds_left", last_.seconds_left},
                                       {"cells_per_second", last_.cells_per_second},
                                       {"pixel_error", last_.pixel_error},
                                       {"worst_upper_bound", last_.worst_bound},
                                       {"visible_set_percent", last_.visible_percent}};
  say_line(line.dump());
}

void progress_line::show(const std::string& text) {
  shown_ = true;
  last_shown_ = clock::now();
  if (!terminal_) return say_line(text);
  line_ = text;
  say("\r\033[K" + text);
}

void progress_line::keep(const std::string& text) {
  clear();
  say_line(text);
  shown_ = true;
  last_shown_ = clock::now();
}

void progress_line::clear() {
  if (!line_.empty()) say("\r\033[K");
  line_.clear();
}

void progress_line::message(const std::string& text) {
  const std::scoped_lock lock(mutex_);
  const std::string line = line_;
  clear();
  say_line(text);
  if (!line.empty()) say(line);
  line_ = line;
}

void progress_line::end() {
  const std::scoped_lock lock(mutex_);
  clear();
  what_.clear();
}

}  // namespace sightcell::cli
