#include "io/settings_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "io/nearest_name.hpp"
#include "io/text.hpp"

namespace gridlock {

namespace {

using Kind = TomlValue::Kind;

std::string with_unit(std::string text, SettingInfo const& info) {
  return info.unit.empty() ? text : fmt::format("{} ({})", text, info.unit);
}

std::string listed(std::span<std::string const> names) { return fmt::format("{}", fmt::join(names, ", ")); }

constexpr char const* whole_numbers_in_words = "a whole number from 0 to 18446744073709551615 (2⁶⁴ − 1)";

/// Returns a whole number. TOML's integers end at 2⁶³ − 1; larger seeds, up to 2⁶⁴ − 1, are written as text.
std::optional<std::uint64_t> whole_number_of(TomlValue const& value) {
  if (value.kind == Kind::integer && value.integer >= 0) return static_cast<std::uint64_t>(value.integer);
  if (value.kind != Kind::text) return std::nullopt;
  auto const number = parse_number<std::uint64_t>(value.text);
  constexpr auto max_of_toml = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return number && *number > max_of_toml ? number : std::nullopt;
}

/// Returns whether a text consists of digits but exceeds 64 bits, so that TOML did not read it as a number.
bool has_too_many_digits(TomlValue const& value) {
  std::string_view digits = value.text;
  if (digits.starts_with('-') || digits.starts_with('+')) digits.remove_prefix(1);
  return value.kind == Kind::text && !digits.empty() &&
         digits.find_first_not_of("0123456789") == std::string_view::npos && !parse_number<std::int64_t>(value.text);
}

bool is_number_with_comma(std::string text) {
  if (text.find(',') == std::string::npos) return false;
  std::ranges::replace(text, ',', '.');
  return parse_number<double>(text).has_value();
}

/// Returns a hint for a text in place of a number; empty if the text does not resemble a number.
std::string number_instead_of(TomlValue const& value) {
  if (value.kind != Kind::text) return "";
  auto const number = parse_number<double>(value.text);
  if (number && value.as_typed.empty()) return "leave the quotes out";
  if (number && std::isfinite(*number)) return fmt::format("write {}", double_text(*number));
  return is_number_with_comma(value.text) ? "numbers have a decimal point and no comma, as in 0.7 and 10_000" : "";
}

std::string whole_number_instead_of(TomlValue const& value) {
  // A value of --set that is not TOML, as "007", arrives as text.
  bool const is_typed = value.kind == Kind::text && !value.as_typed.empty();
  double const number = value.kind == Kind::number ? value.number
                        : is_typed                 ? parse_number<double>(value.text).value_or(0.5)
                                                   : 0.5;
  bool const is_whole = number >= 0.0 && number < 1e18 && number == std::floor(number);
  return is_whole ? fmt::format("write {}", static_cast<std::uint64_t>(number)) : number_instead_of(value);
}

/// Returns a hint with the command that explains a setting; entries of a list are explained with their list.
std::string explanation_of(std::string const& key) {
  return fmt::format("gridlock explain {} says what it can be", key.substr(0, key.find('[')));
}

/// Returns a value as text. For --set this is the text as typed, also if it resembles a number or a date.
std::optional<std::string> as_text(TomlValue const& value) {
  if (value.kind == Kind::text) return value.text;
  if (!value.as_typed.empty() && value.kind != Kind::array && value.kind != Kind::table) return value.as_typed;
  return std::nullopt;
}

}  // namespace

std::string bounds_in_words(SettingInfo const& info) {
  std::string words;
  if (std::isfinite(info.min)) {
    words = fmt::format("{} {}", info.min_is_allowed ? "at least" : "above", info.min);
  }
  if (std::isfinite(info.max)) {
    words += fmt::format("{}{} {}", words.empty() ? "" : " and ", info.max_is_allowed ? "at most" : "below", info.max);
  }
  return words;
}

SettingsReader::SettingsReader(TomlValue const& root) : frames_{{.table = &root, .path = "", .kind = ""}} {
  tables_.insert("");
}

std::string SettingsReader::path_of(std::string_view key) const { return dotted(frames_.back().path, key); }

/// Returns the value of a setting in the current table and marks the key as known; null if the setting is not given.
TomlValue const* SettingsReader::take(std::string_view key) {
  Frame const& frame = frames_.back();
  auto& names = names_[frame.kind];
  if (std::ranges::find(names, key) == names.end()) names.emplace_back(key);
  TomlValue const* value = frame.table != nullptr ? frame.table->find(key) : nullptr;
  if (value != nullptr) taken_.insert(value);
  return value;
}

TomlValue const* SettingsReader::take(SettingInfo const& info) {
  if (!info.former_key.empty()) {
    renamed_[dotted(frames_.back().kind, info.former_key)] = dotted(frames_.back().kind, info.key);
  }
  return take(info.key);
}

void SettingsReader::report(TomlValue const& value, std::string const& path, std::string what, std::string hint) {
  problems_.push_back(
      problem_at(value.location, path, std::move(what), hint.empty() ? explanation_of(path) : std::move(hint)));
}

void SettingsReader::report_type(TomlValue const& value, std::string const& path, std::string const& expected,
                                 std::string hint) {
  report(value, path, fmt::format("{} is {}, but must be {}", path, in_words(value), expected), std::move(hint));
}

void SettingsReader::enter(std::string_view name, std::string_view) {
  Frame frame{.table = nullptr, .path = path_of(name), .kind = dotted(frames_.back().kind, name)};
  tables_.insert(frame.kind);
  if (TomlValue const* table = take(name)) {
    if (table->is_table()) {
      frame.table = table;
    } else if (table->kind == Kind::array) {
      report_type(*table, frame.path, "a table", fmt::format("write [{0}] once, not [[{0}]]", frame.path));
    } else {
      report_type(*table, frame.path, "a table", fmt::format("write [{}] and its settings below it", frame.path));
    }
  }
  frames_.push_back(std::move(frame));
}

void SettingsReader::leave() { frames_.pop_back(); }

bool SettingsReader::is_within_bounds(TomlValue const& value, std::string const& path, SettingInfo const& info,
                                      double number) {
  bool const is_high_enough = info.min_is_allowed ? number >= info.min : number > info.min;
  bool const is_low_enough = info.max_is_allowed ? number <= info.max : number < info.max;
  if (is_high_enough && is_low_enough) return true;
  report(value, path,
         fmt::format("{} is {}, but must be {}", path, in_words(value), with_unit(bounds_in_words(info), info)), "");
  return false;
}

bool SettingsReader::read_number(TomlValue const& value, std::string const& path, SettingInfo const& info,
                                 double& number) {
  double read = 0.0;
  if (value.kind == Kind::number) {
    read = value.number;
  } else if (value.kind == Kind::integer) {
    read = static_cast<double>(value.integer);
  } else {
    report_type(value, path, with_unit("a number", info), number_instead_of(value));
    return false;
  }
  if (!std::isfinite(read)) {
    report_type(value, path, with_unit("a finite number", info));
    return false;
  }
  if (!is_within_bounds(value, path, info, read)) return false;
  number = read;
  return true;
}

bool SettingsReader::read_count(TomlValue const& value, std::string const& path, SettingInfo const& info,
                                std::uint64_t& count) {
  auto const read = whole_number_of(value);
  if (!read && has_too_many_digits(value)) {
    std::string const bounds = bounds_in_words(info);
    std::string const expected = bounds.empty() ? whole_numbers_in_words : bounds;
    report(value, path, fmt::format("{} is {}, but must be {}", path, cut(value.text, 60), with_unit(expected, info)),
           "");
    return false;
  }
  if (!read) {
    std::string const expected = info.min > 0.0 ? fmt::format("a whole number, at least {}", info.min)
                                                : std::string("a whole number, 0 or above");
    report_type(value, path, with_unit(expected, info), whole_number_instead_of(value));
    return false;
  }
  if (!is_within_bounds(value, path, info, static_cast<double>(*read))) return false;
  count = *read;
  return true;
}

void SettingsReader::visit(SettingInfo const& info, double& value) {
  if (TomlValue const* given = take(info)) read_number(*given, path_of(info.key), info, value);
}

void SettingsReader::visit(SettingInfo const& info, std::optional<double>& value) {
  double number = 0.0;
  TomlValue const* given = take(info);
  if (given != nullptr && read_number(*given, path_of(info.key), info, number)) value = number;
}

void SettingsReader::visit(SettingInfo const& info, std::uint64_t& value) {
  if (TomlValue const* given = take(info)) read_count(*given, path_of(info.key), info, value);
}

void SettingsReader::visit(SettingInfo const& info, std::optional<std::uint64_t>& value) {
  std::uint64_t count = 0;
  TomlValue const* given = take(info);
  if (given != nullptr && read_count(*given, path_of(info.key), info, count)) value = count;
}

void SettingsReader::visit(SettingInfo const& info, bool& value) {
  TomlValue const* given = take(info);
  if (given == nullptr) return;
  if (given->kind == Kind::boolean) {
    value = given->boolean;
  } else {
    report_type(*given, path_of(info.key), "true or false");
  }
}

void SettingsReader::visit(SettingInfo const& info, std::string& value) {
  TomlValue const* given = take(info);
  if (given == nullptr) return;
  if (auto text = as_text(*given)) {
    value = std::move(*text);
  } else {
    report_type(*given, path_of(info.key), "a text", "write texts in quotes");
  }
}

void SettingsReader::visit(SettingInfo const& info, std::vector<double>& value) {
  TomlValue const* given = take(info);
  if (given == nullptr) return;
  std::string const path = path_of(info.key);
  if (given->kind != Kind::array) {
    bool const is_number = given->kind == Kind::integer || given->kind == Kind::number;
    report_type(*given, path, with_unit("a list of numbers", info),
                is_number ? fmt::format("write [{}]", to_toml(*given)) : "");
    return;
  }
  std::vector<double> numbers(given->items.size());
  bool is_good = true;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    is_good &= read_number(given->items[i], fmt::format("{}[{}]", path, i), info, numbers[i]);
  }
  if (is_good) value = std::move(numbers);
}

