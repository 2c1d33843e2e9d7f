#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/run.hpp"
#include "io/nearest_name.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

/// What is written to series.csv: the clock of every run, and all observables.
std::vector<ColumnInfo> measured_columns() {
  std::vector<ColumnInfo> columns = clock_columns();
  std::ranges::move(observed_columns(), std::back_inserter(columns));
  return columns;
}

std::string explained(ColumnInfo const& column) {
  return fmt::format("{}\n    {}\n    column of series.csv, {}\n", column.name, column.documentation,
                     column.unit.empty() ? "a pure number" : "in " + column.unit);
}

/// The table of docs/reference/observables.md.
std::string observables_markdown() {
  std::string text = "| column | unit | meaning |\n|---|---|---|\n";
  for (ColumnInfo const& column : measured_columns()) {
    std::string meaning;
    for (char const letter : column.documentation)
      meaning += letter == '|' ? std::string("\\|") : std::string(1, letter);
    text += fmt::format("| `{}` | {} | {} |\n", column.name, column.unit, meaning);
  }
  return text;
}

/// What is measured: one column, or all of them for "observables"; empty for another key.
std::string explained_observables(std::string_view key) {
  std::string text;
  for (ColumnInfo const& column : measured_columns()) {
    if (column.name != key && key != "observables") continue;
    if (!text.empty()) text += '\n';
    text += explained(column);
  }
  return text;
}

/// How the field abbreviates what is measured and set, and the names it has here.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> abbreviations{{
    {"psi6", "local_bond_orientation_order"},
    {"psi_6", "local_bond_orientation_order"},
    {"msd", "mean_squared_displacement"},
    {"vacf", "velocity_autocorrelation"},
    {"z", "compressibility_factor"},
    {"phi", "disks.packing_fraction"},
    {"n", "disks.count"},
    {"dt", "engine.time_step"},
    {"k", "engine.cells"},
}};

/// The name behind an abbreviation, the nearest name, or else all names that hold the word; empty where there are none.
std::string meant_by(std::string key) {
  std::ranges::transform(key, key.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  auto const abbreviation = std::ranges::find(abbreviations, key, [](auto const& entry) { return entry.first; });
  if (abbreviation != abbreviations.end()) return std::string(abbreviation->second);
  std::vector<std::string> names;
  for (ColumnInfo const& column : measured_columns()) names.push_back(column.name);
  std::string nearest = nearest_name(key, names);
  if (!nearest.empty()) return nearest;
  constexpr std::size_t least_letters = 3;
  if (key.size() < least_letters) return "";
  Configuration configuration;
  for (std::string& setting : setting_keys(describing(configuration))) names.push_back(std::move(setting));
  std::erase_if(names, [&](std::string const& name) { return name.find(key) == std::string::npos; });
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string hint_on_columns(std::string_view key) {
  std::string const names = meant_by(std::string(key));
  return names.empty() ? ", gridlock explain observables all columns" : fmt::format("; did you mean {}?", names);
}

/// Errors: Error for a setting or a column of another name in earlier versions, with its present one.
void refuse_former_name(std::string const& key) {
  Configuration configuration;
  std::optional<std::string> present = renamed_setting(describing(configuration), key);
  for (ColumnInfo const& column : measured_columns()) {
    if (!column.former_name.empty() && column.former_name == key) present = column.name;
  }
  if (!present) return;
  throw Error({.what = fmt::format("{} was renamed to {}", key, *present),
               .hint = fmt::format("gridlock explain {} says what it is", *present)});
}

/// A setting, a table or a column. Errors: Error for a key that is none of them.
std::string explained(std::string const& key) {
  std::string observables = explained_observables(key);
  if (!observables.empty()) return observables;
  refuse_former_name(key);
  Configuration configuration;
  try {
    return explain(describing(configuration), key);
  } catch (Error const& error) {
    Problem problem = error.problems().front();
    problem.what = fmt::format("there is no setting and no column \"{}\"", key);
    if (!problem.hint.starts_with("did you mean")) problem.hint += hint_on_columns(key);
    throw Error(problem);
  }
}

}  // namespace

void add_explain(CLI::App& app, ExitCode& exit_code) {
  struct ExplainOptions {
    std::string key;
    bool as_markdown = false;
  };
  CLI::App* const verb =
      app.add_subcommand("explain", "Explain a setting, a table of settings, what is measured, or all settings");
  auto const options = std::make_shared<ExplainOptions>();
  verb->add_option("KEY", options->key,
                   "A setting such as disks.packing_fraction, a table such as disks, a column such as mean_speed, or "
                   "observables for every column");
  verb->add_flag("--markdown", options->as_markdown, "All settings, or observables, as the reference pages in docs/");
  verb->callback([options, &exit_code] {
    Configuration configuration;
    if (options->as_markdown && options->key == "observables") {
      fmt::print("{}", observables_markdown());
    } else if (options->as_markdown) {
      fmt::print("# Settings\n\nEvery setting of a configuration, as `gridlock explain --markdown` prints them.\n\n{}",
                 reference_markdown(describing(configuration)));
    } else {
      fmt::print("{}", explained(options->key));
    }
    exit_code = ExitCode::good;
  });
}

}  // namespace gridlock::cli
