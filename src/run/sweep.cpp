#include "gridlock/run/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "gridlock/core/error.hpp"
#include "gridlock/io/file.hpp"
#include "gridlock/run/run_directory.hpp"
#include "gridlock/run/simulate.hpp"
#include "run/team.hpp"

namespace gridlock {

namespace {

constexpr char const* seed_key = "run.seed";
constexpr std::size_t most_runs = 100'000;
constexpr std::size_t longest_name = 120;

std::string last_part(std::string const& key) { return key.substr(key.rfind('.') + 1); }

/// "packing_fraction=0.7_start=square": safe as the name of a directory on every file system.
std::string name_of(std::vector<std::string> const& keys, std::vector<std::string> const& values, std::size_t number) {
  std::string name;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (!name.empty()) name += '_';
    name += last_part(keys[k]) + '=';
    for (char const c : values[k]) {
      bool const is_safe = std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+';
      if (is_safe) name += c;
    }
  }
  return name.size() <= longest_name ? name : fmt::format("{}_{}", name.substr(0, longest_name - 8), number);
}

SettingLocation place_of(SettingList const& list, std::size_t value) {
  return value < list.value_locations.size() ? list.value_locations[value] : list.location;
}

/// Values without the quotes of TOML strings, as a table shows them.
std::string bare(std::string const& value) {
  bool const is_quoted =
      value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front();
  return is_quoted ? value.substr(1, value.size() - 2) : value;
}

/// One finished run as the tables need it.
struct Outcome {
  bool has_begun = false;
  Ending ending = Ending::interrupted;
  std::string message;
  std::uint64_t state_hash = 0;
  double seconds = 0.0;
  std::vector<NamedEstimate> results;

  [[nodiscard]] std::optional<Estimate> find(std::string const& name) const {
    auto const found = std::ranges::find(results, name, &NamedEstimate::name);
    return found == results.end() ? std::nullopt : std::optional(found->estimate);
  }
};

double const not_measured = std::numeric_limits<double>::quiet_NaN();

/// The names of all observables any run has, in the order of their first appearance.
std::vector<std::string> observable_names(std::vector<Outcome> const& outcomes) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (Outcome const& outcome : outcomes) {
    for (NamedEstimate const& result : outcome.results) {
      if (seen.insert(result.name).second) names.push_back(result.name);
    }
  }
  return names;
}

/// All values as numbers of one type; nothing where one of them is none.
template <class Number>
std::optional<std::vector<Number>> numbers_of(std::vector<std::string> const& values) {
  std::vector<Number> numbers;
  for (std::string const& value : values) {
    Number number{};
    char const* const end = value.data() + value.size();
    auto const [stop, error] = std::from_chars(value.data(), end, number);
    if (error != std::errc{} || stop != end) return std::nullopt;
    numbers.push_back(number);
  }
  return numbers;
}

/// A column of counts, else of numbers, else of words. Counts come first: a seed has 64 bits, a double 53.
CellColumn column_of(std::vector<std::string> const& values) {
  if (auto counts = numbers_of<std::uint64_t>(values)) return *std::move(counts);
  if (auto numbers = numbers_of<double>(values)) return *std::move(numbers);
  return values;
}

void add_key_columns(Table& table, SweepPlan const& plan, std::vector<std::size_t> const& runs, bool with_seed) {
  for (std::size_t k = 0; k < plan.keys.size(); ++k) {
    if (!with_seed && plan.keys[k] == seed_key) continue;
    std::vector<std::string> values;
    for (std::size_t const run : runs) values.push_back(bare(plan.runs[run].values[k]));
    table.add_column(plan.keys[k], column_of(values));
  }
}

Table rows_of(SweepPlan const& plan, std::vector<Outcome> const& outcomes) {
  std::vector<std::size_t> runs(plan.runs.size());
  std::iota(runs.begin(), runs.end(), std::size_t{0});
  Table table;
  std::vector<std::string> names;
  std::vector<std::string> endings;
  std::vector<std::string> hashes;
  std::vector<double> seconds;
  for (std::size_t const run : runs) {
    names.push_back(plan.runs[run].name);
    bool const is_known = outcomes[run].has_begun || outcomes[run].ending == Ending::failed;
    endings.emplace_back(is_known ? to_text(outcomes[run].ending) : "not begun");
    hashes.push_back(outcomes[run].has_begun ? fmt::format("{:016x}", outcomes[run].state_hash) : "");
    seconds.push_back(outcomes[run].seconds);
  }
  table.add_column("run", names);
  add_key_columns(table, plan, runs, true);
  table.add_column("ending", endings);
  table.add_column("state_hash", hashes);
  table.add_column("seconds", seconds);
  for (std::string const& name : observable_names(outcomes)) {
    std::vector<double> values;
    std::vector<double> errors;
    for (Outcome const& outcome : outcomes) {
      auto const estimate = outcome.find(name);
      values.push_back(estimate ? estimate->value : not_measured);
      errors.push_back(estimate ? estimate->error.value_or(not_measured) : not_measured);
    }
    table.add_column(name, values);
    table.add_column(name + "_error", errors);
  }
  return table;
}

