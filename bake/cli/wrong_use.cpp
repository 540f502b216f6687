#include "wrong_use.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

#include "sightcell/base/nearest_name.h"

namespace sightcell::cli {
namespace {

// -8 and -0.5,0 are values.
bool is_option(std::string_view word) {
  return word.size() > 1 && word[0] == '-' && word != "--" && std::isdigit(static_cast<unsigned char>(word[1])) == 0 &&
         word[1] != '.';
}

// Without their dashes.
std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  return names;
}

std::vector<std::string> names_of_verbs(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* verb : program.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(verb->get_name());
  return names;
}

// What was not understood, and what may have been meant; empty where all words were.
std::string unknown_word(const CLI::App& program, const CLI::App& app) {
  for (const CLI::App* level : {&program, &app}) {
    for (const std::string& word : level->remaining()) {
      if (!is_option(word)) continue;
      const std::string name = word.substr(0, word.find('='));
      const std::vector<std::string> names = names_of_options(*level);
      const std::vector<std::string_view> views(names.begin(), names.end());
      const auto nearest = bake::nearest_name(std::string_view(name).substr(name.find_first_not_of('-')), views);
      return fmt::format("{}: unknown option{}", name, nearest ? fmt::format("; did you mean --{}?", *nearest) : "");
    }
  }
  if (&app != &program || program.remaining().empty()) return "";
  const std::string word = program.remaining().front();
  const std::vector<std::string> names = names_of_verbs(program);
  const std::vector<std::string_view> views(names.begin(), names.end());
  return fmt::format("{}: unknown verb{}", word, bake::did_you_mean(word, views));
}

}  // namespace

std::string wrong_use_text(const CLI::App& program, const CLI::ParseError& failure) {
  const auto chosen = program.get_subcommands();
  const CLI::App& app = chosen.empty() ? program : *chosen.front();
  std::string text = unknown_word(program, app);
  if (text.empty()) text = failure.what();
  const std::string separator = text.ends_with('?') ? " " : "; ";
  return fmt::format("{}{}see sightcell {}--help [cli.wrong-use]", text, separator,
                     chosen.empty() ? "" : app.get_name() + " ");
}

}  // namespace sightcell::cli
