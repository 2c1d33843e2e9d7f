// The bits of the golden scenes on the ranks of MPI: those of the table that one process has.
#include <gtest/gtest.h>

#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

#include "golden/scenes.hpp"
#include "golden/table.hpp"
#include "mpi/mpirun.hpp"

namespace {

using namespace gridlock::test;

TEST(MpiGolden, HasTheBitsOfTheTableOnAnyNumberOfRanksAndThreads) {
  Workplace const workplace;
  gridlock::HashTable disks("hashes.csv");
  gridlock::HashTable models("models.csv");
  // Ranks that are threads of one process have these bits on more numbers of ranks, in the property tests.
  for (int const ranks : {1, 2, 3, 6}) {
    for (char const* const threads : ranks == 3 ? std::vector{"1", "2"} : std::vector{"1"}) {
      Outcome const outcome = mpirun(workplace, {"-n", std::to_string(ranks), GRIDLOCK_MPI_GOLDEN, threads}).wait();
      expect_good(outcome);
      std::istringstream lines(outcome.out);
      std::size_t scenes_of_models = 0;
      std::size_t scenes_of_disks = 0;
      for (std::string scene, engine, start, end; lines >> scene >> engine >> start >> end;) {
        SCOPED_TRACE(scene + ", " + std::to_string(ranks) + " ranks, " + threads + " threads");
        bool const is_of_disks = engine == "tiled";
        ++(is_of_disks ? scenes_of_disks : scenes_of_models);
        (is_of_disks ? disks : models).expect({scene, engine}, {start, end});
      }
      EXPECT_EQ(scenes_of_disks, gridlock::golden::scenes().size() + gridlock::golden::scenes_of_active_disks().size());
      EXPECT_EQ(scenes_of_models, 5U);
    }
  }
}

}  // namespace
