#pragma once

/// \file
/// How a struct describes its settings: key, unit, bounds and documentation of each.
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

/// Everything a reader of the documentation wants to know of one setting.
struct SettingInfo {
  std::string_view key;            ///< within its table, for example "packing_fraction"
  std::string_view unit;           ///< empty for pure numbers and words
  std::string_view documentation;  ///< one sentence
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_is_allowed = true;  ///< whether `min` itself is a value
  bool max_is_allowed = true;
  std::string_view default_note = {};  ///< what leaving it out means, where that is no fixed value
  std::string_view former_key = {};    ///< its name in earlier versions, which is refused with the new one
};

/// Receives every setting of an aggregate, one call each, in the order they are documented.
///
/// An aggregate describes itself once, in `void describe(Settings&, SettingVisitor&)`; reading TOML, --set, writing the
/// resolved configuration, `gridlock explain` and the reference page are visitors, so that none of them can drift
/// apart.
class SettingVisitor {
 public:
  virtual ~SettingVisitor() = default;

  /// The settings visited until the matching leave() stand in the table `[name]`.
  virtual void enter(std::string_view name, std::string_view documentation) = 0;
  virtual void leave() = 0;

  virtual void visit(SettingInfo const& info, double& value) = 0;
  virtual void visit(SettingInfo const& info, std::optional<double>& value) = 0;
  virtual void visit(SettingInfo const& info, std::uint64_t& value) = 0;
  virtual void visit(SettingInfo const& info, std::optional<std::uint64_t>& value) = 0;
  virtual void visit(SettingInfo const& info, bool& value) = 0;
  virtual void visit(SettingInfo const& info, std::string& value) = 0;
  virtual void visit(SettingInfo const& info, std::vector<double>& value) = 0;
  /// One of a fixed list of words; value is its place in the list.
  virtual void visit_choice(SettingInfo const& info, std::span<std::string_view const> choices, std::size_t& value) = 0;
  /// An array of tables: the visitor calls resize(n) when it reads n of them, and describe_one(k) for each.
  virtual void visit_tables(SettingInfo const& info, std::size_t size, std::function<void(std::size_t)> const& resize,
                            std::function<void(std::size_t, SettingVisitor&)> const& describe_one) = 0;
};

/// Visits an enumeration whose values are 0, 1, 2 … in the order of `choices`.
template <class Choice>
requires std::is_enum_v<Choice>
void visit_enum(SettingVisitor& visitor, SettingInfo const& info, std::span<std::string_view const> choices,
                Choice& value) {
  auto place = static_cast<std::size_t>(value);
  visitor.visit_choice(info, choices, place);
  value = static_cast<Choice>(place);
}

}  // namespace gridlock
