#pragma once

/// \file
/// Tables with named columns, as CSV.
///
/// ```cpp
/// Table table;
/// table.add_column("time", std::vector<double>{0.0, 0.1});
/// table.add_column("collisions", std::vector<std::uint64_t>{0, 7});
/// write_csv(table, "series.csv");
/// std::vector<double> const time = read_csv("series.csv").numbers("time");
/// ```

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gridlock {

/// One entry of a table: a number, a count (all 64 bits of it), or a word.
using Cell = std::variant<double, std::uint64_t, std::string>;

/// The entries of one column, all of one kind.
using CellColumn = std::variant<std::vector<double>, std::vector<std::uint64_t>, std::vector<std::string>>;

/// Named columns of equal length.
///
/// Contract (asserted): names differ and hold no comma, quote or line break; columns are equally long; a cell added to
/// a column is of the column's kind; a column asked for exists.
class Table {
 public:
  /// Adds a whole column; the first one decides how many rows there are.
  void add_column(std::string name, CellColumn values);

  /// Adds one row, a cell for every column in their order.
  void add_row(std::span<Cell const> cells);

  [[nodiscard]] std::size_t row_count() const;
  [[nodiscard]] std::size_t column_count() const { return columns_.size(); }
  [[nodiscard]] std::vector<std::string> const& names() const { return names_; }
  [[nodiscard]] bool contains(std::string_view name) const;

  [[nodiscard]] CellColumn const& column(std::string_view name) const;
  [[nodiscard]] CellColumn const& column(std::size_t index) const { return columns_[index]; }

  /// A column as numbers, counts rounded to the nearest double; empty for a column of words.
  [[nodiscard]] std::vector<double> numbers(std::string_view name) const;

  friend bool operator==(Table const&, Table const&) = default;

 private:
  [[nodiscard]] std::size_t index_of(std::string_view name) const;

  std::vector<std::string> names_;
  std::vector<CellColumn> columns_;
};

/// The table as comma-separated values: the names on the first line, then a line for each row.
///
/// Reads back the same to the last bit: numbers carry a point or an exponent ("1.0", "nan"), counts do not, words stand
/// in quotes, doubled inside.
std::string to_csv(Table const& table);

/// Writes to_csv(table). Errors: RunFailure.
void write_csv(Table const& table, std::filesystem::path const& path);

/// The table a text of comma-separated values holds; a column is one of counts where every entry is a whole number.
///
/// Lines that begin with # are skipped, an empty entry is nan.
/// Errors: Error naming `name`, line and column of every line that does not fit (the first ten).
Table parse_csv(std::string_view text, std::string const& name);

/// parse_csv() of a file. Errors: Error, also for a file that cannot be read.
Table read_csv(std::filesystem::path const& path);

}  // namespace gridlock
