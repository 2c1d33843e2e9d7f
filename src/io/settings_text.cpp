#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "gridlock/io/settings_file.hpp"
#include "io/nearest_name.hpp"
#include "io/settings_reader.hpp"
#include "io/text.hpp"
#include "io/toml_tree.hpp"

namespace gridlock {

namespace {

/// Returns a whole number as TOML; above TOML's limit 2⁶³ − 1 in quotes, which the reader accepts.
std::string count_text(std::uint64_t count) {
  bool const fits = count <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return fits ? fmt::format("{}", count) : fmt::format("\"{}\"", count);
}

std::string list_text(std::vector<double> const& numbers) {
  std::string text = "[";
  for (double const number : numbers) {
    if (text.size() > 1) text += ", ";
    text += double_text(number);
  }
  return text + "]";
}

/// Visits settings as text: their type in words and their value as TOML, empty if a setting has no value.
class ValueVisitor : public SettingVisitor {
 public:
  void visit(SettingInfo const& info, double& value) final { take(info, "number", double_text(value)); }
  void visit(SettingInfo const& info, std::optional<double>& value) final {
    take(info, "number", value ? double_text(*value) : "");
  }
  void visit(SettingInfo const& info, std::uint64_t& value) final { take(info, "whole number", count_text(value)); }
  void visit(SettingInfo const& info, std::optional<std::uint64_t>& value) final {
    take(info, "whole number", value ? count_text(*value) : "");
  }
  void visit(SettingInfo const& info, bool& value) final { take(info, "true or false", value ? "true" : "false"); }
  void visit(SettingInfo const& info, std::string& value) final { take(info, "text", toml_quoted(value)); }
  void visit(SettingInfo const& info, std::vector<double>& value) final {
    take(info, "list of numbers", list_text(value));
  }
  void visit_choice(SettingInfo const& info, std::span<std::string_view const> choices, std::size_t& value) final {
    take_choice(info, choices, value < choices.size() ? toml_quoted(choices[value]) : "");
  }

 protected:
  virtual void take(SettingInfo const& info, std::string_view type, std::string const& value) = 0;
  virtual void take_choice(SettingInfo const& info, std::span<std::string_view const> choices,
                           std::string const& value) = 0;
};

/// Writes the settings of one entry of a list of tables as an inline table.
class InlineWriter final : public ValueVisitor {
 public:
  [[nodiscard]] std::string text() const { return text_.empty() ? "{}" : fmt::format("{{ {} }}", text_); }

  void enter(std::string_view name, std::string_view) override {
    text_ += fmt::format("{}{} = {{ ", separator(), toml_key(name));
    is_first_ = true;
  }
  void leave() override {
    text_ += " }";
    is_first_ = false;
  }
  void visit_tables(SettingInfo const& info, std::size_t size, std::function<void(std::size_t)> const&,
                    std::function<void(std::size_t, SettingVisitor&)> const& describe_one) override {
    take(info, "", list(size, describe_one));
  }

  static std::string list(std::size_t size, std::function<void(std::size_t, SettingVisitor&)> const& describe_one) {
    std::string text = "[";
    for (std::size_t k = 0; k < size; ++k) {
      InlineWriter entry;
      describe_one(k, entry);
      if (k > 0) text += ", ";
      text += entry.text();
    }
    return text + "]";
  }

 private:
  std::string_view separator() {
    if (std::exchange(is_first_, false)) return "";
    return ", ";
  }
  void take(SettingInfo const& info, std::string_view, std::string const& value) override {
    if (!value.empty()) text_ += fmt::format("{}{} = {}", separator(), toml_key(info.key), value);
  }
  void take_choice(SettingInfo const& info, std::span<std::string_view const>, std::string const& value) override {
    take(info, "", value);
  }

  std::string text_;
  bool is_first_ = true;
};

/// Writes every table under its own header, with the lines of its settings.
class TomlWriter final : public ValueVisitor {
 public:
  [[nodiscard]] std::string text() const {
    std::string text;
    for (Section const& section : sections_) {
      if (section.lines.empty()) continue;
      if (!text.empty()) text += '\n';
      if (!section.header.empty()) text += fmt::format("[{}]\n", section.header);
      text += section.lines;
    }
    return text;
  }

