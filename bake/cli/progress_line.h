#pragma once
// How far a long run is: on a terminal one line that rewrites itself; elsewhere a line every ten seconds, or JSON for
// tools. Everything goes to standard error.
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "sightcell/bake/progress.h"

namespace sightcell::cli {

enum class progress_mode { automatic, json, none };

// Threads: one call at a time. A thread of its own shows that time passes while work is not counted.
class progress_line {
 public:
  explicit progress_line(progress_mode mode);
  ~progress_line();  // clears the line
  progress_line(const progress_line&) = delete;
  progress_line& operator=(const progress_line&) = delete;

  void loading(const std::filesystem::path& scene);
  void phase(bake::bake_phase phase);                    // a phase of a bake begins
  void update(const bake::progress& now);                // progress of a bake
  void stopping(const bake::progress& now);              // the same after the user asked it to stop
  void update(std::uint32_t done, std::uint32_t total);  // a checked cell of a verification
  void message(const std::string& text);                 // a line of its own that does not tear the progress line
  void end();                                            // clears the line: only messages follow

 private:
  using clock = std::chrono::steady_clock;

  void begin(const std::string& what, bool is_counted);
  bool due() const;
  std::size_t width() const;
  std::string text() const;
  void show(const std::string& text);
  void keep(const std::string& text);
  void clear();
  void print_json();
  void tick();

  const progress_mode mode_;
  const bool terminal_;
  std::mutex mutex_;         // of all below
  bake::progress last_;      // with the current phase
  std::string what_;         // the current phase, or what it loads
  bool stopping_ = false;    // the user asked for it
  bool counted_ = false;     // reports follow, so that no seconds are counted here
  bool shown_ = false;       // in this phase
  std::string line_;         // on the terminal; the cursor is behind it
  clock::time_point began_;  // of the phase
  clock::time_point last_shown_;
  std::condition_variable_any wake_;
  std::jthread ticker_;  // last: it ends before the others do
};

}  // namespace sightcell::cli
