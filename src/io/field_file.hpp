#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "gridlock/core/field.hpp"

namespace gridlock {

/// Writes fields as datasets of shape (1, rows, columns) of an HDF5 file, as in a trajectory: /fields/NAME/value.
/// Errors: RunFailure.
void write_fields(std::span<Field const> fields, std::filesystem::path const& path);
/// Reads the fields of such a file, in the order of their names. Errors: Error.
std::vector<Field> read_fields(std::filesystem::path const& path);

}  // namespace gridlock
