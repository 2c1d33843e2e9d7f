// The rows of a potential from a file beside the settings.

#include "simulation/potential_file.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/simulation/simulate.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

class PotentialFile : public testing::Test {
 protected:
  gridlock::Setup set_up_with(std::string const& table, std::string const& more = "") {
    write_file(directory_ / "ramp.csv", table);
    write_file(directory_ / "run.toml",
               "disks = { count = 100, packing_fraction = 0.4 }\nbox.edge = \"periodic\"\nengine.kind = \"soft\"\n"
               "[potential]\nkind = \"table\"\nfile = \"ramp.csv\"\n" +
                   more);
    return set_up(SettingsFile::from_path(directory_ / "run.toml"));
  }
  std::string problem_with(std::string const& table, std::string const& more = "") {
    try {
      set_up_with(table, more);
    } catch (Error const& error) {
      return error.problems().front().what;
    }
    return "";
  }
  TemporaryDirectory directory_;
};

TEST_F(PotentialFile, BecomesTheRowsOfTheConfiguration) {
  gridlock::Setup const setup = set_up_with("# of a fit\ndistance,energy\n0.8,5\n0.9,2.5\n1,1\n1.2,0\n");
  PotentialSettings const& potential = setup.configuration.engine.potential;
  EXPECT_EQ(potential.distances, (std::vector{0.8, 0.9, 1.0, 1.2}));
  EXPECT_EQ(potential.energies, (std::vector{5.0, 2.5, 1.0, 0.0}));
  EXPECT_EQ(potential.file, "") << "a run is continued without the file";
  EXPECT_TRUE(setup.notes.empty());
}

TEST_F(PotentialFile, IsNamedWithItsLineWhereARowIsWrong) {
  try {
    set_up_with("# of a fit\ndistance,energy\n0.8,5\n\n0.9,2.5\n# twice\n0.9,1\n1.2,0\n");
    ADD_FAILURE() << "the row is taken";
  } catch (Error const& error) {
    Problem const& problem = error.problems().front();
    EXPECT_EQ(problem.file, (directory_ / "ramp.csv").string());
    EXPECT_EQ(problem.line, 7);
    EXPECT_EQ(problem.source_line, "0.9,1");
    EXPECT_EQ(problem.what,
              "the distances of the table of the potential do not increase: row 2 has 0.9, and row 3 after it 0.9");
  }
}

TEST_F(PotentialFile, IsRefusedWithoutItsColumnsOrBesideRows) {
  EXPECT_EQ(problem_with("r,energy\n0.8,5\n0.9,2\n1,1\n1.2,0\n"),
            "the table of the potential has no column distance; its columns are r, energy");
  EXPECT_EQ(problem_with("distance,energy\n0.8,5\n0.9,2\n1.2,0\n"),
            "the table of the potential has 3 rows, and a spline needs at least 4");
  EXPECT_EQ(problem_with("distance,energy\n0.8,5\n0.9,2\n1,1\n1.2,0\n", "energies = [1.0, 0.0]\n"),
            "potential.file is \"ramp.csv\", and the rows of the table are given beside it");
}

}  // namespace
}  // namespace gridlock
