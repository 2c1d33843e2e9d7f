// The bits of the golden scenes on the ranks of MPI: those of the table that one process has.
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>

#include "golden/scenes.hpp"
#include "golden/table.hpp"
#include "mpi/mpirun.hpp"

namespace {

using namespace gridlock::test;

TEST(MpiGolden, HasTheBitsOfTheTableOnAnyNumberOfRanksAndThreads) {
  Workplace const workplace;
  gridlock::HashTable table("hashes.csv");
  for (int const ranks : {1, 2, 3, 4, 6, 8, 9}) {
    for (char const* const threads : {"1", "2"}) {
      Outcome const outcome = mpirun(workplace, {"-n", std::to_string(ranks), GRIDLOCK_MPI_GOLDEN, threads}).wait();
      expect_good(outcome);
      std::istringstream lines(outcome.out);
      std::map<std::string, std::string> hashes;
      for (std::string name, hash; lines >> name >> hash;) hashes[name] = hash;
      for (gridlock::golden::Scene const& scene : gridlock::golden::scenes()) {
        SCOPED_TRACE(scene.name + ", " + std::to_string(ranks) + " ranks, " + threads + " threads");
        std::string const start = gridlock::golden::hash_text(gridlock::golden::start_of(scene));
        table.expect({scene.name, "tiled"}, {start, hashes[scene.name]});
      }
    }
  }
}

}  // namespace
