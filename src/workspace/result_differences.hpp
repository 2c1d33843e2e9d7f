#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "gridlock/core/field.hpp"
#include "gridlock/core/network.hpp"
#include "gridlock/io/table.hpp"

namespace gridlock {

// Each function compares a result file of a run with that of its replay, and returns the first difference in words;
// nothing if there is none. Columns and entries that only the file has are left out: the program that made the run may
// have added observables of its own.

/// Returns whether two numbers have the same bits, or both are no number.
bool is_same_number(double one, double other);

/// Compares a table, column by column. Errors: Error for a file that is no table.
std::string difference_of_table(std::filesystem::path const& file, Table const& replay);

/// Compares the entries of summary.json, but for versions, times of the processor and notes.
/// Errors: Error for a file that is no summary.
std::string difference_of_summary(std::filesystem::path const& file, std::string const& replay);

/// Compares texts, such as that of final.xyz, line by line. Errors: Error for a file that cannot be read.
std::string difference_of_text(std::filesystem::path const& file, std::string const& replay);

/// Compares fields, cell by cell.
std::string difference_of_fields(std::span<Field const> recorded, std::span<Field const> replay);
/// Compares networks, edge by edge.
std::string difference_of_networks(std::span<Network const> recorded, std::span<Network const> replay);

}  // namespace gridlock
