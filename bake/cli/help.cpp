#include "help.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

namespace sightcell::cli {
namespace {

constexpr std::size_t line_width = 100, text_column = 26;
constexpr std::string_view expert = "Expert";  // the beginning of the names of groups that --help does not show

// The text in lines, of which all but the first are indented; the first begins in this column.
std::string wrapped(std::string_view text, std::size_t column) {
  std::string out;
  std::size_t at = column;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    if (at > column && at + 1 + word.size() > line_width) {
      out += "\n" + std::string(column, ' ');
      at = column;
    } else if (at > column) {
      out += ' ';
      ++at;
    }
    out += word;
    at += word.size();
  }
  return out;
}

// A name and its text beside it, or below it where the name is long.
std::string entry(const std::string& name, const std::string& text) {
  std::string out = "  " + name;
  if (out.size() + 2 > text_column)
    out += "\n" + std::string(text_column, ' ');
  else
    out.resize(text_column, ' ');
  return out + wrapped(text, text_column) + "\n";
}

class help_format : public CLI::Formatter {
 public:
  void add(const CLI::App* verb, verb_help help) { verbs_[verb] = std::move(help); }

  std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode mode) const override {
    const auto verb = verbs_.find(app);
    if (verb != verbs_.end()) return verb_text(app, verb->second, mode != CLI::AppFormatMode::Normal);
    return program_text(app, mode == CLI::AppFormatMode::All);
  }

 private:
  std::string program_text(const CLI::App* app, bool all) const {
    std::string out = wrapped(app->get_description(), 0) + "\n\nUsage: sightcell VERB ...\n\nVerbs:\n";
    const auto verbs = app->get_subcommands([](const CLI::App*) { return true; });
    for (const CLI::App* verb : verbs) out += entry(verb->get_name(), verbs_.at(verb).summary + ".");
    out += groups(app, all);
    out += "\n" + wrapped(app->get_footer(), 0) + "\n";
    if (!all) return out;
    for (const CLI::App* verb : verbs) {
      const std::string rule(line_width, '-');
      out += "\n" + rule + "\n\n" + verb_text(verb, verbs_.at(verb), true);
    }
    return out;
  }

  std::string verb_text(const CLI::App* app, const verb_help& help, bool all) const {
    const std::string name = "sightcell " + app->get_name();
    std::string out = "Usage: " + name + " " + help.usage + "\n\n" + wrapped(help.description, 0) + "\n\n";
    for (const CLI::Option* positional : app->get_options([](const CLI::Option* o) { return o->get_positional(); }))
      out += entry(positional->get_name(true, false), text_of(positional));
    out += groups(app, all);
    if (!help.examples.empty()) out += "\nExamples:\n";
    for (const std::string& example : help.examples) out += "  " + example + "\n";
    return out;
  }

  std::string groups(const CLI::App* app, bool all) const {
    std::vector<std::string> names = app->get_groups();
    // Those of experts behind all others, and the flags of help last.
    const auto rank = [](const std::string& name) { return name == "Help" ? 2 : name.starts_with(expert) ? 1 : 0; };
    std::stable_sort(names.begin(), names.end(),
                     [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
    std::string out;
    for (const std::string& name : names) {
      if (name.empty() || (!all && name.starts_with(expert))) continue;
      const auto options =
          app->get_options([&](const CLI::Option* o) { return o->nonpositional() && o->get_group() == name; });
      if (options.empty()) continue;
      out += "\n" + name + ":\n";
      for (const CLI::Option* option : options) out += entry(name_of(option), text_of(option));
    }
    return out;
  }

  static std::string name_of(const CLI::Option* option) {
    std::string name = option->get_name(false, true);
    if (const std::size_t comma = name.find(','); comma != std::string::npos) name.insert(comma + 1, " ");
    if (option->get_type_size() == 0) return name;
    const std::string unit = option->get_type_name();  // then a colon and what its checks say
    return name + " " + unit.substr(0, unit.find(':'));
  }

  static std::string text_of(const CLI::Option* option) {
    std::string text = option->get_description();
    if (option->get_required() && option->nonpositional()) text += " Required.";
    if (!option->get_default_str().empty()) text += " Default: " + option->get_default_str() + ".";
    return text;
  }

  std::map<const CLI::App*, verb_help> verbs_;
};

void add_help_flags(CLI::App& app) {
  app.set_help_flag("-h,--help", "Prints the options that most users need.")->group("Help");
  app.set_help_all_flag("--help-all", "Prints all options.")->group("Help");
}

}  // namespace

void use_help_format(CLI::App& program) {
  program.formatter(std::make_shared<help_format>());
  add_help_flags(program);
}

CLI::App& add_verb(CLI::App& program, const std::string& name, verb_help help) {
  CLI::App& verb = *program.add_subcommand(name, help.summary);
  add_help_flags(verb);
  static_cast<help_format&>(*program.get_formatter()).add(&verb, std::move(help));
  return verb;
}

}  // namespace sightcell::cli