void SettingsReader::visit_choice(SettingInfo const& info, std::span<std::string_view const> choices,
                                  std::size_t& value) {
  TomlValue const* given = take(info);
  if (given == nullptr) return;
  std::string const path = path_of(info.key);
  std::vector<std::string> words;
  for (std::string_view const choice : choices) words.push_back(toml_quoted(choice));
  std::string const expected = (words.size() == 1 ? "" : "one of ") + listed(words);
  auto const text = as_text(*given);
  if (!text) return report_type(*given, path, expected);
  auto const found = std::ranges::find(choices, *text);
  if (found != choices.end()) {
    value = static_cast<std::size_t>(found - choices.begin());
    return;
  }
  std::vector<std::string> const names(choices.begin(), choices.end());
  std::string const nearest = nearest_name(*text, names);
  report(*given, path, fmt::format("{} is {}, but must be {}", path, in_quotes(*text), expected),
         nearest.empty() ? "" : fmt::format("did you mean {}?", toml_quoted(nearest)));
}

void SettingsReader::visit_tables(SettingInfo const& info, std::size_t, std::function<void(std::size_t)> const& resize,
                                  std::function<void(std::size_t, SettingVisitor&)> const& describe_one) {
  std::string const path = path_of(info.key);
  std::string const kind = dotted(frames_.back().kind, info.key) + "[]";
  tables_.insert(kind);
  TomlValue const* given = take(info);
  if (given == nullptr) return;
  std::string const hint = fmt::format("write [[{}]] above the settings of each one", path);
  if (given->kind != Kind::array) return report_type(*given, path, "a list of tables", hint);
  std::size_t const wrong = problems_.size();
  for (std::size_t k = 0; k < given->items.size(); ++k) {
    if (!given->items[k].is_table()) report_type(given->items[k], fmt::format("{}[{}]", path, k), "a table", hint);
  }
  if (problems_.size() > wrong) return;
  resize(given->items.size());
  for (std::size_t k = 0; k < given->items.size(); ++k) {
    frames_.push_back({.table = &given->items[k], .path = fmt::format("{}[{}]", path, k), .kind = kind});
    describe_one(k, *this);
    frames_.pop_back();
  }
}

