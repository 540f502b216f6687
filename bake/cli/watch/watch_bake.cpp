#include "watch/watch_bake.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "bake_run.h"
#include "exit_codes.h"
#include "number_text.h"
#include "progress_line.h"
#include "run_action.h"
#include "sightcell/base/disk.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/named_files.h"
#include "sightcell/scene/scene.h"
#include "stop_signals.h"
#include "watch/input_watch.h"

namespace sightcell::cli {
namespace {

namespace fs = std::filesystem;

constexpr double draft_error = bake::max_pixel_error_of_quality[static_cast<std::size_t>(bake::quality::draft)];

constexpr std::uint32_t cells_of_near_preview = 64;

fs::path with_ending(fs::path path, const char* ending) {
  path += ending;
  return path;
}

std::string content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// All that a bake reads of a scene and of other files, but for colors, for animations of cameras and for a second
// scene.
struct scene_facts {
  scene_facts(const scene::scene& s, const bake_options& options)
      : fingerprint(s.fingerprint), nodes(s.node_names), meshes(s.mesh_names), groups(s.groups) {
    for (const fs::path& file : {options.cells_file, options.path_file, options.misses_file})
      files.push_back(content_of(file));
    for (const scene::start_point& one : s.starts) {
      numbers.insert(numbers.end(), one.position.begin(), one.position.end());
      numbers.push_back(one.is_camera ? 1.0f : 0.0f);
    }
    for (const scene::marked_cell& one : s.cells) {
      cells.push_back(one.name);
      for (const auto& corner : {one.min, one.max}) numbers.insert(numbers.end(), corner.begin(), corner.end());
    }
  }
  bool operator==(const scene_facts&) const = default;

  std::array<std::uint8_t, 16> fingerprint;
  std::vector<std::string> nodes, meshes, groups, cells, files;
  std::vector<float> numbers;
};

class watched_bake {
 public:
  explicit watched_bake(const bake_options& options) : options_(options) {
    std::error_code ignored;
    for (const char* ending : {"", ".bake", ".records"}) fs::remove(with_ending(preview_, ending), ignored);
  }
  ~watched_bake() {
    std::error_code ignored;
    for (const char* ending : {"", ".bake", ".records"}) fs::remove(with_ending(preview_, ending), ignored);
  }
  watched_bake(const watched_bake&) = delete;
  watched_bake& operator=(const watched_bake&) = delete;

  int run();

 private:
  std::vector<fs::path> inputs() const;
  bool bake_version(progress_line& line);
  bool bake_or_explain();
  bool has_nothing_new(const scene_facts& facts) const;
  bool bake_preview(const bake_input& input, progress_line& line);
  bool bake_whole(const bake_input& input, const scene_facts& facts, progress_line& line);
  template <class Bake>
  auto with_records(bake::settings how, const fs::path& output, progress_line& line, const Bake& bake) const;
  bool stop() { return signals_.asked() || watch_.changed(); }

