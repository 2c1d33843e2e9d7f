#include "simulation/potential_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstddef>
#include <sstream>
#include <string>
#include <utility>

#include "core/energy_table.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/io/table.hpp"
#include "io/file.hpp"

namespace gridlock {

namespace {

/// Finds the line of a row of a table, counted from 0, which read_csv() has read.
void find_line(std::filesystem::path const& path, std::size_t row, Problem& problem) {
  std::istringstream text(read_file(path));
  std::size_t left = row + 2;  // the names of the columns come first
  for (std::string line; left > 0 && std::getline(text, line);) {
    ++problem.line;
    if (line.ends_with('\r')) line.pop_back();
    if (!line.empty() && line.front() != '#') --left;
    problem.source_line = line;
  }
}

/// Throws the Error of require_table() with the place in the file.
void require_rows(PotentialSettings const& potential, std::filesystem::path const& path) {
  try {
    require_table(potential.distances, potential.energies);
  } catch (Error const& error) {
    Problem problem = error.problems().front();
    problem.file = path.string();
    std::size_t const bracket = problem.key.find('[');
    if (bracket != std::string::npos) find_line(path, std::stoul(problem.key.substr(bracket + 1)), problem);
    problem.key = "potential.file";
    throw Error(std::move(problem));
  }
}

}  // namespace

std::filesystem::path take_table_file(PotentialSettings& potential, std::filesystem::path const& directory) {
  if (potential.kind != PairPotential::table || potential.file.empty()) return {};
  if (!potential.distances.empty() || !potential.energies.empty()) {
    throw Error(
        {.what = fmt::format("potential.file is \"{}\", and the rows of the table are given beside it", potential.file),
         .hint = "leave out potential.file, or potential.distances and potential.energies",
         .key = "potential.file"});
  }
  std::filesystem::path path = directory / potential.file;
  Table const rows = read_csv(path);
  for (char const* column : {"distance", "energy"}) {
    if (rows.contains(column)) continue;
    throw Error({.what = fmt::format("the table of the potential has no column {}; its columns are {}", column,
                                     fmt::join(rows.names(), ", ")),
                 .hint = "name two columns in the first line: distance,energy",
                 .file = path.string()});
  }
  potential.distances = rows.numbers("distance");
  potential.energies = rows.numbers("energy");
  require_rows(potential, path);
  potential.file.clear();
  return path;
}

}  // namespace gridlock
