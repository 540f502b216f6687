#include "bench/hemicube/child.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "sightcell/base/error.h"

namespace sightcell::bench {
namespace {

void run(const std::filesystem::path& program, const std::vector<std::string>& arguments,
         const std::vector<std::string>& environment) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    for (const std::string& one : environment) {
      const auto at = one.find('=');
      setenv(one.substr(0, at).c_str(), one.substr(at + 1).c_str(), 1);
    }
    execv(program.c_str(), pointers.data());
    _exit(127);
  }
  int status = 0;
  const bool waited = child > 0 && waitpid(child, &status, 0) == child;
  if (waited && WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  const bool missing = waited && WIFEXITED(status) && WEXITSTATUS(status) == 127;
  throw error(error_kind::failed, "bench.child", program.filename().string(),
              missing ? "cannot be run" : "did not end well",
              missing ? "build it: cmake --build --preset release" : "its own message stands before this one");
}

}  // namespace

std::filesystem::path own_program() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

void run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  run(program, arguments, {});
}

json run_job(json job, const std::vector<std::string>& environment) {
  const std::string stem = (cache_folder() / ("job-" + std::to_string(getpid()))).string();
  const std::filesystem::path question = stem + ".json", answer = stem + ".out.json";
  job["answer"] = answer.string();
  std::filesystem::remove(answer);
  write_json(question, job);
  run(own_program(), {"--worker", question.string()}, environment);
  const auto told = read_json(answer);
  std::filesystem::remove(question);
  std::filesystem::remove(answer);
  if (!told) throw error(error_kind::failed, "bench.child", "worker", "left no answer", "see its messages above");
  return *told;
}

}  // namespace sightcell::bench
