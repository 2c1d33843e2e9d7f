#include "io/file_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "io/gzip.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

constexpr std::string_view to_python =
    "in Python, gridlock.open() reads it, and to_ase() hands its frames to ASE, which writes extended XYZ";
constexpr std::string_view to_xyz = "turn it into extended XYZ: OVITO, ASE and MDAnalysis read it";
constexpr std::string_view to_other = "name a file that holds agents";

struct Mark {
  std::string_view bytes;
  std::size_t place;
  FileFormat format;
};

constexpr std::array marks{
    Mark{"\x89HDF\r\n\x1a\n"sv,
         0,
         {"hdf5", "an HDF5 file, as trajectories in H5MD are",
          "gridlock info and gridlock.open() read trajectories; gridlock export FILE --to xyz makes extended XYZ of "
          "one"}},
    Mark{"\xdf\x65\xdf\x65\xdf\x65\xdf\x65"sv, 0, {"gsd", "a GSD file of HOOMD-blue", to_python}},
    Mark{"CDF\x01"sv, 0, {"netcdf", "a netCDF file", to_xyz}},
    Mark{"CDF\x02"sv, 0, {"netcdf", "a netCDF file", to_xyz}},
    Mark{"CDF\x05"sv, 0, {"netcdf", "a netCDF file", to_xyz}},
    Mark{"ITEM: "sv, 0, {"lammps_dump", "a dump of LAMMPS", to_python}},
    Mark{"CORD"sv, 4, {"dcd", "a DCD trajectory", to_xyz}},
    Mark{"\x00\x00\x07\xcb"sv, 0, {"xtc", "an XTC trajectory of GROMACS", to_xyz}},
    Mark{"\x00\x00\x07\xc9"sv, 0, {"trr", "a TRR trajectory of GROMACS", to_xyz}},
    Mark{"GRIDLOCK"sv,
         0,
         {"checkpoint", "a checkpoint of Gridlock", "name the directory of the run: gridlock resume DIR continues it"}},
    Mark{"\x93NUMPY"sv, 0, {"numpy", "an array of NumPy", "hand the array to the functions of the Python package"}},
    Mark{"PK\x03\x04"sv, 0, {"zip", "a ZIP archive, as .npz files are", "unpack it first"}},
    Mark{"BZh"sv, 0, {"bzip2", "a file that bzip2 packed", "unpack it first, or pack it with gzip"}},
    Mark{"\xfd"
         "7zXZ"sv,
         0,
         {"xz", "a file that xz packed", "unpack it first, or pack it with gzip"}},
    Mark{"\x28\xb5\x2f\xfd"sv, 0, {"zstd", "a file that Zstandard packed", "unpack it first, or pack it with gzip"}},
    Mark{"\x89PNG\r\n"sv, 0, {"png", "a picture (PNG)", to_other}},
    Mark{"%PDF-"sv, 0, {"pdf", "a PDF file", to_other}},
    Mark{"ftyp"sv, 4, {"mp4", "a movie (MP4)", to_other}},
    Mark{"GIF8"sv, 0, {"gif", "a picture or movie (GIF)", to_other}},
    Mark{"\x1a\x45\xdf\xa3"sv, 0, {"webm", "a movie (WebM or Matroska)", to_other}},
    Mark{"<?xml"sv, 0, {"xml", "an XML file, as those of VTK are", to_xyz}},
    Mark{"<VTKFile"sv, 0, {"xml", "an XML file of VTK", to_xyz}},
    Mark{"# vtk DataFile"sv, 0, {"vtk", "a file of VTK", to_xyz}},
    Mark{"LAMMPS data"sv, 0, {"lammps_data", "a data file of LAMMPS", to_xyz}}};

/// Returns whether bytes have no control characters but those between words and lines. The rest of a damaged HDF5 file
/// is therefore no text, since HDF5 begins with a control character.
bool is_text(std::string_view bytes) {
  unsigned char before = 0;
  for (char const byte : bytes) {
    auto const code = static_cast<unsigned char>(byte);
    bool const is_low = code < 0x20 && (code < '\t' || code > '\r');
    // After a byte ≥ 0x80 such a byte continues a character of UTF-8.
    bool const is_high = code >= 0x7F && code < 0xA0 && before < 0x80;
    if (is_low || is_high) return false;
    before = code;
  }
  return !bytes.empty();
}

bool is_extended_xyz(std::string_view text) {
  std::size_t const end = text.find('\n');
  if (end == std::string_view::npos) return false;
  std::string_view const first = text.substr(0, end);
  std::string_view const second = text.substr(end + 1, text.find('\n', end + 1) - end - 1);
  return first.find_first_not_of(" \t\r0123456789") == std::string_view::npos &&
         (second.find("Lattice") != std::string_view::npos || second.find("Properties") != std::string_view::npos);
}

/// Returns the first bytes_of_format bytes of a file, or fewer; none if it is missing or not a regular file.
std::string first_bytes_of(fs::path const& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return "";
  std::ifstream file(path, std::ios::binary);
  std::string first(bytes_of_format, '\0');
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  first.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return first;
}

}  // namespace

std::optional<FileFormat> recognize_format(std::string_view first_bytes) {
  for (Mark const& mark : marks) {
    if (first_bytes.size() >= mark.place && first_bytes.substr(mark.place).starts_with(mark.bytes)) return mark.format;
  }
  return std::nullopt;
}

std::optional<FileFormat> recognize_format(fs::path const& path) {
  return recognize_format(std::string_view(first_bytes_of(path)));
}

std::optional<FileFormat> recognize_text(fs::path const& path) {
  std::string const first = first_bytes_of(path);
  if (is_gzip(first)) return FileFormat{"gzip", "a file that gzip packed", "unpack it first"};
  if (!is_text(first)) return std::nullopt;
  if (is_extended_xyz(first)) {
    return FileFormat{"xyz", "extended XYZ", "gridlock info, gridlock contacts and gridlock.read_xyz() read it"};
  }
  return FileFormat{"text", "a text file", "name the directory of a run, or the file trajectory.h5 in it"};
}

Error wrong_format(FileFormat const& format, std::string const& file, std::string_view wanted) {
  return Error({.what = fmt::format("{} is {}, and {} is read here", file, format.name, wanted),
                .hint = std::string(format.hint),
                .file = file});
}

}  // namespace gridlock
