#include "gridlock/io/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <optional>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/file.hpp"
#include "io/file_format.hpp"
#include "io/text.hpp"

namespace gridlock {

namespace {

constexpr std::size_t max_problems = 10;

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // spreadsheets begin a file with it

/// Returns whether a name of a column can be written without quotes and is read back unchanged. The reader removes
/// spaces at both ends, and a byte order mark before the first name.
bool is_usable_name(std::string_view name) {
  return !name.empty() && name.front() != ' ' && name.back() != ' ' && !name.starts_with(byte_order_mark) &&
         name.find_first_of(",\"\r\n#") == std::string_view::npos;
}

std::size_t size_of(CellColumn const& column) {
  return std::visit([](auto const& values) { return values.size(); }, column);
}

std::string to_text(double value) { return double_text(value); }
std::string to_text(std::uint64_t value) { return fmt::format("{}", value); }
std::string to_text(std::string const& word) {
  std::string text = "\"";
  for (char const c : word) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

/// A field of a CSV file.
struct CsvField {
  std::string text;
  bool is_quoted = false;
  int column = 0;
};

/// Reads the next field of a line; returns nothing if a quote is not closed or is followed by more text.
std::optional<CsvField> take_field(std::string_view line, std::size_t& at) {
  CsvField entry{.column = static_cast<int>(at) + 1};
  if (at < line.size() && line[at] == '"') {
    entry.is_quoted = true;
    for (++at;; ++at) {
      if (at >= line.size()) return std::nullopt;
      if (line[at] == '"' && (at + 1 >= line.size() || line[at + 1] != '"')) break;
      if (line[at] == '"') ++at;
      entry.text += line[at];
    }
    ++at;
    if (at < line.size() && line[at] != ',') return std::nullopt;
  } else {
    std::size_t const end = std::min(line.find(',', at), line.size());
    std::string_view word = line.substr(at, end - at);
    while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
    while (!word.empty() && word.back() == ' ') word.remove_suffix(1);
    entry.text = word;
    at = end;
  }
  return entry;
}

/// Reads comma-separated values line by line and collects the problems.
class CsvReader {
 public:
  CsvReader(std::string_view text, std::string name) : text_(text), file_(std::move(name)) {}

  Table read() {
    while (problems_.size() < max_problems && next_line()) {
      if (line_.empty() || line_.front() == '#') continue;
      std::vector<CsvField> entries;
      if (!split(entries)) continue;
      if (names_.empty()) {
        take_names(entries);
        // Without names of columns the rows cannot be read.
        if (!problems_.empty()) break;
      } else {
        take_row(std::move(entries));
      }
    }
    if (names_.empty() && problems_.empty())
      report("the file holds no table", "its first line has to name the columns", 0);
    std::vector<CellColumn> columns;
    for (std::size_t c = 0; c < names_.size(); ++c) columns.push_back(column(c));
    std::ranges::stable_sort(problems_, {}, &Problem::line);
    if (!problems_.empty()) throw Error(problems_);
    Table table;
    for (std::size_t c = 0; c < names_.size(); ++c) table.add_column(names_[c], std::move(columns[c]));
    return table;
  }

 private:
  struct Row {
    std::vector<CsvField> entries;
    int line = 0;
    std::string_view source;
  };

  bool next_line() {
    if (at_ >= text_.size()) return false;
    std::size_t const end = std::min(text_.find('\n', at_), text_.size());
    line_ = text_.substr(at_, end - at_);
    if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
    at_ = end + 1;
    ++line_number_;
    return true;
  }

  void report(std::string what, std::string hint, int column) {
    report(std::move(what), std::move(hint), line_number_, column, line_);
  }
  void report(std::string what, std::string hint, int line, int column, std::string_view source) {
    problems_.push_back({.what = std::move(what),
                         .hint = std::move(hint),
                         .file = file_,
                         .line = line,
                         .column = column,
                         .source_line = shown_line(source)});
  }

  bool split(std::vector<CsvField>& entries) {
    for (std::size_t at = 0;; ++at) {
      std::size_t const begin = at;
      std::optional<CsvField> entry = take_field(line_, at);
      if (!entry) {
        report("a quoted word does not end", "close it with \" before the next comma; a quote inside is doubled",
               static_cast<int>(begin) + 1);
        return false;
      }
      entries.push_back(std::move(*entry));
      if (at >= line_.size()) return true;
    }
  }

  void take_names(std::vector<CsvField> const& entries) {
    for (CsvField const& entry : entries) {
      if (entry.text.empty()) {
        report("a column has no name", "the first line has to name every column", entry.column);
      } else if (!is_usable_name(entry.text)) {
        report(fmt::format("{} cannot name a column", in_quotes(entry.text)),
               "names hold no comma, quote or #, no space at their ends, and no byte order mark", entry.column);
      } else if (std::ranges::find(names_, entry.text) != names_.end()) {
        report(fmt::format("two columns are named {}", in_quotes(entry.text)), "rename one of them", entry.column);
      }
      names_.push_back(entry.text);
    }
  }

  void take_row(std::vector<CsvField> entries) {
    if (entries.size() != names_.size()) {
      report(fmt::format("the line has {} {} for {} columns", entries.size(), entries.size() == 1 ? "entry" : "entries",
                         names_.size()),
             "is the line cut off?", 0);
      return;
    }
    rows_.push_back({std::move(entries), line_number_, line_});
  }

  CellColumn column(std::size_t c) {
    auto const is_quoted = [&](Row const& row) { return row.entries[c].is_quoted; };
    auto const is_count = [&](Row const& row) { return parse_number<std::uint64_t>(row.entries[c].text).has_value(); };
    if (!rows_.empty() && std::ranges::all_of(rows_, is_quoted)) {
      std::vector<std::string> words;
      for (Row const& row : rows_) words.push_back(row.entries[c].text);
      return words;
    }
    if (!rows_.empty() && std::ranges::all_of(rows_, is_count) && std::ranges::none_of(rows_, is_quoted)) {
      std::vector<std::uint64_t> counts;
      for (Row const& row : rows_) counts.push_back(*parse_number<std::uint64_t>(row.entries[c].text));
      return counts;
    }
    return numbers(c);
  }

  std::vector<double> numbers(std::size_t c) {
    std::vector<double> values;
    for (Row const& row : rows_) {
      CsvField const& entry = row.entries[c];
      auto const value =
          entry.text.empty() ? std::numeric_limits<double>::quiet_NaN() : parse_number<double>(entry.text);
      if ((!value || entry.is_quoted) && problems_.size() < max_problems) {
        report(fmt::format("{} in column {} is not a number", in_quotes(entry.text), in_quotes(names_[c])),
               entry.is_quoted ? "a column holds either numbers or words" : "put words in quotes", row.line,
               entry.column, row.source);
      }
      values.push_back(value.value_or(0.0));
    }
    return values;
  }

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  int line_number_ = 0;
  std::string_view line_;
  std::vector<std::string> names_;
  std::vector<Row> rows_;
  std::vector<Problem> problems_;
};

}  // namespace

void Table::add_column(std::string name, CellColumn values) {
  assert(!contains(name) && is_usable_name(name));
  assert(columns_.empty() || size_of(values) == row_count());
  names_.push_back(std::move(name));
  columns_.push_back(std::move(values));
}

void Table::add_row(std::span<Cell const> cells) {
  assert(cells.size() == columns_.size());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    std::visit(
        [&](auto& values) {
          using Value = typename std::remove_reference_t<decltype(values)>::value_type;
          assert(std::holds_alternative<Value>(cells[c]));
          values.push_back(std::get<Value>(cells[c]));
        },
        columns_[c]);
  }
}

std::size_t Table::row_count() const { return columns_.empty() ? 0 : size_of(columns_.front()); }

bool Table::contains(std::string_view name) const { return std::ranges::find(names_, name) != names_.end(); }

std::size_t Table::index_of(std::string_view name) const {
  auto const found = std::ranges::find(names_, name);
  assert(found != names_.end());
  return static_cast<std::size_t>(found - names_.begin());
}

CellColumn const& Table::column(std::string_view name) const { return columns_[index_of(name)]; }

std::vector<double> Table::numbers(std::string_view name) const {
  CellColumn const& values = column(name);
  if (auto const* numbers = std::get_if<std::vector<double>>(&values)) return *numbers;
  if (auto const* counts = std::get_if<std::vector<std::uint64_t>>(&values)) {
    std::vector<double> numbers;
    for (std::uint64_t const count : *counts) numbers.push_back(static_cast<double>(count));
    return numbers;
  }
  return {};
}

std::string to_csv(Table const& table) {
  std::string text = fmt::format("{}\n", fmt::join(table.names(), ","));
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    for (std::size_t c = 0; c < table.column_count(); ++c) {
      if (c > 0) text += ',';
      text += std::visit([&](auto const& values) { return to_text(values[row]); }, table.column(c));
    }
    text += '\n';
  }
  return text;
}

void write_csv(Table const& table, std::filesystem::path const& path) { write_file(path, to_csv(table)); }

Table parse_csv(std::string_view text, std::string const& name) {
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  return CsvReader(text, name).read();
}

Table read_csv(std::filesystem::path const& path) {
  if (auto const format = recognize_format(path)) throw wrong_format(*format, path.string(), "a table (CSV)");
  return parse_csv(read_file(path), path.string());
}

}  // namespace gridlock