/// Mean over runs with its standard error from their scatter; a single run keeps its own error.
Estimate mean_over(std::vector<Estimate> const& runs) {
  if (runs.empty()) return {.value = not_measured};
  if (runs.size() == 1) return runs.front();
  double const count = static_cast<double>(runs.size());
  double mean = 0.0;
  for (Estimate const& run : runs) mean += run.value / count;
  double squares = 0.0;
  for (Estimate const& run : runs) squares += (run.value - mean) * (run.value - mean);
  return {mean, std::sqrt(squares / (count * (count - 1.0)))};
}

Table means_of(SweepPlan const& plan, std::vector<Outcome> const& outcomes) {
  // Runs that agree in everything but the seed, in the order of the plan.
  std::vector<std::vector<std::size_t>> groups;
  std::map<std::vector<std::string>, std::size_t> group_of;
  for (std::size_t run = 0; run < plan.runs.size(); ++run) {
    std::vector<std::string> values;
    for (std::size_t k = 0; k < plan.keys.size(); ++k) {
      if (plan.keys[k] != seed_key) values.push_back(plan.runs[run].values[k]);
    }
    auto const [place, is_new] = group_of.try_emplace(values, groups.size());
    if (is_new) groups.emplace_back();
    groups[place->second].push_back(run);
  }
  std::vector<std::size_t> first_runs;
  std::vector<std::uint64_t> sizes;
  for (auto& group : groups) {
    first_runs.push_back(group.front());
    std::erase_if(group, [&](std::size_t run) { return outcomes[run].ending != Ending::finished; });
    sizes.push_back(group.size());
  }
  Table table;
  add_key_columns(table, plan, first_runs, false);
  table.add_column("runs", sizes);
  for (std::string const& name : observable_names(outcomes)) {
    std::vector<double> values;
    std::vector<double> errors;
    for (auto const& group : groups) {
      std::vector<Estimate> estimates;
      for (std::size_t const run : group) {
        if (auto const estimate = outcomes[run].find(name)) estimates.push_back(*estimate);
      }
      Estimate const mean = mean_over(estimates);
      values.push_back(mean.value);
      errors.push_back(mean.error.value_or(not_measured));
    }
    table.add_column(name, values);
    table.add_column(name + "_error", errors);
  }
  return table;
}

/// The work of a run in disk-steps, as far as its settings tell: only for the order and the progress.
double cost_of(Setup const& setup) {
  RunSettings const& run = setup.configuration.run;
  double const disks = static_cast<double>(setup.state.disks.size());
  double const duration = step_duration(setup.configuration.engine, setup.state);
  double steps = std::numeric_limits<double>::infinity();
  if (run.steps) steps = std::min(steps, static_cast<double>(*run.steps));
  if (run.time) steps = std::min(steps, *run.time / duration);
  // A disk of a dense fluid collides a few times while it travels ten of the default time steps.
  if (run.collisions_per_disk) steps = std::min(steps, *run.collisions_per_disk * 3.0);
  return disks * steps + 1.0;
}

/// A sweep being carried out.
class SweepInProgress {
 public:
  SweepInProgress(SweepPlan const& plan, SweepSettings const& settings)
      : plan_(plan), settings_(settings), outcomes_(plan.runs.size()), errors_(plan.runs.size()) {}

  void run() {
    std::vector<double> const costs = estimate_costs();
    require_one_good();
    open_run_directory(settings_.directory, settings_.overwrites);
    auto const start = std::chrono::steady_clock::now();
    Team team(costs, [&](double fraction, std::size_t finished) {
      double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      return !settings_.on_progress ||
             settings_.on_progress(
                 {.finished = finished, .all = plan_.runs.size(), .fraction = fraction, .seconds = seconds});
    });
    team.run_all(settings_.threads, [&](std::size_t run) {
      if (!errors_[run]) outcomes_[run] = carry_out(run, team);
    });
  }

  [[nodiscard]] std::vector<Outcome> const& outcomes() const { return outcomes_; }

 private:
  /// Sets up every run once, for its cost and to know which cannot be made.
  std::vector<double> estimate_costs() {
    std::vector<double> costs(plan_.runs.size(), 0.0);
    tbb::parallel_for(std::size_t{0}, plan_.runs.size(), [&](std::size_t run) {
      try {
        costs[run] = cost_of(set_up(plan_.runs[run].settings));
      } catch (Error const& error) {
        errors_[run] = error;
        outcomes_[run] = {.has_begun = false, .ending = Ending::failed, .message = error.what()};
      }
    });
    return costs;
  }