  void enter(std::string_view name, std::string_view) override {
    std::string const header = dotted(sections_[open_.back()].header, toml_key(name));
    auto const found = std::ranges::find(sections_, header, &Section::header);
    open_.push_back(static_cast<std::size_t>(found - sections_.begin()));
    if (found == sections_.end()) sections_.push_back({.header = header, .lines = ""});
  }
  void leave() override { open_.pop_back(); }
  void visit_tables(SettingInfo const& info, std::size_t size, std::function<void(std::size_t)> const&,
                    std::function<void(std::size_t, SettingVisitor&)> const& describe_one) override {
    // The list is written inline, since a [[header]] would end the current table before its remaining settings.
    take(info, "", InlineWriter::list(size, describe_one));
  }

 private:
  struct Section {
    std::string header;
    std::string lines;
  };

  void take(SettingInfo const& info, std::string_view, std::string const& value) override {
    if (!value.empty()) sections_[open_.back()].lines += fmt::format("{} = {}\n", toml_key(info.key), value);
  }
  void take_choice(SettingInfo const& info, std::span<std::string_view const>, std::string const& value) override {
    take(info, "", value);
  }

  std::vector<Section> sections_{{.header = "", .lines = ""}};
  std::vector<std::size_t> open_{0};
};

/// The documentation of one setting or table.
struct Entry {
  std::string path;
  std::string table;  ///< path of the enclosing table
  std::string name;
  std::string former_path = {};  ///< in earlier versions; empty if unchanged
  bool is_table = false;
  bool is_list_of_tables = false;
  std::string documentation;
  std::string type;
  std::string unit;
  std::string bounds;
  std::vector<std::string> choices;
  std::string value;
  std::string default_note;

  [[nodiscard]] std::string title() const {
    if (is_list_of_tables) return fmt::format("[[{}]]", path);
    return is_table ? fmt::format("[{}]", path) : path;
  }
  [[nodiscard]] std::string default_text() const {
    if (!default_note.empty()) return default_note;
    return value.empty() ? "none" : value;
  }
};

/// Collects the entries of all settings and tables, in the order of the description.
class Catalogue final : public ValueVisitor {
 public:
  explicit Catalogue(Describe const& describe) { describe(*this); }

  [[nodiscard]] std::vector<Entry> const& entries() const { return entries_; }

  void enter(std::string_view name, std::string_view documentation) override {
    std::string const path = dotted(table_.back(), name);
    if (std::ranges::find(entries_, path, &Entry::path) == entries_.end()) {
      entries_.push_back({.path = path,
                          .table = table_.back(),
                          .name = std::string(name),
                          .is_table = true,
                          .documentation = std::string(documentation)});
    }
    table_.push_back(path);
  }
  void leave() override { table_.pop_back(); }
  void visit_tables(SettingInfo const& info, std::size_t size, std::function<void(std::size_t)> const& resize,
                    std::function<void(std::size_t, SettingVisitor&)> const& describe_one) override {
    Entry& entry = add(info, "list of tables", size == 0 ? "[]" : InlineWriter::list(size, describe_one));
    entry.is_table = true;
    entry.is_list_of_tables = true;
    table_.push_back(entry.path);
    // Only an entry of the list describes its settings, so an empty list gets one entry for a moment.
    if (size == 0) resize(1);
    describe_one(0, *this);
    if (size == 0) resize(0);
    table_.pop_back();
  }

 private:
  Entry& add(SettingInfo const& info, std::string_view type, std::string const& value) {
    return entries_.emplace_back(
        Entry{.path = dotted(table_.back(), info.key),
              .table = table_.back(),
              .name = std::string(info.key),
              .former_path = info.former_key.empty() ? "" : dotted(table_.back(), info.former_key),
              .documentation = std::string(info.documentation),
              .type = std::string(type),
              .unit = std::string(info.unit),
              .bounds = bounds_in_words(info),
              .value = value,
              .default_note = std::string(info.default_note)});
  }
  void take(SettingInfo const& info, std::string_view type, std::string const& value) override {
    add(info, type, value);
  }
  void take_choice(SettingInfo const& info, std::span<std::string_view const> choices,
                   std::string const& value) override {
    Entry& entry = add(info, "word", value);
    for (std::string_view const choice : choices) entry.choices.push_back(toml_quoted(choice));
  }

