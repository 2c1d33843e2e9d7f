#include <CLI/CLI.hpp>
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
#include "gridlock/engine/engine.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/simulate.hpp"
#include "io/nearest_name.hpp"
#include "simulation/lacking.hpp"
#include "simulation/protocol_simulation.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

/// Returns the columns of series.csv that every run can have: the clock and the observables.
std::vector<ColumnInfo> measured_columns() {
  std::vector<ColumnInfo> columns = clock_columns();
  std::ranges::move(observed_columns(), std::back_inserter(columns));
  return columns;
}

std::string explained(ColumnInfo const& column, std::string_view where = "column of series.csv") {
  std::string const documentation = column.documentation.empty() ? "" : fmt::format("    {}\n", column.documentation);
  return fmt::format("{}\n{}    {}, {}\n", column.name, documentation, where,
                     column.unit.empty() ? "a pure number" : "in " + column.unit);
}

/// Returns the table of docs/reference/observables.md.
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

/// Returns the explanation of a column, or of all columns for "observables"; empty for other keys.
std::string explained_observables(std::string_view key) {
  std::string text;
  for (ColumnInfo const& column : measured_columns()) {
    if (column.name != key && key != "observables") continue;
    if (!text.empty()) text += '\n';
    text += explained(column);
  }
  return text;
}

/// Usual abbreviations of quantities and settings, with the names in Gridlock.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> abbreviations{{
    {"psi6", "local_bond_orientation_order"},
    {"psi_6", "local_bond_orientation_order"},
    {"msd", "mean_squared_displacement"},
    {"vacf", "velocity_autocorrelation"},
    {"z", "compressibility_factor"},
    {"phi", "disks.packing_fraction"},
    {"n", "disks.count"},
    {"dt", "engine.time_step"},
    {"k", "engine.cells"},
    {"g(r)", "pair_correlation"},
    {"gr", "pair_correlation"},
    {"rdf", "pair_correlation"},
}};

