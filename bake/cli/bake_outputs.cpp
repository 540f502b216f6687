#include "bake_outputs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <utility>

#include "sightcell/base/error.h"
#include "sightcell/scene/embed.h"

namespace sightcell::cli {
namespace {

[[noreturn]] void refuse_unwritable(const std::filesystem::path& path, const char* option) {
  throw error(error_kind::failed, "cli.not-writable", path.string(), "cannot be written",
              fmt::format("choose a {} in a folder that exists and can be written", option));
}

}  // namespace

void write_summary(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text << '\n';
  out.close();
  if (out) return;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored))
    std::filesystem::remove(path, ignored);  // half of it helps nobody
  refuse_unwritable(path, "--json-file");
}

// A file that the bake writes must not be one that it reads, or another one that it writes.
void refuse_overwriting(const bake_options& options) {
  const auto refuse = [](const std::filesystem::path& output, const char* what) {
    throw error(error_kind::wrong_use, "cli.output-is-input", output.string(), what, "choose another name");
  };
  std::error_code ignored;
  for (const std::filesystem::path& output :
       {options.output, options.json_file, options.unseen_file, options.report_file}) {
    for (const std::filesystem::path& scene : {options.scenes.scene, options.scenes.cells_from})
      if (std::filesystem::equivalent(scene, output, ignored)) refuse(output, "is the scene itself");
    if (std::filesystem::equivalent(options.cells_file, output, ignored)) refuse(output, "is the cells file");
    if (std::filesystem::equivalent(options.path_file, output, ignored)) refuse(output, "is the file of paths");
    if (std::filesystem::equivalent(options.misses_file, output, ignored)) refuse(output, "is the file of misses");
  }
  const auto is_same = [&](const std::filesystem::path& a, const std::filesystem::path& b) {
    return !a.empty() && std::filesystem::weakly_canonical(a, ignored) == std::filesystem::weakly_canonical(b, ignored);
  };
  // A save in the same moment would be lost.
  if (options.watch && is_same(options.embed_file, options.scenes.scene))
    refuse(options.embed_file, "is --embed and the scene that --watch waits for");
  for (const std::filesystem::path& other :
       {options.output, options.json_file, options.unseen_file, options.report_file})
    if (is_same(options.embed_file, other)) refuse(options.embed_file, "is both --embed and another output");
  if (is_same(options.json_file, options.output)) refuse(options.json_file, "is both -o and --json-file");
  if (is_same(options.unseen_file, options.output)) refuse(options.unseen_file, "is both -o and --report-unseen");
  if (is_same(options.unseen_file, options.json_file))
    refuse(options.unseen_file, "is both --json-file and --report-unseen");
  for (const std::filesystem::path& other : {options.output, options.json_file, options.unseen_file})
    if (is_same(options.report_file, other)) refuse(options.report_file, "is both --report and another output");
}

// What could not be written after hours is refused before.
void refuse_bad_outputs(const bake_options& options) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::file_status there = fs::status(options.output, ignored);
  if (!options.output.has_filename() || (fs::exists(there) && !fs::is_regular_file(there)))
    throw error(error_kind::failed, "output.io", options.output.string(),
                fs::is_directory(there) ? "is a folder" : "names no file", "choose a file as -o");
  for (const auto& [path, option] : {std::pair(options.json_file, "--json-file"),
                                     {options.unseen_file, "--report-unseen"},
                                     {options.report_file, "--report"},
                                     {options.embed_file, "--embed"}}) {
    if (path.empty()) continue;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const bool exists = fs::exists(path, ignored);
    if (fs::is_directory(path, ignored) || access(exists ? path.c_str() : folder.c_str(), W_OK) != 0)
      refuse_unwritable(path, option);
  }
}

void refuse_bad_embedding(const bake_options& options) {
  const std::byte nothing{};
  (void)scene::with_embedded(options.scenes.scene, {&nothing, 1}, options.output, options.embed_file);
}

}  // namespace sightcell::cli
