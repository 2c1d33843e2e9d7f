#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/setting.hpp"
#include "io/toml_tree.hpp"

namespace gridlock {

/// Gives every visited setting its value from a tree of TOML; collects problems instead of stopping at the first.
class SettingsReader final : public SettingVisitor {
 public:
  explicit SettingsReader(TomlValue const& root);

  void enter(std::string_view name, std::string_view documentation) override;
  void leave() override;
  void visit(SettingInfo const& info, double& value) override;
  void visit(SettingInfo const& info, std::optional<double>& value) override;
  void visit(SettingInfo const& info, std::uint64_t& value) override;
  void visit(SettingInfo const& info, std::optional<std::uint64_t>& value) override;
  void visit(SettingInfo const& info, bool& value) override;
  void visit(SettingInfo const& info, std::string& value) override;
  void visit(SettingInfo const& info, std::vector<double>& value) override;
  void visit_choice(SettingInfo const& info, std::span<std::string_view const> choices, std::size_t& value) override;
  void visit_tables(SettingInfo const& info, std::size_t size, std::function<void(std::size_t)> const& resize,
                    std::function<void(std::size_t, SettingVisitor&)> const& describe_one) override;

  /// Returns all problems, also unknown keys, in the order of the file and then of --set.
  [[nodiscard]] std::vector<Problem> problems() const;

 private:
  /// A table that is being visited.
  struct Frame {
    TomlValue const* table = nullptr;  ///< null if the file does not have the table
    std::string path;                  ///< "disks.species[1]"; empty for the root
    std::string kind;                  ///< "disks.species[]", equal for all entries of a list
  };

  TomlValue const* take(std::string_view key);
  TomlValue const* take(SettingInfo const& info);
  [[nodiscard]] std::string path_of(std::string_view key) const;
  void report(TomlValue const& value, std::string const& path, std::string what, std::string hint);
  void report_type(TomlValue const& value, std::string const& path, std::string const& expected, std::string hint = "");
  bool read_number(TomlValue const& value, std::string const& path, SettingInfo const& info, double& number);
  bool read_count(TomlValue const& value, std::string const& path, SettingInfo const& info, std::uint64_t& count);
  bool is_within_bounds(TomlValue const& value, std::string const& path, SettingInfo const& info, double number);
  void report_unknown(TomlValue const& table, Frame const& frame, std::vector<Problem>& found) const;
  [[nodiscard]] Problem unknown(TomlValue const& member, std::string const& name, Frame const& frame) const;

  std::vector<Frame> frames_;
  std::set<TomlValue const*> taken_;
  std::map<std::string, std::vector<std::string>> names_;  ///< names of visited settings, by kind of table
  std::map<std::string, std::string> renamed_;             ///< from former to present dotted keys
  std::set<std::string> tables_;                           ///< kinds of all tables that were entered
  std::vector<Problem> problems_;
};

/// Returns the bounds of a setting in words, as "at least 0 and below 1"; empty if it has no bounds.
std::string bounds_in_words(SettingInfo const& info);

}  // namespace gridlock
