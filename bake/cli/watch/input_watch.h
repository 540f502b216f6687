#pragma once
// Notices that files which a bake reads were saved.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sightcell/base/disk.h"

namespace sightcell::cli {

// Watches files by the events of their folders (inotify), so that a file that is replaced by rename is noticed too, and
// compares size, time and identity of the files. Where there are no events, comparing alone notices changes: without
// inotify, on network disks, and behind symbolic links.
//
// Threads: one call at a time.
class input_watch {
 public:
  // events: false never uses inotify.
  explicit input_watch(bool events = true);
  ~input_watch();
  input_watch(const input_watch&) = delete;
  input_watch& operator=(const input_watch&) = delete;

  // Replaces the list of files. Files may be missing. What happened to files that stay in the list is kept.
  void follow(const std::vector<std::filesystem::path>& files);

  // Forgets all changes so far. To be called before the files are read.
  void settle();

  // Returns whether a file was written, replaced, removed or made since settle().
  // Cost: a system call, and three for each file, ten times per second at most.
  bool changed();

  // Waits for a change, and then until the files have been quiet for 0.3 seconds.
  // stop: called several times per second. Returns false to end the wait.
  // Returns whether there was a change; false if stop() was true.
  bool wait(const std::function<bool()>& stop);

 private:
  using clock = std::chrono::steady_clock;
  struct stamp {
    bake::file_identity identity;
    std::uintmax_t size = 0;
    std::filesystem::file_time_type time{};
    bool operator==(const stamp&) const = default;
  };
  struct watched_file {
    std::filesystem::path path;
    stamp settled;  // when settle() was called last
  };
  static stamp stamp_of(const std::filesystem::path& path);
  std::vector<stamp> stamps() const;
  bool differs() const;
  bool take_events();
  void pause(std::chrono::milliseconds longest) const;

  int events_ = -1;                                             // of inotify; -1: none
  std::vector<std::pair<int, std::filesystem::path>> folders_;  // by watch descriptor
  std::vector<watched_file> files_;
  bool changed_ = false;
  clock::time_point compared_{};
};

}  // namespace sightcell::cli
