#include "progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "console.h"
#include "number_text.h"

namespace sightcell::cli {

namespace {

constexpr std::chrono::milliseconds terminal_pause{100};
constexpr std::chrono::milliseconds log_pause{5000};  // a log is read later: few lines

}  // namespace

progress_line::progress_line(progress_mode mode) : mode_(mode), terminal_(isatty(STDERR_FILENO) == 1) {}

progress_line::~progress_line() {
  end_line();
}

bool progress_line::due(bool last) {
  if (mode_ == progress_mode::none) return false;
  const auto now = clock::now();
  if (mode_ == progress_mode::automatic && !last && shown_ &&
      now - last_shown_ < (terminal_ ? terminal_pause : log_pause))
    return false;
  shown_ = true;
  last_shown_ = now;
  return true;
}

void progress_line::update(const bake::progress& now) {
  const bool all = now.cells_done == now.cells_total;
  if (!due(now.importance > 0.0 ? now.importance == 1.0 : all && now.seconds_left == 0.0)) return;
  if (mode_ == progress_mode::json) {
    const nlohmann::ordered_json line = {{"cells", now.cells_done},
                                         {"cells_total", now.cells_total},
                                         {"cells_checked", now.cells_checked},
                                         {"target", now.target},
                                         {"prepared", now.prepared},
                                         {"importance", now.importance},
                                         {"seconds", now.seconds},
                                         {"seconds_left", now.seconds_left},
                                         {"pixel_error", now.pixel_error},
                                         {"worst_upper_bound", now.worst_bound},
                                         {"visible_set_percent", now.visible_percent}};
    say_line(line.dump());
    return;
  }
  if (now.importance > 0.0) {
    show(fmt::format("importance of polygons: {:.0f} %", 100.0 * now.importance));
    return;
  }
  std::string text = fmt::format("{} of {} cells", grouped(now.cells_done), grouped(now.cells_total));
  if (now.target > 0.0) {
    show(text + fmt::format(" ({} done), to {:.1e}, {} left, error {:.1e} (worst bound {:.1e}), {:.2f} % visible",
                            grouped(now.cells_checked), now.target, duration_text(now.seconds_left), now.pixel_error,
                            now.worst_bound, now.visible_percent));
    return;
  }
  if (all && now.seconds_left > 0.0)
    text += fmt::format(" ({} checked with their neighbors)", grouped(now.cells_checked));
  if (now.prepared < 1.0) {
    show(text + fmt::format(", {:.0f} % of the rays for all of them", 100.0 * now.prepared));
    return;
  }
  if (now.seconds_left > 0.0)
    text += fmt::format(", {:.2g} cells/s, {} left", now.cells_per_second, duration_text(now.seconds_left));
  else if (all)
    text += " in " + duration_text(now.seconds);
  text += fmt::format(", error {:.1e} (worst bound {:.1e}), {:.2f} % visible", now.pixel_error, now.worst_bound,
                      now.visible_percent);
  show(text);
}

void progress_line::update(std::uint32_t done, std::uint32_t total) {
  if (!due(done == total)) return;
  if (mode_ == progress_mode::json)
    say_line(nlohmann::ordered_json{{"cells", done}, {"cells_total", total}}.dump());
  else
    show(fmt::format("{} of {} cells checked", grouped(done), grouped(total)));
}

void progress_line::show(const std::string& text) {
  if (terminal_) {
    say("\r\033[K" + text);
    open_line_ = true;
  } else {
    say_line(text);
  }
}

void progress_line::message(const std::string& text) {
  end_line();
  say_line(text);
}

void progress_line::end_line() {
  if (open_line_) say("\n");
  open_line_ = false;
}

}  // namespace sightcell::cli