  std::vector<Entry> entries_;
  std::vector<std::string> table_{""};
};

std::string explained(Entry const& entry) {
  std::string text = entry.title() + '\n';
  if (!entry.documentation.empty()) text += fmt::format("    {}\n", entry.documentation);
  if (entry.is_table && !entry.is_list_of_tables) return text;
  std::string what = entry.type;
  if (!entry.unit.empty()) what += fmt::format(", in {}", entry.unit);
  if (!entry.bounds.empty()) what += fmt::format(", {}", entry.bounds);
  if (!entry.choices.empty()) what = fmt::format("one of {}", fmt::join(entry.choices, ", "));
  return text + fmt::format("    {}; default: {}\n", what, entry.default_text());
}

/// Returns the path of the setting or table that a misspelled key most likely means; empty if none is close.
std::string nearest_entry(std::string_view key, std::vector<Entry> const& entries) {
  std::vector<std::string> paths, names;
  for (Entry const& entry : entries) {
    paths.push_back(entry.path);
    names.push_back(entry.name);
  }
  std::string nearest = nearest_name(key, paths);
  if (nearest.empty()) {
    // "disks.packing" and "packing" resemble each other only in their last part.
    std::string_view const last = key.substr(key.rfind('.') + 1);
    std::string const name = nearest_name(last, names);
    if (!name.empty()) nearest = entries[static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())].path;
  }
  return nearest;
}

[[noreturn]] void refuse_unknown(std::string_view key, std::vector<Entry> const& entries) {
  std::string const nearest = nearest_entry(key, entries);
  throw Error(Problem{.what = fmt::format("there is no setting {}", in_quotes(key)),
                      .hint = nearest.empty() ? "gridlock explain without a key lists all settings"
                                              : fmt::format("did you mean {}?", nearest)});
}

std::string markdown_cell(std::string_view text) {
  std::string result;
  for (char const c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string markdown_row(Entry const& entry) {
  std::string values = entry.choices.empty() ? entry.type : fmt::format("`{}`", fmt::join(entry.choices, "`, `"));
  if (!entry.bounds.empty()) values += ", " + entry.bounds;
  std::string const usual =
      !entry.default_note.empty() || entry.value.empty() ? entry.default_text() : fmt::format("`{}`", entry.value);
  return fmt::format("| `{}` | {} | {} | {} | {} |\n", entry.name, markdown_cell(values), markdown_cell(entry.unit),
                     markdown_cell(usual), markdown_cell(entry.documentation));
}

}  // namespace

std::string to_toml(Describe const& describe) {
  TomlWriter writer;
  describe(writer);
  return writer.text();
}

std::string explain(Describe const& describe, std::string_view key) {
  Catalogue const catalogue(describe);
  std::vector<Entry> const& entries = catalogue.entries();
  auto const explain_all = [&](auto const& is_wanted) {
    std::string text;
    for (Entry const& entry : entries) {
      if (!is_wanted(entry)) continue;
      if (!text.empty()) text += '\n';
      text += explained(entry);
    }
    return text;
  };
  if (key.empty()) return explain_all([](Entry const&) { return true; });
  std::string const inside = std::string(key) + ".";
  std::string text = explain_all([&](Entry const& e) { return e.path == key || e.path.starts_with(inside); });
  if (text.empty()) text = explain_all([&](Entry const& e) { return e.name == key; });
  if (text.empty()) refuse_unknown(key, entries);
  return text;
}

std::string nearest_setting(Describe const& describe, std::string_view key) {
  return nearest_entry(key, Catalogue(describe).entries());
}

std::optional<std::string> renamed_setting(Describe const& describe, std::string_view key) {
  Catalogue const catalogue(describe);
  for (Entry const& entry : catalogue.entries()) {
    if (!entry.former_path.empty() && entry.former_path == key) return entry.path;
  }
  return std::nullopt;
}

std::vector<std::string> setting_keys(Describe const& describe) {
  Catalogue const catalogue(describe);
  std::vector<std::string> keys;
  for (Entry const& entry : catalogue.entries()) {
    if (!entry.is_table) keys.push_back(entry.path);
  }
  return keys;
}

std::string value_in_toml(Describe const& describe, std::string_view key) {
  Catalogue const catalogue(describe);
  auto const found = std::ranges::find(catalogue.entries(), key, &Entry::path);
  return found == catalogue.entries().end() ? std::string() : found->value;
}

std::string reference_markdown(Describe const& describe) {
  Catalogue const catalogue(describe);
  std::vector<Entry> const& entries = catalogue.entries();
  auto const rows_of = [&](std::string const& table) {
    std::string rows;
    for (Entry const& entry : entries) {
      if (entry.table == table && (!entry.is_table || entry.is_list_of_tables)) rows += markdown_row(entry);
    }
    if (rows.empty()) return rows;
    return "\n| setting | values | unit | default | meaning |\n|---|---|---|---|---|\n" + rows;
  };
  std::string text = rows_of("");
  for (Entry const& entry : entries) {
    if (!entry.is_table) continue;
    text += fmt::format("{}## `{}`\n\n{}\n{}", text.empty() ? "" : "\n", entry.title(), entry.documentation,
                        rows_of(entry.path));
  }
  return text;
}

}  // namespace gridlock
