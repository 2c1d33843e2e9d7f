#include "workspace/sweep_plan.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <xxhash.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "io/file.hpp"
#include "io/text.hpp"
#include "simulation/settings_difference.hpp"
#include "workspace/result_files.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t max_runs = 100'000;
constexpr std::size_t longest_name = 120;

std::string last_part(std::string const& key) { return key.substr(key.rfind('.') + 1); }

bool is_safe(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+' || c == '_';
}

/// Returns a value without the quotes of a TOML string.
std::string_view without_quotes(std::string_view value) {
  bool const is_quoted =
      value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front();
  return is_quoted ? value.substr(1, value.size() - 2) : value;
}

/// Returns a hash of all values. The separator is escaped in texts of TOML, so 1 beside 23 differs from 12 beside 3.
std::string mark_of(std::vector<std::string> const& values) {
  std::string all;
  for (std::string const& value : values) all += value + '\n';
  return fmt::format("_{:016x}", XXH3_64bits(all.data(), all.size()));
}

SettingLocation place_of(SettingList const& list, std::size_t value) {
  return value < list.value_locations.size() ? list.value_locations[value] : list.location;
}

/// Throws an Error if a list has a value twice, since means would count these runs twice.
void require_different_values(SettingList const& list) {
  std::set<std::string_view> seen;
  for (std::size_t choice = 0; choice < list.values.size(); ++choice) {
    if (seen.insert(without_quotes(list.values[choice])).second) continue;
    SettingLocation const where = place_of(list, choice);
    throw Error({.what = fmt::format("{} lists {} twice", list.key, list.values[choice]),
                 .hint = "list every value once",
                 .key = fmt::format("sweep.{}", list.key),
                 .file = where.file,
                 .line = where.line,
                 .column = where.column,
                 .source_line = where.source_line});
  }
}

/// Returns the values of all settings that the sweep does not vary.
std::map<std::string, std::string> base_of(SettingsFile const& file, std::vector<SettingList> const& lists) {
  Configuration configuration = read_configuration(file);
  bool const sweeps_models = std::ranges::find(lists, "model.kind", &SettingList::key) != lists.end();
  // Settings of other models have no effect on the run.
  if (!sweeps_models) configuration.models.keep_only(configuration.model.kind);
  SettingTexts base = setting_texts(to_toml(describing(configuration)), "");
  for (SettingList const& list : lists) base.erase(list.key);
  std::erase_if(base, [](auto const& setting) { return !affects_results(setting.first); });
  return base;
}

/// Reads every listed value once, so that an error in the last value is found before the first run.
void require_readable(SettingsFile const& file, std::vector<SettingList> const& lists) {
  std::vector<Problem> problems;
  auto const is_known = [&](Problem const& problem) {
    // A problem with a key is reported once, not for each of its values.
    return std::ranges::any_of(problems,
                               [&](Problem const& p) { return p.what == problem.what && p.line == problem.line; });
  };
  for (SettingList const& list : lists) {
    for (std::size_t choice = 0; choice < list.values.size(); ++choice) {
      SettingsFile settings = file;
      settings.set(list.key, list.values[choice], place_of(list, choice));
      try {
        static_cast<void>(read_configuration(settings));
      } catch (Error const& error) {
        std::ranges::copy_if(error.problems(), std::back_inserter(problems), std::not_fn(is_known));
      }
    }
  }
  if (!problems.empty()) throw Error(std::move(problems));
}

/// Throws if a run's name does not follow from its values; a hostile plan's names could lead to other directories.
void require_own_name(SweepRun const& run, std::vector<std::string> const& keys) {
  bool const is_plain =
      !run.name.empty() && std::ranges::all_of(run.name, [](char c) { return is_safe(c) || c == '='; });
  if (is_plain && run.name == sweep_run_name(keys, run.values)) return;
  throw std::runtime_error(fmt::format("{} is not the name of a run with its values", in_quotes(run.name)));
}

}  // namespace

std::string sweep_run_name(std::vector<std::string> const& keys, std::vector<std::string> const& values) {
  std::string name;
  bool is_complete = true;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (!name.empty()) name += '_';
    name += last_part(keys[k]) + '=';
    for (char const c : without_quotes(values[k])) {
      if (is_safe(c)) {
        name += c;
      } else {
        is_complete = false;
      }
    }
  }
  if (is_complete && name.size() <= longest_name) return name;
  std::string const mark = mark_of(values);
  return name.substr(0, longest_name - mark.size()) + mark;
}

std::filesystem::path directory_of(std::filesystem::path const& sweep, SweepRun const& run) {
  return sweep / "runs" / run.name;
}

namespace {

std::string text_of(SweepPlan const& plan) {
  Json json{{"keys", plan.keys}, {"base", plan.base}, {"runs", Json::array()}};
  for (SweepRun const& run : plan.runs) json["runs"].push_back({{"name", run.name}, {"values", run.values}});
  return json.dump(1) + '\n';
}

}  // namespace

void write_plan(SweepPlan const& plan, std::filesystem::path const& directory) {
  record_result(directory / sweep_plan_name);
  write_file(directory / sweep_plan_name, text_of(plan));
}

std::uint64_t hash_of(SweepPlan const& plan) {
  std::string const text = text_of(plan);
  return XXH3_64bits(text.data(), text.size());
}

SweepPlan read_plan(std::filesystem::path const& directory) {
  std::filesystem::path const path = directory / sweep_plan_name;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    throw Error({.what = fmt::format("{} holds no sweep: there is no {}", directory.string(), sweep_plan_name),
                 .hint = "name a directory that gridlock sweep has written"});
  }
  std::string const text = read_file(path);
  try {
    Json const json = Json::parse(text);
    SweepPlan plan{.keys = json.at("keys").get<std::vector<std::string>>(),
                   .base = json.at("base").get<std::map<std::string, std::string>>(),
                   .runs = {}};
    for (Json const& entry : json.at("runs")) {
      SweepRun run{.name = entry.at("name").get<std::string>(),
                   .values = entry.at("values").get<std::vector<std::string>>(),
                   .settings = {}};
      if (run.values.size() != plan.keys.size()) throw std::runtime_error("a run lacks values");
      require_own_name(run, plan.keys);
      plan.runs.push_back(std::move(run));
    }
    if (plan.runs.empty()) throw std::runtime_error("it lists no runs");
    return plan;
  } catch (std::exception const& error) {
    throw Error({.what = fmt::format("{} is damaged: {}", path.string(), error.what()),
                 .hint = "run the sweep again: it keeps the runs that are finished",
                 .file = path.string()});
  }
}

SweepPlan plan_sweep(SettingsFile file) {
  std::vector<SettingList> const lists = file.take_lists("sweep");
  if (lists.empty()) {
    throw Error({.what = "there is no table [sweep] with lists of values to try",
                 .hint = "add [sweep] with lines such as \"disks.packing_fraction\" = [0.1, 0.2], or use gridlock run",
                 .key = "sweep"});
  }
  require_readable(file, lists);
  std::ranges::for_each(lists, require_different_values);
  SweepPlan plan{.keys = {}, .base = base_of(file, lists), .runs = {}};
  std::size_t count = 1;
  for (SettingList const& list : lists) {
    plan.keys.push_back(list.key);
    if (list.values.size() > max_runs / count) {
      throw Error({.what = fmt::format("the sweep has more than {} runs", max_runs),
                   .hint = "list fewer values",
                   .key = "sweep"});
    }
    count *= list.values.size();
  }
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
    run.name = sweep_run_name(plan.keys, run.values);
    plan.runs.push_back(std::move(run));
  }
  return plan;
}

}  // namespace gridlock
