#pragma once

#include <filesystem>

#include "gridlock/core/pair_potential.hpp"

namespace gridlock {

/// Replaces the file of a table by its rows, so that a run keeps them, and returns the path of the file; does nothing
/// without a file or for another kind.
/// Errors: Error for a file that cannot be read or lacks a column, with its line for a wrong row, and for rows beside a
/// file.
std::filesystem::path take_table_file(PotentialSettings& potential, std::filesystem::path const& directory);

}  // namespace gridlock
