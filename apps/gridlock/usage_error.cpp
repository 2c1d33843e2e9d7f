#include "usage_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "gridlock/io/settings_file.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "io/nearest_name.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

bool is_option(std::string_view word) { return word.size() > 1 && word.front() == '-'; }

std::string command(CLI::App const& verb) { return fmt::format("{} {}", program_name(), verb.get_name()); }

std::string help_of(CLI::App const& verb) { return fmt::format("{} --help lists its arguments", command(verb)); }

bool has_option(CLI::App const& verb, std::string const& name) { return verb.get_option_no_throw(name) != nullptr; }

std::vector<std::string> long_names(CLI::App const& verb) {
  std::vector<std::string> names;
  for (CLI::Option const* option : verb.get_options()) {
    for (std::string const& name : option->get_lnames()) names.push_back(name);
  }
  return names;
}

/// Returns the name of an option without dashes: "time-step" for --time-step; "threads" for -j, which is short for
/// --threads in other commands.
std::string name_of(CLI::App const& verb, std::string const& option) {
  std::string name = option.substr(option.find_first_not_of('-'));
  if (name.size() > 1) return name;
  for (CLI::App const* other : verb.get_parent()->get_subcommands({})) {
    CLI::Option const* const known = other->get_option_no_throw(option);
    if (known != nullptr && !known->get_lnames().empty()) return known->get_lnames().front();
  }
  return name;
}

/// Returns the setting whose key, or last part of the key, equals or resembles a name; empty if there is none.
std::string setting_like(std::string_view name) {
  Configuration configuration;
  std::vector<std::string> const keys = setting_keys(describing(configuration));
  std::vector<std::string> last_parts;
  for (std::string const& key : keys) last_parts.push_back(key.substr(key.rfind('.') + 1));
  if (std::ranges::find(keys, name) != keys.end()) return std::string(name);
  auto const found = std::ranges::find(last_parts, nearest_name(name, last_parts));
  return found == last_parts.end() ? "" : keys[static_cast<std::size_t>(found - last_parts.begin())];
}

/// Returns the problem of an option that the command lacks, as `--time-step 0.1`.
Problem unknown_option(CLI::App const& verb, std::vector<std::string> const& extras) {
  std::string_view const word = extras.front();
  std::size_t const equals = word.find('=');
  std::string const option(word.substr(0, equals));
  std::string value = extras.size() > 1 && !is_option(extras[1]) ? extras[1] : "…";
  if (equals != std::string_view::npos) value = word.substr(equals + 1);
  std::string const name = name_of(verb, option);
  std::string key = name;
  std::ranges::replace(key, '-', '_');

  std::string const setting = has_option(verb, "--set") ? setting_like(key) : "";
  std::string const nearest = nearest_name(name, long_names(verb));
  bool const is_setting = setting == key || setting.ends_with("." + key);
  std::string hint = fmt::format("{} --help lists the options", command(verb));
  if (!setting.empty()) hint = fmt::format("settings are given by --set {}={}", setting, value);
  if (!nearest.empty() && !is_setting) hint = fmt::format("did you mean --{}?", nearest);
  return {.what = fmt::format("{} has no option {}", command(verb), option), .hint = hint, .key = option};
}

/// Returns the problem of a word for which the command has no further positional argument.
Problem extra_word(CLI::App const& verb, std::string const& word) {
  std::vector<std::string> places;
  for (CLI::Option const* option : verb.get_options()) {
    if (option->get_positional()) places.push_back(option->get_name());
  }
  std::string hint = fmt::format("{} --help shows what it takes", command(verb));
  if (has_option(verb, "--output")) hint = fmt::format("results go where -o says: -o {}", word);
  if (has_option(verb, "--set") && word.find('=') != std::string::npos) hint = fmt::format("write --set {}", word);
  return {.what = fmt::format("\"{}\" is one word too many: {} takes {} only", word, command(verb),
                              fmt::join(places, " and ")),
          .hint = hint};
}

/// Returns the problem of a missing or repeated value; CLI11 reports it as "--to: 1 required TEXT missing".
Problem wrong_number_of_values(CLI::App const& verb, std::string const& said) {
  std::string const name = said.substr(0, said.find(':'));
  CLI::Option const* const option = verb.get_option_no_throw(name);
  std::string what = said;
  if (option != nullptr) {
    what = option->count() > 1 ? fmt::format("{} is given {} times", name, option->count())
                               : fmt::format("{} needs a value: {}", name, option->get_type_name());
  }
  return {.what = what, .hint = fmt::format("{} --help lists the options", command(verb)), .key = name};
}

