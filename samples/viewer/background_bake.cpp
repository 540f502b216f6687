#include "background_bake.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>

#include "sightcell/base/json_text.h"

extern char** environ;  // NOLINT: POSIX requires it to be declared here

namespace viewer {
namespace {

namespace scene = sightcell::scene;

constexpr int done_code = 0, bound_not_met_code = 3, stopped_code = 130;  // exit codes of sightcell bake

glm::vec3 point_of(const nlohmann::json& numbers) {
  return {numbers.at(0).get<float>(), numbers.at(1).get<float>(), numbers.at(2).get<float>()};
}

// Starts a program with standard error in a pipe. Returns 0, or an error number.
int start_with_pipe(const std::vector<std::string>& words, pid_t& process, int& read_end) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return errno;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const int failed = posix_spawnp(&process, arguments.front(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed != 0) {
    close(ends[0]);
    return failed;
  }
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  read_end = ends[0];
  return 0;
}

}  // namespace

std::filesystem::path bake_program() {
  std::error_code ignored;
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::filesystem::path beside = own.parent_path() / "sightcell";
  return !own.empty() && access(beside.c_str(), X_OK) == 0 ? beside : std::filesystem::path("sightcell");
}

std::string file_beside(const std::string& scene_file) {
  return std::filesystem::path(scene_file).replace_extension(".pvs").string();
}

background_bake::~background_bake() {
  if (process_ > 0) {
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
  }
  close_pipe();
}

void background_bake::close_pipe() {
  if (pipe_ >= 0) close(pipe_);
  pipe_ = -1;
}

void background_bake::start(const std::string& quality) {
  if (step_ == step::running) return;
  const bool other = !quality_.empty() && quality != quality_;
  std::vector<std::string> words{bake_program().string(),
                                 "bake",
                                 command_.scene_file,
                                 "-o",
                                 command_.output,
                                 "--quality",
                                 quality,
                                 "--progress",
                                 "json"};
  if (command_.scene >= 0) words.insert(words.end(), {"--scene", std::to_string(command_.scene)});
  if (!command_.cells_file.empty()) words.insert(words.end(), {"--cells-file", command_.cells_file});
  if (other) words.emplace_back("--fresh");
  quality_ = quality;
  phase_ = "starting";
  error_.clear();
  last_message_.clear();
  rest_.clear();
  finished_.clear();
  cells_ = cells_total_ = 0;
  prepared_ = seconds_left_ = 0.0;
  const int failed = start_with_pipe(words, process_, pipe_);
  step_ = failed == 0 ? step::running : step::failed;
  if (failed != 0) error_ = words.front() + " cannot be started: " + std::strerror(failed);
}

void background_bake::stop() {
  if (process_ > 0) kill(process_, SIGTERM);
  phase_ = "stopping";
}

void background_bake::take_progress(const std::string& line) {
  const nlohmann::json now = scene::parse_json(line, false);
  if (!now.is_object()) return;
  try {
    if (phase_ != "stopping") phase_ = now.at("phase").get<std::string>();
    std::replace(phase_.begin(), phase_.end(), '_', ' ');
    cells_ = now.at("cells").get<std::uint32_t>();
    cells_total_ = now.at("cells_total").get<std::uint32_t>();
    prepared_ = now.at("prepared").get<double>();
    seconds_left_ = now.at("seconds_left").get<double>();
    for (const nlohmann::json& one : now.at("bounded_cells")) {
      const nlohmann::json& seconds = one.at("seconds");
      finished_.push_back({point_of(one.at("min")), point_of(one.at("max")), one.at("polygons").get<std::uint32_t>(),
                           one.at("upper_bound").get<float>(), seconds.is_number() ? seconds.get<float>() : -1.0f});
    }
  } catch (const nlohmann::json::exception&) {
    // Of a program of another version: there is less to show, and the bake goes on.
  }
}

void background_bake::take(const std::string& line) {
  if (line.empty()) return;
  if (line.front() == '{') {
    take_progress(line);
  } else {
    last_message_ = line;
  }
}

void background_bake::read_all() {
  std::array<char, 65536> bytes;
  for (;;) {
    const ssize_t count = read(pipe_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;
    rest_.append(bytes.data(), static_cast<std::size_t>(count));
    std::size_t begin = 0;
    for (std::size_t end; (end = rest_.find('\n', begin)) != std::string::npos; begin = end + 1)
      take(rest_.substr(begin, end - begin));
    rest_.erase(0, begin);
  }
}

void background_bake::end(int wait_status) {
  process_ = -1;
  read_all();
  take(rest_);
  close_pipe();
  const int code = WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : -1;
  if (code == done_code || code == bound_not_met_code) {
    step_ = step::done;
    return;
  }
  step_ = code == stopped_code ? step::stopped : step::failed;
  if (step_ == step::failed) error_ = last_message_;  // it names the cause
  if (code < 0) error_ = "sightcell bake was ended by signal " + std::to_string(WTERMSIG(wait_status));
}

bool background_bake::poll() {
  if (step_ != step::running) return false;
  read_all();
  int wait_status = 0;
  const pid_t ended = waitpid(process_, &wait_status, WNOHANG);
  if (ended != process_) return false;
  end(wait_status);
  return step_ == step::done;
}

}  // namespace viewer
