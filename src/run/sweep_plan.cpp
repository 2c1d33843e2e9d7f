#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <iterator>
#include <set>

#include "gridlock/core/error.hpp"
#include "gridlock/run/configuration.hpp"
#include "gridlock/run/sweep.hpp"

namespace gridlock {

namespace {

constexpr std::size_t most_runs = 100'000;
constexpr std::size_t longest_name = 120;

std::string last_part(std::string const& key) { return key.substr(key.rfind('.') + 1); }

/// "packing_fraction=0.7_start=square": safe as the name of a directory on every file system.
std::string readable_name(std::vector<std::string> const& keys, std::vector<std::string> const& values) {
  std::string name;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (!name.empty()) name += '_';
    name += last_part(keys[k]) + '=';
    for (char const c : values[k]) {
      bool const is_safe = std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+';
      if (is_safe) name += c;
    }
  }
  return name;
}

/// A name with a mark of the values in it, where the readable one would be too long or is taken. Names depend on the
/// values alone, so that a run keeps its own when the plan grows.
std::string marked_name(std::string const& readable, std::vector<std::string> const& values) {
  std::string all;
  for (std::string const& value : values) all += value + '\n';
  return fmt::format("{}_{:016x}", readable.substr(0, longest_name - 17), XXH3_64bits(all.data(), all.size()));
}

SettingLocation place_of(SettingList const& list, std::size_t value) {
  return value < list.value_locations.size() ? list.value_locations[value] : list.location;
}

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
    run.name = readable_name(plan.keys, run.values);
    bool const is_fine = run.name.size() <= longest_name && names.insert(run.name).second;
    if (!is_fine) run.name = marked_name(run.name, run.values);
    plan.runs.push_back(std::move(run));
  }
  return plan;
}

}  // namespace gridlock
