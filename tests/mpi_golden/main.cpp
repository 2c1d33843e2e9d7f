// The golden scenes by `tiled` and of models that ranks can share on the ranks of MPI: prints name, engine or model,
// and the hashes that each begins and ends with.
//
//     mpirun -n 4 gridlock_mpi_golden THREADS
#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "golden/model_scenes.hpp"
#include "golden/scenes.hpp"
#include "gridlock-mpi/mpi_ranks.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/tasks.hpp"
#include "gridlock/simulation/detail/model_of_rank.hpp"
#include "simulation/help.hpp"

namespace {

/// For the leader.
template <class Model>
std::string hash_of_all(gridlock::Communicator& ranks, gridlock::ModelOfRank<Model> const& own) {
  std::uint64_t const sum = gridlock::all_sum(ranks, own.sum_of_hashes());
  return fmt::format("{:016x}", gridlock::hash_of_world(own.box(), own.clock(), own.seed(), own.count(), sum));
}

/// All ranks call it; the leader prints.
template <class Model>
void run_model(gridlock::Communicator& ranks, std::string const& scene, Model const& model, gridlock::Box const& box,
               std::uint64_t steps, std::uint64_t threads) {
  gridlock::ModelOfRank<Model> own(ranks, model, box, gridlock::golden::seed_of_models, threads,
                                   [](auto const& act) { act(); });
  std::string const start = hash_of_all(ranks, own);
  gridlock::Counters counters;
  if (ranks.rank() == 0) {
    own.advance(counters, {.step = steps});
  } else {
    gridlock::Message const bytes = ranks.receive(0);
    gridlock::MessageReader message(bytes);
    own.carry_out(message.next<gridlock::TaskOfRanks>(), message);
  }
  std::string const end = hash_of_all(ranks, own);
  if (ranks.rank() > 0) return;
  // A scene in which nothing happens would prove nothing.
  bool const all_happen =
      std::ranges::all_of(own.event_counts(counters), [](auto const& count) { return count.value > 0; });
  fmt::print("{} {} {} {}\n", scene, Model::name, start, all_happen ? end : "-");
}

}  // namespace

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
        settings.processes = ranks;
        gridlock::Counters counters;
        gridlock::make_engine(settings, state)->advance(state, counters, {.time = scene.time});
        fmt::print("{} tiled {} {}\n", scene.name, start, gridlock::golden::hash_text(state));
      }
      gridlock::release_helpers(ranks);
    }
    gridlock::golden::for_each_shared_scene(
        [&](std::string const& scene, auto const& model, gridlock::Box const& box, std::uint64_t steps) {
          run_model(ranks, scene, model, box, steps, std::stoul(argv[1]));
        });
  }
  MPI_Finalize();
  return EXIT_SUCCESS;
}
