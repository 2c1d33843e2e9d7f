#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "gridlock/core/error.hpp"

namespace gridlock {

/// A format that a file shows by its first bytes, whatever it is called.
struct FileFormat {
  std::string_view id;    ///< "hdf5", "gsd", "netcdf", "lammps_dump" …
  std::string_view name;  ///< as in "x is a GSD file"
  std::string_view hint;  ///< how Gridlock comes to its content, where it is told to read another format
};

/// As many bytes as recognize_format() looks at.
inline constexpr std::size_t bytes_of_format = 512;

/// The format whose mark a file begins with; nothing for texts without a mark, such as XYZ, CSV and TOML.
std::optional<FileFormat> recognize_format(std::string_view first_bytes);

/// The same of a file. Nothing where it is missing, or no regular file: a pipe can be read only once.
std::optional<FileFormat> recognize_format(std::filesystem::path const& path);

/// The kind of a text without a mark: extended XYZ or another one, also where gzip packed it; nothing for other bytes
/// and for an empty file.
std::optional<FileFormat> recognize_text(std::filesystem::path const& path);

/// The refusal of a file of this format where `wanted` is read ("extended XYZ").
Error wrong_format(FileFormat const& format, std::string const& file, std::string_view wanted);

}  // namespace gridlock
