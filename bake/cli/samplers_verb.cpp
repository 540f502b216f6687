// sightcell samplers
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "exit_codes.h"
#include "help.h"
#include "sightcell/bake/sampler_options.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

std::string range_text(const bake::sampler_option& option) {
  if (std::holds_alternative<bool bake::settings::*>(option.value)) return "a flag";
  return fmt::format("{} to {}", option.low, option.high);
}

// docs/sampler-settings.md, which a test compares with this.
int print_markdown() {
  fmt::print(
      "# Samplers and their settings\n\n"
      "`sightcell samplers --markdown` prints this page. [Samplers and papers](method/samplers.md) explains each of "
      "them.\n\n"
      "| `--sampler` | what it does | from |\n|---|---|---|\n");
  for (const bake::sampler_info& one : bake::samplers())
    fmt::print("| `{}` | {} | {} |\n", one.name, one.meaning, one.origin);
  fmt::print("\n| setting | default | range | what it is | samplers |\n|---|---|---|---|---|\n");
  const bake::settings defaults;
  for (const bake::sampler_option& option : bake::sampler_options()) {
    const std::string unit = *option.unit == '\0' ? "" : fmt::format(" {}", option.unit);
    fmt::print("| `{}{}` | {} | {} | {} | {} |\n", option.name, unit, bake::value_text(option, defaults),
               range_text(option), option.meaning, fmt::join(option.samplers, ", "));
  }
  return exit_done;
}

int print_text() {
  const bake::settings defaults;
  for (const bake::sampler_info& one : bake::samplers()) {
    fmt::print("{}\n  {}{}\n", one.name, one.meaning, *one.origin == '\0' ? "" : fmt::format(" ({})", one.origin));
    for (const bake::sampler_option& option : bake::sampler_options())
      if (option.of(one.name))
        fmt::print("  {:<20} {}; {}, default {}\n", fmt::format("{} {}", option.name, option.unit), option.meaning,
                   range_text(option), bake::value_text(option, defaults));
  }
  return exit_done;
}

}  // namespace

void add_samplers_verb(CLI::App& program, action& chosen) {
  auto markdown = std::make_shared<bool>(false);
  CLI::App& verb =
      add_verb(program, "samplers",
               {.summary = "Describes the samplers of bake and their settings",
                .usage = "[options]",
                .description =
                    "Lists the methods that sightcell bake --sampler can use, where they are from, and their settings "
                    "with range and default.",
                .examples = {"sightcell samplers"}});
  verb.add_flag("--markdown", *markdown, "Prints a Markdown document with tables.");
  verb.callback([markdown, &chosen] { chosen = [markdown] { return *markdown ? print_markdown() : print_text(); }; });
}

}  // namespace sightcell::cli
