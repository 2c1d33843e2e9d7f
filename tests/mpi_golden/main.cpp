// The golden scenes by `tiled` and of models that ranks can share on the ranks of MPI: prints name, engine or model,
// and the hashes that each begins and ends with.
//
//     mpirun -n 4 gridlock_mpi_golden THREADS
#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "golden/model_scenes.hpp"
#include "golden/scenes.hpp"
#include "gridlock-mpi/mpi_ranks.hpp"
#include "gridlock/model/detail/shared_model_engine.hpp"
#include "gridlock/simulation/model_simulation.hpp"
#include "gridlock/simulation/world_simulation.hpp"
#include "parallel/disks_of_all.hpp"

namespace {

/// All ranks call it; the root prints.
template <class Model>
void run_model(gridlock::Communicator& ranks, std::string const& scene, Model const& model, gridlock::Box const& box,
               std::uint64_t steps, std::uint64_t threads) {
  gridlock::World<Model> own{.box = box, .agents = {}, .clock = {}, .seed = gridlock::golden::seed_of_models};
  gridlock::start_together(model, own, ranks, [](auto const& act) { act(); });
  gridlock::ModelSimulation<Model> simulation(
      model, std::move(own), std::make_unique<gridlock::SharedModelEngine<Model>>(model, ranks, threads), {}, ranks);
  std::uint64_t const start = simulation.state_hash();
  simulation.advance({.step = steps});
  std::uint64_t const end = simulation.state_hash();
  if (ranks.rank() > 0) return;
  // A scene in which nothing happens would prove nothing.
  bool const all_happen =
      std::ranges::all_of(simulation.counts(), [](gridlock::Count const& count) { return count.value > 0; });
  fmt::print("{} {} {:016x} {}\n", scene, Model::name, start, all_happen ? fmt::format("{:016x}", end) : "-");
}

/// A scene of disks by `tiled`. All ranks call it; the root prints.
void run_disks(gridlock::Communicator& ranks, gridlock::golden::Scene const& scene, std::uint64_t threads) {
  gridlock::State state = gridlock::golden::start_of(scene);
  std::string const start = gridlock::golden::hash_text(state);
  gridlock::State own = gridlock::deal_out(ranks, state);
  gridlock::EngineSettings settings = scene.engine;
  settings.kind = "tiled";
  settings.threads = threads;
  settings.processes = ranks;
  gridlock::DiskSimulation simulation(gridlock::make_engine(settings, own), std::move(own), ranks);
  simulation.advance({.time = scene.time});
  std::uint64_t const end = simulation.state_hash();
  if (ranks.rank() == 0) fmt::print("{} tiled {} {:016x}\n", scene.name, start, end);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    gridlock::mpi::MpiRanks ranks(MPI_COMM_WORLD, 1,
                                  {.is_stop_asked = [] { return false; },
                                   .ask_to_stop = [] {},
                                   .complain = [](std::string const& why) { fmt::print(stderr, "{}\n", why); }});
    for (gridlock::golden::Scene const& scene : gridlock::golden::scenes()) {
      run_disks(ranks, scene, std::stoul(argv[1]));
    }
    for (gridlock::golden::Scene const& scene : gridlock::golden::scenes_of_active_disks()) {
      run_disks(ranks, scene, std::stoul(argv[1]));
    }
    gridlock::golden::for_each_shared_scene(
        [&](std::string const& scene, auto const& model, gridlock::Box const& box, std::uint64_t steps) {
          run_model(ranks, scene, model, box, steps, std::stoul(argv[1]));
        });
  }
  MPI_Finalize();
  return EXIT_SUCCESS;
}
