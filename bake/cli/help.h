#pragma once
// What --help prints: usage, description, options in groups with their defaults, examples. Lines have at most 100
// characters. Groups whose name begins with "Expert" are in --help-all only.
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace sightcell::cli {

// Texts of a verb.
struct verb_help {
  std::string summary;                // one line without a period, for the list of verbs
  std::string usage;                  // follows "sightcell VERB"
  std::string description;            // sentences; wrapped
  std::vector<std::string> examples;  // command lines
};

// Lets a program print its help in this form, and gives it the options --help and --help-all. To be called before verbs
// are added.
void use_help_format(CLI::App& program);

// Adds a verb to a program that has this form.
// Returns the verb, which belongs to the program.
CLI::App& add_verb(CLI::App& program, const std::string& name, verb_help help);

// Adds an option with a value. Its default is the value that the variable has now, and help shows it.
// unit: what help shows after the name, such as "M" or "FILE".
// help: sentences; the default is appended.
template <typename T>
CLI::Option* add_option(CLI::App& verb, const std::string& group, const std::string& name, T& value,
                        const std::string& unit, const std::string& help) {
  return verb.add_option(name, value, help)->type_name(unit)->capture_default_str()->group(group);
}

// Adds an option without a default that help could show.
template <typename T>
CLI::Option* add_plain_option(CLI::App& verb, const std::string& group, const std::string& name, T& value,
                              const std::string& unit, const std::string& help) {
  return verb.add_option(name, value, help)->type_name(unit)->group(group);
}

}  // namespace sightcell::cli
