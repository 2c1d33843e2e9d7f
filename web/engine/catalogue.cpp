#include "catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "gridlock/engine/engine.hpp"

namespace gridlock::web {

namespace {

/// Returns a number, or null for infinity and NaN, which JSON lacks.
Json finite(double number) { return std::isfinite(number) ? Json(number) : Json(); }

template <class Value>
Json json_of(std::optional<Value> const& value) {
  return value ? Json(*value) : Json();
}

/// Calls take(path, info, kind, value, choices) for every setting, also for lists of tables.
class Walk final : public SettingVisitor {
 public:
  using Take = std::function<void(std::string const& path, SettingInfo const& info, char const* kind, Json value,
                                  std::vector<std::string> const& choices)>;

  explicit Walk(Take take, bool enters_empty_lists) : take_(std::move(take)), enters_empty_lists_(enters_empty_lists) {}

  void enter(std::string_view name, std::string_view /*documentation*/) override {
    tables_.push_back(tables_.back() + std::string(name) + ".");
  }
  void leave() override { tables_.pop_back(); }

  void visit(SettingInfo const& info, double& value) override { take(info, "number", finite(value)); }
  void visit(SettingInfo const& info, std::optional<double>& value) override { take(info, "number", json_of(value)); }
  void visit(SettingInfo const& info, std::uint64_t& value) override { take(info, "integer", value); }
  void visit(SettingInfo const& info, std::optional<std::uint64_t>& value) override {
    take(info, "integer", json_of(value));
  }
  void visit(SettingInfo const& info, bool& value) override { take(info, "switch", value); }
  void visit(SettingInfo const& info, std::string& value) override { take(info, "text", value); }
  void visit(SettingInfo const& info, std::vector<double>& value) override { take(info, "numbers", value); }
  void visit_choice(SettingInfo const& info, std::span<std::string_view const> choices, std::size_t& value) override {
    take(info, "choice", value < choices.size() ? Json(choices[value]) : Json(), {choices.begin(), choices.end()});
  }
  void visit_tables(SettingInfo const& info, std::size_t size, std::function<void(std::size_t)> const& resize,
                    std::function<void(std::size_t, SettingVisitor&)> const& describe_one) override {
    take(info, "tables", size);
    std::string const path = tables_.back() + std::string(info.key);
    if (enters_empty_lists_) {
      // Only an entry of the list describes its settings, so an empty list gets one entry for a moment.
      if (size == 0) resize(1);
      visit_entry(path + "[]", 0, describe_one);
      if (size == 0) resize(0);
      return;
    }
    for (std::size_t k = 0; k < size; ++k) visit_entry(path + "[" + std::to_string(k) + "]", k, describe_one);
  }

 private:
  void visit_entry(std::string const& path, std::size_t k,
                   std::function<void(std::size_t, SettingVisitor&)> const& describe_one) {
    tables_.push_back(path + ".");
    describe_one(k, *this);
    tables_.pop_back();
  }
  void take(SettingInfo const& info, char const* kind, Json value, std::vector<std::string> const& choices = {}) {
    take_(tables_.back() + std::string(info.key), info, kind, std::move(value), choices);
  }

  Take take_;
  bool enters_empty_lists_;
  std::vector<std::string> tables_{""};
};

/// Returns the allowed words of a setting; for some settings the list is known only at run time.
std::vector<std::string> words_of(std::string const& path, std::vector<std::string> const& choices) {
  if (path == "engine.kind") return engine_kinds();
  if (path != "model.kind") return choices;
  std::vector<std::string> names;
  ModelKinds const models = known_models();
  for (auto const& model : models.all()) names.emplace_back(model->name());
  return names;
}

std::string table_of(std::string const& path) {
  std::size_t const point = path.rfind('.');
  return point == std::string::npos ? "" : path.substr(0, point);
}

}  // namespace

Json describe_settings() {
  Json all = Json::array();
  Configuration configuration;
  Walk walk(
      [&](std::string const& path, SettingInfo const& info, char const* kind, Json value,
          std::vector<std::string> const& choices) {
        bool const has_default = std::string_view(kind) != "tables" && info.default_note.empty();
        all.push_back({{"key", path},
                       {"table", table_of(path)},
                       {"kind", kind},
                       {"unit", info.unit},
                       {"documentation", info.documentation},
                       {"least", finite(info.min)},
                       {"most", finite(info.max)},
                       {"leastIsAllowed", info.min_is_allowed},
                       {"mostIsAllowed", info.max_is_allowed},
                       {"default", has_default ? std::move(value) : Json()},
                       {"defaultNote", info.default_note},
                       {"choices", words_of(path, choices)}});
      },
      true);
  describe(configuration, walk);
  return all;
}

Json describe_models() {
  Json all = Json::array();
  ModelKinds const models = known_models();
  for (auto const& model : models.all()) {
    all.push_back({{"name", model->name()}, {"documentation", model->documentation()}});
  }
  return all;
}

Json describe_engines() {
  Json all = Json::array();
  for (EngineRecord const& engine : engine_records()) {
    all.push_back({{"name", engine.name}, {"documentation", engine.documentation}});
  }
  return all;
}

Json values_of(Configuration& configuration) {
  Json values = Json::object();
  Walk walk([&](std::string const& path, SettingInfo const& /*info*/, char const* /*kind*/, Json value,
                std::vector<std::string> const& /*choices*/) { values[path] = std::move(value); },
            false);
  describe(configuration, walk);
  return values;
}

SettingsFile settings_of(std::string const& toml, std::vector<std::string> const& overrides) {
  SettingsFile file = SettingsFile::from_text(toml, "set-up");
  for (std::string const& assignment : overrides) file.set(assignment);
  return file;
}

std::string given_settings(SettingsFile const& file) {
  Configuration configuration = read_configuration(file);
  Describe const describe_all = describing(configuration);
  std::vector<std::string> keys;
  Walk walk(
      [&](std::string const& path, SettingInfo const& /*info*/, char const* /*kind*/, Json const& /*value*/,
          std::vector<std::string> const& /*choices*/) {
        bool const is_in_list = path.find('[') != std::string::npos;
        if (!is_in_list && file.is_given(path)) keys.push_back(path);
      },
      false);
  describe_all(walk);
  std::string text;
  for (std::string const& key : keys) {
    std::string const value = value_in_toml(describe_all, key);
    if (!value.empty()) text += key + " = " + value + "\n";
  }
  return text;
}

}  // namespace gridlock::web
