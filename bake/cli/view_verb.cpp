// sightcell view SCENE [FILE.pvs]
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "help.h"
#include "sightcell/base/error.h"
#include "verbs.h"

namespace sightcell::cli {
namespace {

constexpr const char* viewer = "sightcell-viewer";

bool can_run(const std::filesystem::path& program) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(program, ignored) && access(program.c_str(), X_OK) == 0;
}

// Beside this program, then in PATH; empty if it is nowhere.
std::filesystem::path find_viewer() {
  std::error_code ignored;
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", ignored);
  if (!own.empty() && can_run(own.parent_path() / viewer)) return own.parent_path() / viewer;
  const char* list = std::getenv("PATH");
  std::string_view folders = list != nullptr ? list : "";
  while (!folders.empty()) {
    const std::string_view folder = folders.substr(0, folders.find(':'));
    folders.remove_prefix(std::min(folder.size() + 1, folders.size()));
    if (!folder.empty() && can_run(std::filesystem::path(folder) / viewer))
      return std::filesystem::path(folder) / viewer;
  }
  return {};
}

[[noreturn]] void fail_to_start(const std::string& cause) {
  throw error(error_kind::failed, "view.not-installed", viewer, cause,
              "build it (samples/viewer) and put it into the folder of sightcell or into PATH");
}

// Replaces this process, so that signals and the exit code are the viewer's.
int run_view(std::vector<std::string> arguments) {
  const std::filesystem::path program = find_viewer();
  if (program.empty()) fail_to_start("is not in the folder of sightcell and not in PATH");
  arguments.insert(arguments.begin(), program.string());
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  execv(program.c_str(), words.data());
  fail_to_start(fmt::format("cannot be started: {}", std::strerror(errno)));
}

}  // namespace

void add_view_verb(CLI::App& program, action& chosen) {
  struct view_options {
    std::string scene, file;
  };
  auto options = std::make_shared<view_options>();
  CLI::App& verb = add_verb(
      program, "view",
      {.summary = "Opens a window to fly through a scene and its .pvs file",
       .usage = "SCENE [FILE.pvs] [options of sightcell-viewer]",
       .description =
           "Starts sightcell-viewer, which draws the scene with the cell set of the camera. Its keys walk and "
           "fly, switch the set on and off, freeze the set of a cell, paint red what it leaves out and "
           "count the pixels that are wrong. A map goes to each cell. Without FILE.pvs, it draws all of "
           "the scene. Options behind the files are passed on; sightcell-viewer --help lists them.",
       .examples = {"sightcell view level.glb level.pvs", "sightcell view level.glb level.pvs --cell 12 --mode tint"}});
  verb.add_option("SCENE", options->scene, "The scene: a .glb or .gltf file.")->required();
  verb.add_option("FILE", options->file, "The .pvs file that was baked from it.");
  verb.prefix_command();
  verb.callback([options, &verb, &chosen] {
    std::vector<std::string> arguments{options->scene};
    if (!options->file.empty()) arguments.push_back(options->file);
    for (const std::string& word : verb.remaining()) arguments.push_back(word);
    chosen = [arguments] { return run_view(arguments); };
  });
}

}  // namespace sightcell::cli