  /// A mistake that spoils every run is the user's input, not a failure of some runs.
  void require_one_good() const {
    bool const is_one_good = std::ranges::any_of(errors_, [](auto const& error) { return !error; });
    if (!is_one_good) throw *errors_.front();
  }

  Outcome carry_out(std::size_t run, Team& team) const {
    try {
      Setup const setup = set_up(plan_.runs[run].settings);
      auto const directory = settings_.directory / "runs" / plan_.runs[run].name;
      RunRecord const record =
          run_in(directory, setup,
                 {.on_progress = [&](Progress const& progress) { return team.report(run, progress.fraction); },
                  .on_note = {},
                  .threads = std::nullopt});
      return {.has_begun = true,
              .ending = record.ending,
              .message = record.failure,
              .state_hash = record.state_hash,
              .seconds = record.seconds,
              .results = record.results};
    } catch (std::exception const& error) {
      return {.has_begun = true, .ending = Ending::failed, .message = error.what()};
    }
  }

  SweepPlan const& plan_;
  SweepSettings const& settings_;
  std::vector<Outcome> outcomes_;
  std::vector<std::optional<Error>> errors_;
};

/// Reads every listed value once, so that a slip in the last one does not show after hours.
void require_readable(SettingsFile const& file, std::vector<SettingList> const& lists) {
  std::vector<Problem> problems;
  auto const is_known = [&](Problem const& problem) {
    // An unknown key is wrong once, not once for each of its values.
    return std::ranges::any_of(problems,
                               [&](Problem const& p) { return p.what == problem.what && p.line == problem.line; });
  };
  for (SettingList const& list : lists) {
    for (std::size_t choice = 0; choice < list.values.size(); ++choice) {
      SettingsFile settings = file;
      settings.set(list.key, list.values[choice], place_of(list, choice));
      Configuration configuration;
      try {
        settings.read_into(describing(configuration));
      } catch (Error const& error) {
        std::ranges::copy_if(error.problems(), std::back_inserter(problems), std::not_fn(is_known));
      }
    }
  }
  if (!problems.empty()) throw Error(std::move(problems));
}

}  // namespace

SweepPlan plan_sweep(SettingsFile file) {
  std::vector<SettingList> const lists = file.take_lists("sweep");
  if (lists.empty()) {
    throw Error({.what = "there is no table [sweep] with lists of values to try",
                 .hint = "add [sweep] with lines such as \"disks.packing_fraction\" = [0.1, 0.2], or use gridlock run",
                 .key = "sweep"});
  }
  require_readable(file, lists);
  SweepPlan plan;
  std::size_t count = 1;
  for (SettingList const& list : lists) {
    plan.keys.push_back(list.key);
    if (list.values.size() > most_runs / count) {
      throw Error({.what = fmt::format("the sweep has more than {} runs", most_runs),
                   .hint = "list fewer values",
                   .key = "sweep"});
    }
    count *= list.values.size();
  }
  std::set<std::string> names;
  for (std::size_t number = 0; number < count; ++number) {
    SweepRun run{.settings = file};
    std::size_t rest = number;
    run.values.resize(lists.size());
    for (std::size_t k = lists.size(); k-- > 0;) {
      std::size_t const choice = rest % lists[k].values.size();
      rest /= lists[k].values.size();
      run.values[k] = lists[k].values[choice];
      run.settings.set(lists[k].key, run.values[k], place_of(lists[k], choice));
    }
    run.name = name_of(plan.keys, run.values, number);
    if (!names.insert(run.name).second) run.name += fmt::format("_{}", number);
    plan.runs.push_back(std::move(run));
  }
  return plan;
}

SweepResult run_sweep(SweepPlan const& plan, SweepSettings const& settings) {
  SweepInProgress sweep(plan, settings);
  sweep.run();
  SweepResult result{.rows = rows_of(plan, sweep.outcomes()), .means = means_of(plan, sweep.outcomes())};
  for (std::size_t run = 0; run < plan.runs.size(); ++run) {
    Outcome const& outcome = sweep.outcomes()[run];
    if (outcome.ending == Ending::failed) {
      ++result.failures;
      result.messages.push_back(fmt::format("{}: {}", plan.runs[run].name, outcome.message));
    }
    if (outcome.ending == Ending::interrupted) ++result.interruptions;
  }
  write_csv(result.rows, settings.directory / "sweep.csv");
  write_csv(result.means, settings.directory / "means.csv");
  return result;
}

}  // namespace gridlock
