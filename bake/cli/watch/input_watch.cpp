#include "watch/input_watch.h"

#include <algorithm>
#include <array>
#include <system_error>
#include <thread>

#if __has_include(<sys/inotify.h>)
#define SIGHTCELL_HAS_INOTIFY
#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>
#endif

namespace sightcell::cli {
namespace {

constexpr std::chrono::milliseconds quiet_time{300};
constexpr std::chrono::milliseconds between_comparisons{100};
constexpr std::chrono::milliseconds idle_pause{200};
constexpr std::chrono::milliseconds quiet_pause{50};

}  // namespace

input_watch::input_watch([[maybe_unused]] bool events) {
#if defined(SIGHTCELL_HAS_INOTIFY)
  if (events) events_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
#endif
}

input_watch::~input_watch() {
#if defined(SIGHTCELL_HAS_INOTIFY)
  if (events_ >= 0) close(events_);
#endif
}

input_watch::stamp input_watch::stamp_of(const std::filesystem::path& path) {
  std::error_code no_size, no_time;
  stamp now{bake::identity_of(path), std::filesystem::file_size(path, no_size),
            std::filesystem::last_write_time(path, no_time)};
  if (no_size) now.size = 0;
  if (no_time) now.time = {};
  return now;
}

void input_watch::follow(const std::vector<std::filesystem::path>& files) {
  changed_ = take_events() || changed_;  // those so far are of the files of the old list
  std::vector<watched_file> next;
  for (const std::filesystem::path& path : files) {
    const auto is_this = [&](const watched_file& one) { return one.path == path; };
    if (std::any_of(next.begin(), next.end(), is_this)) continue;
    const auto known = std::find_if(files_.begin(), files_.end(), is_this);
    next.push_back(known != files_.end() ? *known : watched_file{path, stamp_of(path)});
  }
  files_ = std::move(next);
#if defined(SIGHTCELL_HAS_INOTIFY)
  if (events_ < 0) return;
  // A folder that is watched already keeps its number. Folders of files that are no longer in the list stay: their
  // events have names that nobody asks for.
  for (const watched_file& file : files_) {
    const std::filesystem::path folder = bake::folder_of(file.path);
    const int number = inotify_add_watch(
        events_, folder.c_str(),
        IN_MODIFY | IN_CLOSE_WRITE | IN_MOVED_TO | IN_MOVED_FROM | IN_CREATE | IN_DELETE | IN_ATTRIB | IN_ONLYDIR);
    const auto is_this = [&](const auto& one) { return one.first == number && one.second == folder; };
    if (number >= 0 && std::none_of(folders_.begin(), folders_.end(), is_this)) folders_.emplace_back(number, folder);
  }
#endif
}

void input_watch::settle() {
  take_events();
  changed_ = false;
  for (watched_file& file : files_) file.settled = stamp_of(file.path);
}

std::vector<input_watch::stamp> input_watch::stamps() const {
  std::vector<stamp> now;
  for (const watched_file& file : files_) now.push_back(stamp_of(file.path));
  return now;
}

bool input_watch::differs() const {
  return std::any_of(files_.begin(), files_.end(),
                     [](const watched_file& file) { return !(stamp_of(file.path) == file.settled); });
}

// Returns whether one of the events that have come is of a watched file.
bool input_watch::take_events() {
  bool ours = false;
#if defined(SIGHTCELL_HAS_INOTIFY)
  if (events_ < 0) return false;
  alignas(inotify_event) std::array<char, 16384> buffer;
  for (ssize_t size = 0; (size = ::read(events_, buffer.data(), buffer.size())) > 0;) {
    for (ssize_t at = 0; at < size;) {
      const auto* event = reinterpret_cast<const inotify_event*>(buffer.data() + at);
      at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
      ours = ours || (event->mask & IN_Q_OVERFLOW) != 0;
      if (event->len == 0) continue;
      for (const auto& [number, folder] : folders_) {
        if (number != event->wd) continue;
        ours = ours || std::any_of(files_.begin(), files_.end(), [&, &of = folder](const watched_file& file) {
                 return file.path.filename() == event->name && bake::folder_of(file.path) == of;
               });
      }
    }
  }
#endif
  return ours;
}

bool input_watch::changed() {
  changed_ = take_events() || changed_;
  if (changed_ || clock::now() - compared_ < between_comparisons) return changed_;
  compared_ = clock::now();
  return changed_ = differs();
}

// Returns when an event has come, or a signal, or the time is over.
void input_watch::pause(std::chrono::milliseconds longest) const {
#if defined(SIGHTCELL_HAS_INOTIFY)
  if (events_ >= 0) {
    pollfd one{events_, POLLIN, 0};
    poll(&one, 1, static_cast<int>(longest.count()));
    return;
  }
#endif
  std::this_thread::sleep_for(longest);
}

bool input_watch::wait(const std::function<bool()>& stop) {
  while (!changed()) {
    if (stop()) return false;
    pause(idle_pause);
  }
  std::vector<stamp> last = stamps();
  for (clock::time_point since = clock::now(); clock::now() - since < quiet_time;) {
    if (stop()) return false;
    pause(quiet_pause);
    const bool events = take_events();
    std::vector<stamp> now = stamps();
    if (events || now != last) since = clock::now();
    last = std::move(now);
  }
  return true;
}

}  // namespace sightcell::cli