  const bake_options& options_;
  const fs::path preview_ = with_ending(options_.output, ".preview");
  const stop_signals signals_;
  input_watch watch_;
  bool fresh_ = options_.fresh;              // of the next bake
  std::optional<scene_facts> begun_, done_;  // of the last bake that began, and if it is complete
};

std::vector<fs::path> watched_bake::inputs() const {
  std::vector<fs::path> files{options_.scenes.scene};
  for (const fs::path& one :
       {options_.scenes.cells_from, options_.cells_file, options_.path_file, options_.misses_file})
    if (!one.empty()) files.push_back(one);
  for (const fs::path& scene : {options_.scenes.scene, options_.scenes.cells_from})
    if (!scene.empty())
      for (fs::path& one : scene::named_files(scene)) files.push_back(std::move(one));
  return files;
}

bool watched_bake::has_nothing_new(const scene_facts& facts) const {
  const bool has_other_inputs =
      options_.scenes.two() || !options_.path_cameras.empty() || options_.metric.metric == "color";
  std::error_code ignored;
  return !has_other_inputs && done_ && facts == *done_ && fs::exists(options_.output, ignored);
}

// Calls bake with the settings of a bake that takes cells from the records of the last one of this output, which an
// earlier command may have kept. Without such records, or if they do not serve, all cells are baked.
template <class Bake>
auto watched_bake::with_records(bake::settings how, const fs::path& output, progress_line& line,
                                const Bake& bake) const {
  std::error_code ignored;
  if (how.keep_records && fs::exists(with_ending(output, ".records"), ignored)) {
    bake::settings since = how;
    since.since = output;
    if (options_.keep_order) since.order_from = output;  // of this version if there was a preview
    try {
      return bake(std::move(since));
    } catch (const error& e) {
      if (!e.id().starts_with("records.")) throw;
      line.message(fmt::format("all cells are baked: {}", e.what()));
    }
  }
  how.keep_found = false;
  return bake(std::move(how));
}

// Returns false if it was stopped.
bool watched_bake::bake_preview(const bake_input& input, progress_line& line) {
  const bool is_draft = input.how.max_pixel_error == 0.0 || input.how.max_pixel_error >= draft_error;
  const bool has_fewer_cells = input.how.near && input.how.cell_limit == 0;
  if (is_draft && !has_fewer_cells) return true;
  bake::settings how = input.how;
  if (!is_draft) how.max_pixel_error = draft_error;
  how.file.importance = false;
  how.file.residency = false;
  if (has_fewer_cells) {
    how.cell_limit = cells_of_near_preview;
    how.merge_cells = 0.0;  // merging cells takes longer than to bake so few
  }
  const bake::summary sum = with_records(std::move(how), preview_, line, [&](bake::settings of_preview) {
    // Computing an order takes longer than it saves in a file that is replaced soon. The output is of the version
    // before, as a preview or as the final file.
    std::error_code ignored;
    if (!of_preview.since.empty() && of_preview.file.granularity == bake::set_granularity::polygon &&
        fs::exists(options_.output, ignored))
      of_preview.order_from = options_.output;
    return bake_with_progress(
        input, of_preview, preview_, true, nullptr, line, [this] { return stop(); }, nullptr);
  });
  if (sum.result == bake::outcome::cancelled) return false;
  try {
    bake::publish(preview_, options_.output);
  } catch (const fs::filesystem_error& e) {
    throw error(error_kind::failed, "output.io", options_.output.string(),
                "the preview cannot be renamed to it: " + e.code().message(), "check the permissions of its folder");
  }
  const std::string again = sum.rebaked ? fmt::format(" ({} baked again)", grouped(sum.rebaked->count())) : "";
  line.message(fmt::format("{}: preview of {} cells{}, bound {:.2e}, {} of CPU time", options_.output.string(),
                           grouped(sum.cells), again, sum.max_upper_bound, duration_text(sum.cpu_seconds)));
  return true;
}

// Returns false if it was stopped.
bool watched_bake::bake_whole(const bake_input& input, const scene_facts& facts, progress_line& line) {
  const auto attempt = [&](bool fresh) {
    return with_records(input.how, options_.output, line, [&](const bake::settings& how) {
      return bake_and_report(options_, input, how, fresh, nullptr, line, [this] { return stop(); });
    });
  };
  int code = exit_done;
  try {
    code = attempt(fresh_);
  } catch (const error& e) {
    if (e.id() != "checkpoint.other-bake") throw;
    line.message("an unfinished bake of other settings or of another version of the scene is discarded");
    code = attempt(true);
  }
  if (code == exit_cancelled) return false;
  done_ = facts;
  return true;
}

// Bakes the scene as it is now. Returns false if a save or a signal has stopped it.
bool watched_bake::bake_version(progress_line& line) {
  watch_.settle();
  const bake_input input = load_input(options_, settings_of(options_), line);
  watch_.follow(inputs());
  const scene_facts facts(input.s, options_);
  if (has_nothing_new(facts)) {
    line.message(fmt::format("{}: nothing that decides visibility has changed", input.s.name));
    if (!options_.embed_file.empty()) embed(options_, input, line);  // colors may have
    return true;
  }
  // What is left of a bake of another version helps no further bake.
  fresh_ = begun_ ? facts != *begun_ : fresh_;
  begun_ = facts;
  if (stop()) return false;
  return bake_preview(input, line) && bake_whole(input, facts, line);
}

bool watched_bake::bake_or_explain() {
  progress_line line(progress_mode_of(options_.progress));
  try {
    return bake_version(line);
  } catch (const error& e) {
    // What is wrong with the command line shows at once. Later, a save has caused it.
    if (!begun_ && (e.kind() == error_kind::wrong_use || e.id() == "scene.not-found")) throw;
    line.end();
    print_error(e.what());
  }
  return true;
}

int watched_bake::run() {
  watch_.follow(inputs());
  for (;;) {
    const bool ended = bake_or_explain();
    if (signals_.asked()) return ended ? exit_done : exit_cancelled;
    if (ended) {
      progress_line line(progress_mode_of(options_.progress));
      line.message(fmt::format("waiting for {} to be saved; Ctrl-C ends", options_.scenes.scene.string()));
    }
    if (!watch_.wait([this] { return signals_.asked(); })) return ended ? exit_done : exit_cancelled;
  }
}

}  // namespace

int watch_bake(const bake_options& options) {
  return watched_bake(options).run();
}

}  // namespace sightcell::cli