std::optional<std::string> name_of_abbreviation(std::string key) {
  std::ranges::transform(key, key.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  auto const found = std::ranges::find(abbreviations, key, [](auto const& entry) { return entry.first; });
  return found == abbreviations.end() ? std::nullopt : std::optional<std::string>(found->second);
}

/// A column of a table or an entry of summary.json that only some runs write.
struct ColumnElsewhere {
  ColumnInfo column;
  std::string where;                     ///< "column of series.csv"
  std::vector<std::string> models = {};  ///< models with this column; empty: all
};

/// Returns the columns of measured curves, from a short run that has all of them.
std::vector<ColumnElsewhere> columns_of_curves() {
  Configuration configuration;
  configuration.disks = {.count = 16, .packing_fraction = 0.3};
  configuration.run.steps = 2;
  configuration.observe = settings_of_all_observables();
  Configuration of_exact_disks = configuration;
  of_exact_disks.box.edge = Edge::periodic;
  of_exact_disks.engine.kind = "exact";
  of_exact_disks.run.steps = 50;
  of_exact_disks.observe = {
      .every = 1, .equilibration = 0.0, .structure_every = 0, .viscosity_lag = 3, .free_flights = true};
  std::vector<ColumnElsewhere> columns;
  auto const add = [&](Distribution const& distribution) {
    for (ColumnInfo const& column : distribution.columns)
      columns.push_back({column, fmt::format("column of {}.csv", distribution.name)});
  };
  for (Distribution const& distribution : simulate(set_up(configuration)).distributions) add(distribution);
  for (Distribution const& distribution : simulate(set_up(of_exact_disks)).distributions) {
    bool const is_new = distribution.name == "stress_growth" || distribution.name.starts_with("free_");
    if (is_new) add(distribution);
  }
  return columns;
}

/// Returns the columns that models add to the series with default settings; models that cannot run with them are left
/// out.
std::vector<ColumnElsewhere> columns_of_models() {
  std::vector<ColumnElsewhere> columns;
  Configuration const known;
  for (auto const& kind : known.models.all()) {
    Configuration configuration;
    configuration.model.kind = kind->name();
    try {
      for (ColumnInfo const& column : set_up(configuration).simulation->columns()) {
        columns.push_back({column, "column of series.csv", {std::string(kind->name())}});
      }
    } catch (Error const&) {
      continue;
    }
  }
  return columns;
}

/// Returns the results and columns that a protocol adds.
std::vector<ColumnElsewhere> columns_of_protocols() {
  std::vector<ColumnElsewhere> columns;
  for (ColumnInfo const& entry : protocol_results())
    columns.push_back({entry, "entry of summary.json after a protocol"});
  for (Distribution const& table : protocol_tables()) {
    for (ColumnInfo const& column : table.columns)
      columns.push_back({column, fmt::format("column of {}.csv", table.name)});
  }
  return columns;
}

/// Returns all columns that are not among measured_columns().
std::vector<ColumnElsewhere> columns_elsewhere() {
  std::vector<ColumnInfo> const everywhere = measured_columns();
  std::vector<ColumnElsewhere> columns = columns_of_models();
  std::ranges::move(columns_of_curves(), std::back_inserter(columns));
  std::ranges::move(columns_of_protocols(), std::back_inserter(columns));
  std::erase_if(columns, [&](ColumnElsewhere const& elsewhere) {
    return std::ranges::find(everywhere, elsewhere.column.name, &ColumnInfo::name) != everywhere.end();
  });
  return columns;
}

std::string explained_elsewhere(std::string_view key) {
  std::vector<ColumnElsewhere> told;
  for (ColumnElsewhere& column : columns_elsewhere()) {
    if (column.column.name != key && key != "observables") continue;
    // Models with the same column and documentation share one entry.
    auto const same = std::ranges::find_if(told, [&](ColumnElsewhere const& other) {
      return other.column.name == column.column.name && other.where == column.where &&
             other.column.documentation == column.column.documentation;
    });
    if (same == told.end()) {
      told.push_back(std::move(column));
    } else {
      std::ranges::move(column.models, std::back_inserter(same->models));
    }
  }
  std::string text;
  for (auto const& [column, where, models] : told) {
    std::string const of_models = models.empty() ? "" : fmt::format(" of the model {}", fmt::join(models, ", "));
    text += fmt::format("{}{}", text.empty() ? "" : "\n", explained(column, where + of_models));
  }
  for (EngineRecord const& engine : engine_records()) {
    if (engine.name == key) text += fmt::format("{}\n    {}\n    a value of engine.kind\n", key, engine.documentation);
  }
  return text;
}

/// Returns all names that contain the word, or else the nearest name; empty if there is none.
std::string meant_by(std::string const& key) {
  Configuration configuration;
  std::vector<std::string> names;
  for (ColumnInfo const& column : measured_columns()) names.push_back(column.name);
  for (ColumnElsewhere const& column : columns_elsewhere()) names.push_back(column.column.name);
  std::string const nearest_column = nearest_name(key, names);
  for (std::string& setting : setting_keys(describing(configuration))) names.push_back(std::move(setting));
  constexpr std::size_t min_letters = 3;
  std::erase_if(
      names, [&](std::string const& name) { return key.size() < min_letters || name.find(key) == std::string::npos; });
  if (names.empty()) {
    std::string nearest = nearest_setting(describing(configuration), key);
    return nearest.empty() ? nearest_column : nearest;
  }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Throws an Error with the present name of a setting or column of earlier versions, or with the substitute for a
/// former model.
void refuse_former_name(std::string const& key) {
  Configuration configuration;
  std::string const table = key.substr(0, key.find('.'));
  if (auto const instead = instead_of_model(table); instead && configuration.models.find(table) == nullptr)
    throw Error({.what = fmt::format("there is no model \"{}\" in this program", table), .hint = *instead});
  std::optional<std::string> present = renamed_setting(describing(configuration), key);
  for (ColumnInfo const& column : measured_columns()) {
    if (!column.former_name.empty() && column.former_name == key) present = column.name;
  }
  if (!present) return;
  throw Error({.what = fmt::format("{} was renamed to {}", key, *present),
               .hint = fmt::format("gridlock explain {} says what it is", *present)});
}

/// Returns whether a key is the last part of a setting, as "speed" of engine.speed. A column may have the same name.
bool is_last_part(Configuration& configuration, std::string const& key) {
  std::string const last = "." + key;
  std::vector<std::string> const settings = setting_keys(describing(configuration));
  return std::ranges::any_of(settings, [&](std::string const& setting) { return setting.ends_with(last); });
}

/// Returns the explanation of a stage such as "grow"; empty for other words.
std::string explained_stage(std::string const& key) {
  for (std::string const& kind : stage_kinds()) {
    if (kind != key) continue;
    Configuration configuration;
    return fmt::format("{} is a stage of a [[protocol]]; gridlock explain protocol lists its settings\n\n{}", key,
                       explain(describing(configuration), "protocol.stage"));
  }
  return "";
}

/// Returns the explanation of the temperature, which a thermostat or the first velocities set; empty for other words.
std::string explained_temperature(std::string const& key) {
  if (key != "temperature" && key != "kT" && key != "kt") return "";
  Configuration configuration;
  auto const settings = describing(configuration);
  return fmt::format(
      "{} is set by a thermostat; without one kT is the mean kinetic energy of a disk, kinetic_energy / N, and follows "
      "from masses and speeds\n\n{}\n{}",
      key, explain(settings, "thermostat.temperature"), explain(settings, "velocities"));
}

/// Returns the explanation of a word that users look for although it is no name in Gridlock; empty for other words.
std::string explained_word(std::string const& key) {
  if (key == "sweep") {
    return "[sweep] lists values of settings, such as run.seed = [1, 2, 3], and gridlock sweep makes a run of every "
           "combination\n";
  }
  auto const lacking = sentence_on_lacking(key);
  if (!lacking) return explained_stage(key);
  std::string const names = meant_by(key);
  return fmt::format("{}\n{}", *lacking, names.empty() ? "" : fmt::format("names near to it: {}\n", names));
}

/// Returns the explanation of a setting, table, column, engine, abbreviation or another word that users look for.
/// Errors: Error for other words.
std::string explained(std::string const& key) {
  if (std::string temperature = explained_temperature(key); !temperature.empty()) return temperature;
  if (auto const name = name_of_abbreviation(key)) return fmt::format("{} is {}\n\n{}", key, *name, explained(*name));
  std::string text = explained_observables(key);
  if (key == "observables") return fmt::format("{}\n{}", text, explained_elsewhere(key));
  if (!text.empty()) return text;
  refuse_former_name(key);
  Configuration configuration;
  try {
    text = explain(describing(configuration), key);
    if (!is_last_part(configuration, key)) return text;
  } catch (Error const&) {
    text.clear();
  }
  std::string const elsewhere = explained_elsewhere(key);
  if (!text.empty() && !elsewhere.empty()) text += '\n';
  text += elsewhere;
  if (text.empty()) text = explained_word(key);
  if (!text.empty()) return text;
  std::string const names = meant_by(key);
  throw Error({.what = fmt::format("there is no setting and no column \"{}\"", key),
               .hint = names.empty() ? "gridlock explain lists all settings, gridlock explain observables all columns"
                                     : fmt::format("did you mean {}?", names)});
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
