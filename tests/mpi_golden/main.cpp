// The golden scenes by `tiled` on the ranks of MPI: prints the name of each and the hash it ends with.
//
//     mpirun -n 4 gridlock_mpi_golden THREADS
#include <fmt/format.h>
#include <mpi.h>

#include <cstdlib>
#include <string>

#include "engine/tiled/on_ranks.hpp"
#include "golden/scenes.hpp"
#include "gridlock-mpi/mpi_ranks.hpp"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    gridlock::mpi::MpiRanks ranks(MPI_COMM_WORLD, 1,
                                  {.is_stop_asked = [] { return false; },
                                   .ask_to_stop = [] {},
                                   .complain = [](std::string const& why) { fmt::print(stderr, "{}\n", why); }});
    if (ranks.rank() > 0) {
      gridlock::tiled::help(ranks);
    } else {
      for (gridlock::golden::Scene const& scene : gridlock::golden::scenes()) {
        gridlock::State state = gridlock::golden::start_of(scene);
        gridlock::EngineSettings settings = scene.engine;
        settings.kind = "tiled";
        settings.threads = std::stoul(argv[1]);
        settings.ranks = &ranks;
        gridlock::Counters counters;
        gridlock::make_engine(settings, state)->advance(state, counters, {.time = scene.time});
        fmt::print("{} {}\n", scene.name, gridlock::golden::hash_text(state));
      }
      gridlock::tiled::release_helpers(ranks);
    }
  }
  MPI_Finalize();
  return EXIT_SUCCESS;
}
