#pragma once

/// \file
/// A struct describes its settings: the key, unit, bounds and documentation of each.
///
/// ```cpp
/// struct Gas {
///   double temperature = 1.0;
///   void describe(SettingVisitor& visitor) {
///     visitor.visit({.key = "temperature", .documentation = "How hot the gas is.", .min = 0.0}, temperature);
///   }
/// };
/// ```

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace gridlock {

/// The description of one setting for the documentation.
struct SettingInfo {
  std::string_view key;            ///< without the table, for example "packing_fraction"
  std::string_view unit;           ///< empty for pure numbers and words
  std::string_view documentation;  ///< one sentence on what the setting does
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_is_allowed = true;  ///< whether the setting may equal `min`
  bool max_is_allowed = true;
  std::string_view default_note = {};  ///< the default in words, if it is no fixed value
  std::string_view former_key = {};    ///< the key in earlier versions; refused with an error that gives the new key
};

/// Visits every setting of a struct, one call each, in the order of the documentation.
///
/// A struct lists its settings once, in `void describe(Settings&, SettingVisitor&)`. Visitors read TOML and --set, and
/// write the resolved configuration, `gridlock explain` and the reference page, so that all of these always agree.
class SettingVisitor {
 public:
  virtual ~SettingVisitor() = default;

  /// Opens the table `[name]`: the settings visited until the matching leave() belong to it.
  virtual void enter(std::string_view name, std::string_view documentation) = 0;
  virtual void leave() = 0;

  virtual void visit(SettingInfo const& info, double& value) = 0;
  virtual void visit(SettingInfo const& info, std::optional<double>& value) = 0;
  virtual void visit(SettingInfo const& info, std::uint64_t& value) = 0;
  virtual void visit(SettingInfo const& info, std::optional<std::uint64_t>& value) = 0;
  virtual void visit(SettingInfo const& info, bool& value) = 0;
  virtual void visit(SettingInfo const& info, std::string& value) = 0;
  virtual void visit(SettingInfo const& info, std::vector<double>& value) = 0;
  /// Visits a setting whose value is a word of `choices`; `value` is the index of the word.
  virtual void visit_choice(SettingInfo const& info, std::span<std::string_view const> choices, std::size_t& value) = 0;
  /// Visits an array of tables: the visitor calls resize(n) when it reads n tables, and describe_one(k) for each table.
  virtual void visit_tables(SettingInfo const& info, std::size_t size, std::function<void(std::size_t)> const& resize,
                            std::function<void(std::size_t, SettingVisitor&)> const& describe_one) = 0;
};

/// Visits a setting that is an enumeration with the values 0, 1, 2 … in the order of `choices`.
template <class Choice>
requires std::is_enum_v<Choice>
void visit_enum(SettingVisitor& visitor, SettingInfo const& info, std::span<std::string_view const> choices,
                Choice& value) {
  auto place = static_cast<std::size_t>(value);
  visitor.visit_choice(info, choices, place);
  value = static_cast<Choice>(place);
}

}  // namespace gridlock
