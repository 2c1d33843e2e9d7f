#pragma once

/// \file
/// Tables with named columns, which are written and read as CSV.
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

/// One entry of a table: a number, a count of 64 bits, or a word.
using Cell = std::variant<double, std::uint64_t, std::string>;

/// The entries of one column, all of one kind.
using CellColumn = std::variant<std::vector<double>, std::vector<std::uint64_t>, std::vector<std::string>>;

/// Named columns of equal length.
///
/// Contract (asserted): names differ and have no comma, quote or line break; columns are equally long; cells have the
/// type of their column; a column that is read exists.
class Table {
 public:
  /// Adds a whole column; the first column sets the number of rows.
  void add_column(std::string name, CellColumn values);

  /// Adds one row, a cell for every column in their order.
  void add_row(std::span<Cell const> cells);

  [[nodiscard]] std::size_t row_count() const;
  [[nodiscard]] std::size_t column_count() const { return columns_.size(); }
  [[nodiscard]] std::vector<std::string> const& names() const { return names_; }
  [[nodiscard]] bool contains(std::string_view name) const;

  [[nodiscard]] CellColumn const& column(std::string_view name) const;
  [[nodiscard]] CellColumn const& column(std::size_t index) const { return columns_[index]; }

  /// Returns a column as numbers, counts rounded to the nearest double; empty for a column of words.
  [[nodiscard]] std::vector<double> numbers(std::string_view name) const;

  friend bool operator==(Table const&, Table const&) = default;

 private:
  [[nodiscard]] std::size_t index_of(std::string_view name) const;

  std::vector<std::string> names_;
  std::vector<CellColumn> columns_;
};

/// Returns the table as comma-separated values: the names in the first line, then a line for each row.
///
/// parse_csv() reads back the same bits: numbers have a point or an exponent ("1.0", "nan"), counts do not, words are
/// in quotes, and quotes in words are doubled.
std::string to_csv(Table const& table);

/// Writes to_csv(table) to a file. Errors: RunFailure if it cannot be written.
void write_csv(Table const& table, std::filesystem::path const& path);

/// Reads a table from comma-separated values; a column is one of counts if every entry is a whole number.
///
/// Lines that begin with # are skipped, an empty entry is nan. Errors: Error with `name`, line and column of every
/// wrong line (the first ten).
Table parse_csv(std::string_view text, std::string const& name);

/// Reads a table from a file, see parse_csv(). Errors: Error, also for a file that cannot be read.
Table read_csv(std::filesystem::path const& path);

}  // namespace gridlock