std::vector<Problem> SettingsReader::problems() const {
  std::vector<Problem> all = problems_;
  report_unknown(*frames_.front().table, frames_.front(), all);
  auto const place = [](Problem const& p) {
    return std::pair(p.line == 0 ? std::numeric_limits<int>::max() : p.line, p.column);
  };
  std::ranges::stable_sort(all, {}, place);
  return all;
}

void SettingsReader::report_unknown(TomlValue const& table, Frame const& frame, std::vector<Problem>& found) const {
  for (std::size_t i = 0; i < table.items.size(); ++i) {
    TomlValue const& member = table.items[i];
    std::string const& name = table.names[i];
    Frame inner{.table = &member, .path = dotted(frame.path, name), .kind = dotted(frame.kind, name)};
    if (!taken_.contains(&member)) {
      found.push_back(unknown(member, name, frame));
    } else if (member.is_table() && tables_.contains(inner.kind)) {
      report_unknown(member, inner, found);
    } else if (member.kind == Kind::array && tables_.contains(inner.kind + "[]")) {
      for (std::size_t k = 0; k < member.items.size(); ++k) {
        Frame const entry{
            .table = &member.items[k], .path = fmt::format("{}[{}]", inner.path, k), .kind = inner.kind + "[]"};
        report_unknown(member.items[k], entry, found);
      }
    }
  }
}

