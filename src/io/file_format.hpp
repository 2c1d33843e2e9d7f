#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "gridlock/core/error.hpp"

namespace gridlock {

/// A file format that is recognized by the first bytes of a file, not by its name.
struct FileFormat {
  std::string_view id;    ///< "hdf5", "gsd", "netcdf", "lammps_dump" …
  std::string_view name;  ///< with an article: "a GSD file"
  std::string_view hint;  ///< how to convert a file into a format that Gridlock reads
};

/// Number of bytes that recognize_format() needs.
inline constexpr std::size_t bytes_of_format = 512;

/// Returns the format whose mark a file begins with; nothing for texts without a mark, such as XYZ, CSV and TOML.
std::optional<FileFormat> recognize_format(std::string_view first_bytes);

/// Returns the format of a file; nothing if it is missing or not a regular file, since a pipe can be read only once.
std::optional<FileFormat> recognize_format(std::filesystem::path const& path);

/// Returns the kind of a text without a mark: extended XYZ or other text, also packed by gzip; nothing for other bytes
/// and for an empty file.
std::optional<FileFormat> recognize_text(std::filesystem::path const& path);

/// Returns the error for a file of this format where `wanted` ("extended XYZ") is expected.
Error wrong_format(FileFormat const& format, std::string const& file, std::string_view wanted);

}  // namespace gridlock
