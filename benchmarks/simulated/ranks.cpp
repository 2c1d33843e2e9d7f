// Steps of `tiled` on the ranks of a simulated cluster. The engine itself runs, every message is sent, and SimGrid's
// SMPI says how long that would take; what ranks compute takes as long as turns and bytes of messages cost on a real
// core. Built and started by simulated_ranks.py.
//
//     smpirun -np RANKS … gridlock_bench_simulated_ranks DISKS STEPS NANOSECONDS_OF_TURN NANOSECONDS_OF_BYTE
//     smpirun -np 1 … gridlock_bench_simulated_ranks DISKS RANKS
//
// The former prints ranks, disks, the simulated seconds of a step, messages and bytes of a rank and step with what is
// handed out and gathered, and the hash of the last state; the latter the mean number of disks of a rank as a share of
// the largest one.

#include <fmt/format.h>
#include <mpi.h>
#include <smpi/smpi.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "engine/tiled/shared_engine.hpp"
#include "gridlock-mpi/mpi_ranks.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/detail/tile_division.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "parallel/disks_of_all.hpp"

namespace {

/// All ranks call it; the root prints.
void run(gridlock::Communicator& ranks, std::size_t disks, std::uint64_t steps) {
  gridlock::State state = gridlock::make_start(gridlock::Box(1.0, 1.0, gridlock::Edge::periodic),
                                               {.count = disks, .packing_fraction = 0.7}, 20);
  gridlock::draw_velocities(state, {});
  state = gridlock::deal_out(ranks, std::move(state));
  gridlock::EngineSettings const settings{.kind = "tiled", .threads = 1, .processes = ranks};
  auto const engine = gridlock::make_engine(settings, state);
  // The root looks up when all ranks have taken their first step, and then now and then.
  double first_seconds = 0.0;
  double last_seconds = 0.0;
  std::uint64_t first_step = 0;
  gridlock::Counters counters;
  gridlock::StopCondition stop{.step = steps};
  stop.should_continue = [&] {
    last_seconds = ranks.seconds();
    if (first_step == 0) {
      first_seconds = last_seconds;
      first_step = state.clock.step;
    }
    return true;
  };
  engine->advance(state, counters, stop);
  std::uint64_t const sum = gridlock::all_sum(ranks, gridlock::sum_of_hashes(state.agents));
  if (ranks.rank() > 0) return;
  double messages = 0.0;
  double bytes = 0.0;
  for (gridlock::Traffic const& rank : ranks.traffic_of_ranks()) {
    messages += static_cast<double>(rank.messages);
    bytes += static_cast<double>(rank.bytes);
  }
  double const rank_steps = static_cast<double>(ranks.count() * steps);
  double const seconds = (last_seconds - first_seconds) / static_cast<double>(steps - first_step);
  fmt::print("{},{},{:.6g},{:.4g},{:.5g},{:016x}\n", ranks.count(), disks, seconds, messages / rank_steps,
             bytes / rank_steps, gridlock::hash_of_world(state.box, state.clock, state.seed, disks, sum));
}

/// How evenly the tiles of so many disks in a square lattice are divided: the mean number of disks of a rank as a share
/// of the largest one.
double balance_of(double disks, std::size_t ranks) {
  gridlock::Box const box(1.0, 1.0, gridlock::Edge::periodic);
  double const radius = std::sqrt(0.7 / (std::numbers::pi * disks));
  gridlock::CellLayout const layout = gridlock::tiled_layout(
      {.kind = "tiled"}, box, {.count = static_cast<std::size_t>(disks), .radii = {radius, radius}});
  gridlock::Tiling const tiling(layout);
  std::vector<std::uint64_t> cells_of_tile;
  for (gridlock::Tiling::Tile const& tile : tiling.tiles()) {
    int const cells = (tile.end_column - tile.first_column) * (tile.end_row - tile.first_row);
    cells_of_tile.push_back(static_cast<std::uint64_t>(cells));
  }
  std::uint64_t largest = 0;
  for (gridlock::Tiling::Rectangle const& of_rank : divide_tiles(tiling, cells_of_tile, ranks)) {
    std::uint64_t cells = 0;
    of_rank.for_each_tile(
        [&](std::size_t column, std::size_t row) { cells += cells_of_tile[tiling.number_of(column, row)]; });
    largest = std::max(largest, cells);
  }
  return static_cast<double>(layout.count()) / static_cast<double>(ranks) / static_cast<double>(largest);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  if (argc == 3) {
    fmt::print("{:.4f}\n", balance_of(std::stod(argv[1]), std::stoul(argv[2])));
    MPI_Finalize();
    return EXIT_SUCCESS;
  }
  if (argc != 5) {
    fmt::print(stderr, "usage: gridlock_bench_simulated_ranks DISKS STEPS NANOSECONDS_OF_TURN NANOSECONDS_OF_BYTE\n");
    MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
  }
  double const seconds_of_turn = 1e-9 * std::stod(argv[3]);
  double const seconds_of_byte = 1e-9 * std::stod(argv[4]);
  {
    gridlock::mpi::MpiRanks ranks(MPI_COMM_WORLD, 1,
                                  {.is_stop_asked = [] { return false; },
                                   .ask_to_stop = [] {},
                                   .complain = [](std::string const& why) { fmt::print(stderr, "{}\n", why); },
                                   .waits_in_mpi = true,
                                   .on_work =
                                       [&](std::uint64_t turns, std::size_t bytes) {
                                         smpi_execute(seconds_of_turn * static_cast<double>(turns) +
                                                      seconds_of_byte * static_cast<double>(bytes));
                                       }});
    run(ranks, std::stoul(argv[1]), std::stoul(argv[2]));
  }
  MPI_Finalize();
  return EXIT_SUCCESS;
}
