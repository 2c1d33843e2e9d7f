#include "simulation/settings_difference.hpp"

#include <fmt/format.h>

#include "io/toml_tree.hpp"

namespace gridlock {

namespace {

void add_settings(TomlValue const& table, std::string const& prefix, SettingTexts& texts) {
  for (std::size_t k = 0; k < table.items.size(); ++k) {
    std::string const key = prefix + table.names[k];
    if (table.items[k].is_table()) {
      add_settings(table.items[k], key + '.', texts);
    } else {
      texts.emplace(key, to_toml(table.items[k]));
    }
  }
}

std::string const& value_of(SettingTexts const& texts, std::string const& key) {
  static std::string const none;
  auto const found = texts.find(key);
  return found == texts.end() ? none : found->second;
}

}  // namespace

bool affects_results(std::string_view key) { return key != "engine.threads" && key != "engine.device"; }

SettingTexts setting_texts(std::string const& toml, std::string const& name) {
  SettingTexts texts;
  add_settings(parse_toml(toml, name), "", texts);
  return texts;
}

std::set<std::string> const& settings_of_length() {
  static std::set<std::string> const keys{"run.steps", "run.time", "run.collisions_per_disk", "observe.equilibration"};
  return keys;
}

std::optional<SettingDifference> find_difference(SettingTexts const& here, SettingTexts const& there,
                                                 std::set<std::string> const& ignored) {
  std::set<std::string> keys;
  for (SettingTexts const* texts : {&here, &there}) {
    for (auto const& [key, value] : *texts) keys.insert(key);
  }
  for (std::string const& key : keys) {
    if (!affects_results(key) || ignored.contains(key)) continue;
    SettingDifference difference{.key = key, .here = value_of(here, key), .there = value_of(there, key)};
    if (difference.here != difference.there) return difference;
  }
  return std::nullopt;
}

std::string to_text(SettingDifference const& difference, std::string const& here, std::string const& there) {
  auto const shown = [](std::string const& value) { return value.empty() ? std::string("left out") : value; };
  return fmt::format("{} is {} in {}, and {} in {}", difference.key, shown(difference.here), here,
                     shown(difference.there), there);
}

}  // namespace gridlock