Problem SettingsReader::unknown(TomlValue const& member, std::string const& name, Frame const& frame) const {
  std::string const path = dotted(frame.path, name);
  auto const renamed = renamed_.find(dotted(frame.kind, name));
  if (renamed != renamed_.end()) {
    return problem_at(member.key_location, path, fmt::format("{} was renamed to {}", path, renamed->second),
                      fmt::format("write {}", renamed->second));
  }
  auto const found = names_.find(frame.kind);
  std::vector<std::string> const names = found == names_.end() ? std::vector<std::string>{} : found->second;
  bool const is_table = member.is_table() && frame.path.empty();
  std::string what = frame.path.empty()
                         ? fmt::format("there is no {} {}", is_table ? "table" : "setting", in_quotes(name))
                         : fmt::format("there is no setting {} in [{}]", in_quotes(name), frame.path);
  std::string hint;
  std::string const nearest = nearest_name(name, names);
  std::vector<std::string> homes;
  for (auto const& [table, known] : names_) {
    if (!table.empty() && std::ranges::find(known, name) != known.end()) homes.push_back(fmt::format("[{}]", table));
  }
  if (is_table && name == "sweep") {
    what = "a table [sweep] lists values for many runs";
    hint = "use gridlock sweep, or take [sweep] out";
  } else if (!homes.empty() && !is_table) {
    // A name that exists in another table is correctly spelled, so the hint names that table.
    hint = fmt::format("{} belongs in {}", name, listed(homes));
    if (!frame.path.empty()) {
      hint +=
          fmt::format("; gridlock explain {} tells of the settings here", frame.kind.substr(0, frame.kind.find('[')));
    }
  } else if (!nearest.empty()) {
    hint = fmt::format("did you mean {}?", nearest);
  } else if (!names.empty()) {
    hint = fmt::format("{} {}",
                       frame.path.empty() ? "the tables are" : fmt::format("the settings of [{}] are", frame.path),
                       listed(names));
  }
  return problem_at(member.key_location, path, std::move(what), hint.empty() ? explanation_of(path) : std::move(hint));
}

}  // namespace gridlock