/// Returns the problem of a flag with a value or a value of the wrong type: "Could not convert: --pictures = maybe".
Problem wrong_value(CLI::App const& verb, std::string_view said) {
  std::size_t const dashes = std::min(said.find("--"), said.size());
  std::string_view const rest = said.substr(dashes);
  std::string const name(rest.substr(0, rest.find(' ')));
  std::size_t const equals = rest.find(" = ");
  std::string const value(equals == std::string_view::npos ? "" : rest.substr(equals + 3));
  CLI::Option const* const option = verb.get_option_no_throw(name);
  if (option == nullptr || value.empty()) return {.what = std::string(said), .hint = help_of(verb)};
  std::string const what = option->get_expected_max() == 0
                               ? fmt::format("{} takes no value, but is given \"{}\"", name, value)
                               : fmt::format("{} needs a number, but is \"{}\"", name, value);
  return {.what = what, .hint = help_of(verb), .key = name};
}

/// Returns the problem that a validator reported, as "--to: must be xyz, vtk or csv, but is foo".
Problem refused_value(CLI::App const& verb, std::string const& said) {
  std::size_t const colon = said.find(": ");
  if (colon == std::string::npos) return {.what = said, .hint = help_of(verb)};
  std::string const name = said.substr(0, colon);
  return {.what = fmt::format("{} {}", name, said.substr(colon + 2)), .hint = help_of(verb), .key = name};
}

/// Returns the problem of a missing argument, which CLI11 reports as "FILE is required".
Problem missing_argument(CLI::App const& verb, std::string const& said) {
  std::string const name = said.substr(0, said.find(' '));
  return {.what = fmt::format("{} needs {}", command(verb), name), .hint = help_of(verb), .key = name};
}

/// Returns the problem of two conflicting options, which CLI11 reports as "--quiet excludes --verbose".
Problem opposed_options(CLI::App const& verb, std::string const& said) {
  constexpr std::string_view middle = " excludes ";
  std::size_t const at = said.find(middle);
  if (at == std::string::npos) return {.what = said, .hint = help_of(verb)};
  std::string const first = said.substr(0, at);
  std::string const second = said.substr(at + middle.size());
  return {.what = fmt::format("{} and {} cannot be given together", first, second),
          .hint = fmt::format("leave one of them out; {}", help_of(verb)),
          .key = first};
}

Problem unknown_command(CLI::App const& app, std::string const& word) {
  std::vector<std::string> commands;
  for (CLI::App const* verb : app.get_subcommands({})) commands.push_back(verb->get_name());
  std::string const nearest = nearest_name(word, commands);
  std::string const help = fmt::format("{} --help explains them", program_name());
  return {.what = word.empty()      ? program_name() + " needs a command"
                  : is_option(word) ? fmt::format("{} needs a command before {}", program_name(), word)
                                    : fmt::format("there is no command \"{}\"", word),
          .hint = nearest.empty() ? fmt::format("the commands are {}; {}", fmt::join(commands, ", "), help)
                                  : fmt::format("did you mean {} {}?", program_name(), nearest)};
}

}  // namespace

Problem usage_problem(CLI::App const& app, CLI::ParseError const& error, std::string const& first_word) {
  if (app.get_subcommands().empty()) return unknown_command(app, first_word);
  CLI::App const& verb = *app.get_subcommands().front();
  std::vector<std::string> const extras = verb.remaining();
  if (!extras.empty())
    return is_option(extras.front()) ? unknown_option(verb, extras) : extra_word(verb, extras.front());
  if (!app.remaining().empty()) {
    return {.what = fmt::format("\"{}\" comes before the command", app.remaining().front()),
            .hint = fmt::format("options come after it: {} {}", command(verb), app.remaining().front())};
  }
  if (dynamic_cast<CLI::ArgumentMismatch const*>(&error) != nullptr) return wrong_number_of_values(verb, error.what());
  if (dynamic_cast<CLI::ConversionError const*>(&error) != nullptr) return wrong_value(verb, error.what());
  if (dynamic_cast<CLI::RequiredError const*>(&error) != nullptr) return missing_argument(verb, error.what());
  if (dynamic_cast<CLI::ExcludesError const*>(&error) != nullptr) return opposed_options(verb, error.what());
  return refused_value(verb, error.what());
}

}  // namespace gridlock::cli
