#include <fmt/format.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/nearest_name.hpp"
#include "gridlock/run/configuration.hpp"
#include "gridlock/run/simulate.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

/// What a run of disks writes to series.csv, between walls, where it measures most.
std::vector<ColumnInfo> measured_columns() {
  Configuration configuration;
  configuration.disks.count = 1;
  configuration.run.steps = 0;
  return simulate(set_up(configuration)).series_columns;
}

std::string explained(ColumnInfo const& column) {
  return fmt::format("{}\n    {}\n    column of series.csv, {}\n", column.name, column.documentation,
                     column.unit.empty() ? "a pure number" : "in " + column.unit);
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

std::string hint_on_columns(std::string_view key) {
  std::vector<std::string> names;
  for (ColumnInfo const& column : measured_columns()) names.push_back(column.name);
  std::string const nearest = nearest_name(key, names);
  return nearest.empty() ? ", gridlock explain observables all columns" : fmt::format("; did you mean {}?", nearest);
}

/// A setting, a table or a column. Errors: Error for a key that is none of them.
std::string explained(std::string const& key) {
  std::string observables = explained_observables(key);
  if (!observables.empty()) return observables;
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
  verb->add_flag("--markdown", options->as_markdown, "All settings as the reference page in docs/");
  verb->callback([options, &exit_code] {
    Configuration configuration;
    fmt::print("{}", options->as_markdown
                         ? "# Settings\n\nEvery setting of a configuration, as `gridlock explain --markdown` "
                           "prints them.\n\n" +
                               reference_markdown(describing(configuration))
                         : explained(options->key));
    exit_code = ExitCode::good;
  });
}

}  // namespace gridlock::cli
