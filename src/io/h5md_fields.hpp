#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "gridlock/core/field.hpp"
#include "io/hdf5.hpp"

namespace gridlock::h5md {

/// Returns the group of a field, which has a dataset `value` of shape (frames, rows, columns).
std::string path_of_field(std::string const& name);

/// Creates the group and the dataset of a field, without frames. Errors of all functions here: hdf5::Failure.
void create_field(hdf5::Handle const& file, Field const& field, int compression);
/// Writes a field as frame `frame`, the last one. Errors: hdf5::Failure if the file has no such field of this shape.
void put_field(hdf5::Handle const& file, Field const& field, std::size_t frame);

/// Returns the fields of a frame, in the order of their names. A file of `bytes` bytes cannot have larger ones.
std::vector<Field> read_fields(hdf5::Handle const& file, std::size_t frame, std::uint64_t bytes);

}  // namespace gridlock::h5md

namespace gridlock {

/// Writes a new HDF5 file, which has its name only when it is whole. Errors: RunFailure.
void write_hdf5(std::filesystem::path const& path, std::function<void(hdf5::Handle const&)> const& fill);

}  // namespace gridlock
