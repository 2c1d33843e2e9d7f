#include "simulation/potential_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/table.hpp"

namespace gridlock {

void take_table_file(PotentialSettings& potential, std::filesystem::path const& directory) {
  if (potential.kind != PairPotential::table || potential.file.empty()) return;
  if (!potential.distances.empty() || !potential.energies.empty()) {
    throw Error(
        {.what = fmt::format("potential.file is \"{}\", and the rows of the table are given beside it", potential.file),
         .hint = "leave out potential.file, or potential.distances and potential.energies",
         .key = "potential.file"});
  }
  std::filesystem::path const path = directory / potential.file;
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
  potential.file.clear();
}

}  // namespace gridlock
