#include "workspace/sweep_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "workspace/result_files.hpp"

namespace gridlock {

namespace {

constexpr char const* seed_key = "run.seed";

/// Returns a value without the quotes of a TOML string.
std::string bare(std::string const& value) {
  bool const is_quoted =
      value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front();
  return is_quoted ? value.substr(1, value.size() - 2) : value;
}

double const not_measured = std::numeric_limits<double>::quiet_NaN();

/// Returns the names of the observables of all runs, in order of first appearance.
std::vector<std::string> observable_names(std::vector<SweepOutcome> const& outcomes) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (SweepOutcome const& outcome : outcomes) {
    for (NamedEstimate const& result : outcome.results) {
      if (seen.insert(result.name).second) names.push_back(result.name);
    }
  }
  return names;
}

/// Returns all values as numbers of one type; nothing if a value is not a number.
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

/// Returns a column of counts, or else numbers, or else words. A double would hold only 53 bits of a seed.
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

}  // namespace

SweepOutcome outcome_of(RunSummary const& summary) {
  return {.has_begun = true,
          .status = summary.status,
          .message = summary.failure,
          .state_hash = summary.state_hash,
          .seconds = summary.seconds,
          .results = summary.results};
}

Table rows_of(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes) {
  std::vector<std::size_t> runs(plan.runs.size());
  std::iota(runs.begin(), runs.end(), std::size_t{0});
  Table table;
  std::vector<std::string> names;
  std::vector<std::string> statuses;
  std::vector<std::string> hashes;
  std::vector<double> seconds;
  for (std::size_t const run : runs) {
    names.push_back(plan.runs[run].name);
    bool const is_known = outcomes[run].has_begun || outcomes[run].status == RunStatus::failed;
    statuses.emplace_back(is_known ? to_text(outcomes[run].status) : "not begun");
    hashes.push_back(outcomes[run].has_begun ? fmt::format("{:016x}", outcomes[run].state_hash) : "");
    seconds.push_back(outcomes[run].seconds);
  }
  table.add_column("run", names);
  add_key_columns(table, plan, runs, true);
  table.add_column("status", statuses);
  table.add_column("state_hash", hashes);
  table.add_column("seconds", seconds);
  for (std::string const& name : observable_names(outcomes)) {
    std::vector<double> values;
    std::vector<double> errors;
    for (SweepOutcome const& outcome : outcomes) {
      auto const estimate = outcome.find(name);
      values.push_back(estimate ? estimate->value : not_measured);
      errors.push_back(estimate ? estimate->error.value_or(not_measured) : not_measured);
    }
    table.add_column(name, values);
    table.add_column(name + "_error", errors);
  }
  return table;
}

namespace {

/// Groups runs that differ only in the seed, in the order of the plan.
std::vector<std::vector<std::size_t>> groups_of(SweepPlan const& plan) {
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
  return groups;
}

/// Returns the estimates of an observable in the runs of a group.
std::vector<Estimate> estimates_of(std::string const& name, std::vector<std::size_t> const& group,
                                   std::vector<SweepOutcome> const& outcomes) {
  std::vector<Estimate> estimates;
  for (std::size_t const run : group) {
    if (auto const estimate = outcomes[run].find(name)) estimates.push_back(*estimate);
  }
  return estimates;
}

/// Adds columns with mean and error of an observable, and the number of runs with a value if runs of a group lack one.
void add_means(std::string const& name, std::vector<std::vector<std::size_t>> const& groups,
               std::vector<SweepOutcome> const& outcomes, Table& table) {
  std::vector<double> values;
  std::vector<double> errors;
  std::vector<std::uint64_t> runs;
  bool has_gaps = false;
  for (auto const& group : groups) {
    std::vector<Estimate> const estimates = estimates_of(name, group, outcomes);
    Estimate const mean = estimates.empty() ? Estimate{.value = not_measured} : combine(estimates).mean;
    values.push_back(mean.value);
    errors.push_back(mean.error.value_or(not_measured));
    runs.push_back(estimates.size());
    has_gaps = has_gaps || (!estimates.empty() && estimates.size() < group.size());
  }
  table.add_column(name, values);
  table.add_column(name + "_error", errors);
  if (has_gaps) table.add_column(name + "_runs", runs);
}

/// Returns notes on runs that means leave out, and on runs in the means that missed the goal of their protocol.
std::vector<std::string> notes_on_means(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes) {
  std::vector<std::string> notes;
  for (std::string const& name : observable_names(outcomes)) {
    std::size_t left_out = 0;
    std::size_t all = 0;
    for (auto group : groups_of(plan)) {
      std::erase_if(group, [&](std::size_t run) { return outcomes[run].status != RunStatus::finished; });
      std::size_t const known = estimates_of(name, group, outcomes).size();
      // No note is needed if no run of a group measures the observable, for example because their engine does not.
      if (known == 0) continue;
      left_out += group.size() - known;
      all += group.size();
    }
    if (left_out == 0) continue;
    notes.push_back(
        fmt::format("{0} has no value in {1} of {2} runs, which its means leave out; {0}_runs in means.csv "
                    "says how many have one",
                    name, left_out, all));
  }
  auto const short_of_goal = std::ranges::count_if(outcomes, [](SweepOutcome const& outcome) {
    auto const flag = outcome.find("is_converged");
    return flag && flag->value == 0.0;
  });
  if (short_of_goal > 0) {
    notes.push_back(fmt::format(
        "{} of {} runs ended short of the goal of their protocol and count in the means; their is_converged is 0",
        short_of_goal, outcomes.size()));
  }
  return notes;
}

}  // namespace

Table means_of(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes) {
  std::vector<std::vector<std::size_t>> groups = groups_of(plan);
  std::vector<std::size_t> first_runs;
  std::vector<std::uint64_t> sizes;
  for (auto& group : groups) {
    first_runs.push_back(group.front());
    std::erase_if(group, [&](std::size_t run) { return outcomes[run].status != RunStatus::finished; });
    sizes.push_back(group.size());
  }
  Table table;
  add_key_columns(table, plan, first_runs, false);
  table.add_column("runs", sizes);
  for (std::string const& name : observable_names(outcomes)) add_means(name, groups, outcomes, table);
  return table;
}

SweepResult result_of(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes) {
  SweepResult result{.rows = rows_of(plan, outcomes),
                     .means = means_of(plan, outcomes),
                     .messages = {},
                     .notes = notes_on_means(plan, outcomes)};
  for (std::size_t run = 0; run < plan.runs.size(); ++run) {
    SweepOutcome const& outcome = outcomes[run];
    if (outcome.status == RunStatus::failed) {
      ++result.failures;
      result.messages.push_back(fmt::format("{}: {}", plan.runs[run].name, outcome.message));
    }
    if (outcome.status == RunStatus::interrupted) ++result.interruptions;
  }
  return result;
}

void write_tables(SweepResult const& result, std::filesystem::path const& directory) {
  for (char const* name : {"sweep.csv", "means.csv"}) record_result(directory / name);
  write_csv(result.rows, directory / "sweep.csv");
  write_csv(result.means, directory / "means.csv");
}

}  // namespace gridlock
