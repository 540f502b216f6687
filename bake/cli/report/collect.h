#pragma once
// Collects what a report shows from a .pvs file, its scene, and results of other verbs.
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "progress_line.h"
#include "pvs_file.h"
#include "report/report_data.h"
#include "sightcell/bake/bake.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {

struct report_request {
  std::filesystem::path scene, file, output;
  std::filesystem::path verify_file, bake_file;  // results of `verify --json` and `bake --json`; empty: none
  std::optional<std::uint64_t> rays;             // verification rays without verify_file; 0: none. Default: as verify
  nlohmann::ordered_json bake;                   // instead of bake_file
  const bake::summary* summary = nullptr;        // of the bake, for the times of cells; may be null
};

// Collects the data of a report.
// s: the scene of the file. cells_from: the scene of its cells if that is another one, else null.
// line: shows progress.
// Fails with pvs.*, report.not-json, report.other-file, cli.unreadable.
// Cost: decodes each set twice, casts verification rays, draws 16 views and a plan of each floor.
report_data collect_report(const scene::scene& s, const scene::scene* cells_from, const pvs_file& file,
                           const report_request& request, progress_line& line);

// Reads a result that a verb wrote with --json, and checks that it is of this file and has the shape that reports use.
// Fails with cli.unreadable, report.not-json, report.other-file.
nlohmann::ordered_json read_verify_result(const std::filesystem::path& path, const pvs_file& file);
nlohmann::ordered_json read_bake_result(const std::filesystem::path& path, const pvs_file& file);

}  // namespace sightcell::cli
