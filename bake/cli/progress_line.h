#pragma once
// How far a long run is: on a terminal one line that rewrites itself, else a line every few seconds, or JSON for tools.
// Everything goes to standard error.
#include <chrono>
#include <string>

#include "sightcell/bake/progress.h"

namespace sightcell::cli {

enum class progress_mode { automatic, json, none };

class progress_line {
 public:
  explicit progress_line(progress_mode mode);
  ~progress_line();  // ends an unfinished line
  progress_line(const progress_line&) = delete;
  progress_line& operator=(const progress_line&) = delete;

  void update(const bake::progress& now);                // a finished cell of a bake
  void update(std::uint32_t done, std::uint32_t total);  // a checked cell of a verification
  void message(const std::string& text);                 // a line of its own that does not tear the progress line

 private:
  using clock = std::chrono::steady_clock;

  bool due(bool last);
  void show(const std::string& text);
  void end_line();

  progress_mode mode_;
  bool terminal_;
  bool open_line_ = false;  // the terminal's cursor stands behind a progress line
  bool shown_ = false;
  clock::time_point last_shown_;
};

}  // namespace sightcell::cli
