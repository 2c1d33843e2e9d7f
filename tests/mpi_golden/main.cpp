// The golden scenes by `tiled` and of models that ranks can share on the ranks of MPI: prints name, engine or model, and the hashes that each begins
// and ends with.
//
//     mpirun -n 4 gridlock_mpi_golden THREADS
#include <fmt/format.h>
#include <mpi.h>

#include <cstdlib>
#include <string>
#include <type_traits>

#include "golden/model_scenes.hpp"
#include "golden/scenes.hpp"
#include "gridlock-mpi/mpi_ranks.hpp"
#include "simulation/help.hpp"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    gridlock::mpi::MpiRanks ranks(MPI_COMM_WORLD, 1,
                                  {.is_stop_asked = [] { return false; },
                                   .ask_to_stop = [] {},
                                   .complain = [](std::string const& why) { fmt::print(stderr, "{}\n", why); }});
    if (ranks.rank() > 0) {
      gridlock::help(ranks);
    } else {
      for (gridlock::golden::Scene const& scene : gridlock::golden::scenes()) {
        gridlock::State state = gridlock::golden::start_of(scene);
        std::string const start = gridlock::golden::hash_text(state);
        gridlock::EngineSettings settings = scene.engine;
        settings.kind = "tiled";
        settings.threads = std::stoul(argv[1]);
        settings.ranks = &ranks;
        gridlock::Counters counters;
        gridlock::make_engine(settings, state)->advance(state, counters, {.time = scene.time});
        fmt::print("{} tiled {} {}\n", scene.name, start, gridlock::golden::hash_text(state));
      }
      gridlock::golden::for_each_shared_scene(
          [&](std::string const& scene, auto const& model, gridlock::Box const& box, std::uint64_t steps) {
            auto const [start, end] =
                gridlock::golden::hashes_of(model, box, steps, {.threads = std::stoul(argv[1]), .ranks = &ranks});
            fmt::print("{} {} {} {}\n", scene, std::remove_cvref_t<decltype(model)>::name, start, end);
          });
      gridlock::release_helpers(ranks);
    }
  }
  MPI_Finalize();
  return EXIT_SUCCESS;
}
