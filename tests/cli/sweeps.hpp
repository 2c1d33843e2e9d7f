#pragma once

#include <cstddef>
#include <string>

#include "cli/program.hpp"
#include "gridlock/io/table.hpp"

namespace gridlock::test {

inline std::string sweep_toml(std::string const& densities, std::string const& steps = "300") {
  return "[disks]\ncount = 64\n[run]\nsteps = " + steps +
         "\n[observe]\nevery = 50\n[checkpoint]\nevery_seconds = 0.05\n[sweep]\n\"disks.packing_fraction\" = [" +
         densities + "]\nrun.seed = [1, 2]\n";
}

/// sweep.csv without the times runs took.
inline std::string rows_of(fs::path const& directory) {
  gridlock::Table const table = gridlock::read_csv(directory / "sweep.csv");
  gridlock::Table kept;
  for (std::size_t k = 0; k < table.column_count(); ++k) {
    if (table.names()[k] != "seconds") kept.add_column(table.names()[k], table.column(k));
  }
  return to_csv(kept);
}

}  // namespace gridlock::test
