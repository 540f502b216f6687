// sightcell patch FILE.pvs --add CELL:POLYGON
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "exit_codes.h"
#include "help.h"
#include "number_text.h"
#include "pvs_file.h"
#include "sightcell/bake/patch.h"
#include "sightcell/base/error.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

struct patch_options {
  std::filesystem::path file, output;
  std::vector<std::string> add;
  bool json = false;
};

// CELL:POLYGON or CELL:FIRST-LAST.
bake::added_polygons parsed(const std::string& text) {
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto number = [&](std::uint32_t& out) {
    const auto [stop, failure] = std::from_chars(at, end, out);
    if (failure != std::errc()) return false;
    at = stop;
    return true;
  };
  const auto sign = [&](char c) { return at != end && *at == c && ++at != end; };
  bake::added_polygons wanted;
  std::uint32_t last = 0;
  bool good = number(wanted.cell) && sign(':') && number(wanted.first);
  last = wanted.first;
  if (good && at != end) good = sign('-') && number(last) && at == end && last >= wanted.first && last < UINT32_MAX;
  if (!good)
    throw error(error_kind::wrong_use, "patch.bad-add", "--add", fmt::format("is \"{}\"", text),
                "give CELL:POLYGON or CELL:FIRST-LAST, numbers");
  wanted.count = last - wanted.first + 1;
  return wanted;
}

int run_patch(const patch_options& options) {
  std::vector<bake::added_polygons> additions;
  for (const std::string& text : options.add) additions.push_back(parsed(text));
  const pvs_file file = pvs_file::open(options.file);
  const std::filesystem::path& output = options.output.empty() ? options.file : options.output;
  const bake::patch_result result = bake::patch(file.bytes(), options.file.string(), additions, output);
  if (options.json) {
    const nlohmann::ordered_json text{{"output", output.string()},
                                      {"added", result.added},
                                      {"already_there", result.already_there},
                                      {"bytes", result.bytes}};
    fmt::print("{}\n", text.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  } else {
    fmt::print("{}: {} polygons added, {} were there already; {} bytes\n", output.string(), grouped(result.added),
               grouped(result.already_there), grouped(result.bytes));
  }
  return exit_done;
}

}  // namespace

void add_patch_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<patch_options>();
  CLI::App& verb = add_verb(
      program, "patch",
      {.summary = "Adds polygons to cell sets of a .pvs file",
       .usage = "FILE.pvs --add CELL:POLYGON [options]",
       .description = "Adds polygons to cell sets, for example a reported miss. The bounds in the file still hold, "
                      "because more polygons only lower the error. FILE.pvs is replaced unless -o is given.",
       .examples = {"sightcell patch level.pvs --add 12:3456",
                    "sightcell patch level.pvs --add 12:3400-3499 -o new.pvs"}});
  verb.add_option("FILE", options->file, "The .pvs file.")->required();
  verb.add_option("--add", options->add,
                  "A cell, and the source id of a polygon or the first and last one of a range: CELL:POLYGON or "
                  "CELL:FIRST-LAST. May be repeated.")
      ->type_name("CELL:POLYGON")
      ->required();
  verb.add_option("-o", options->output, "The file to write. Without it: FILE.")->type_name("FILE.pvs");
  verb.add_flag("--json", options->json, "Prints the result as one JSON object on standard output.");
  verb.callback([options, &chosen] { chosen = [options] { return run_patch(*options); }; });
}

}  // namespace sightcell::cli
