#include "stop_signals.h"

#include <unistd.h>

#include <cerrno>

namespace sightcell::cli {

namespace {

constexpr int stopping[] = {SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t stop_asked = 0;

void ask_to_stop(int) {
  const int error_before = errno;
  stop_asked = 1;
  for (const int signal : stopping) {
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler == ask_to_stop) std::signal(signal, SIG_DFL);
  }
  constexpr char text[] = "\nstopping; again to stop at once (finished cells are kept)\n";
  if (write(STDERR_FILENO, text, sizeof text - 1) < 0) {
    // Nobody to tell.
  }
  errno = error_before;
}

}  // namespace

stop_signals::stop_signals() {
  stop_asked = 0;
  for (const int signal : stopping) set(signal);
}

stop_signals::~stop_signals() {
  for (const auto& [signal, before] : before_) sigaction(signal, &before, nullptr);
}

bool stop_signals::asked() const {
  return stop_asked != 0;
}

void stop_signals::set(int signal) {
  struct sigaction before {};
  if (sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) return;
  struct sigaction wanted {};
  wanted.sa_handler = ask_to_stop;
  wanted.sa_flags = SA_RESTART;
  if (sigaction(signal, &wanted, nullptr) == 0) before_.emplace_back(signal, before);
}

}  // namespace sightcell::cli
