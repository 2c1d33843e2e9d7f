#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "device/backend.hpp"
#include "device/tiled_kernels.hpp"
#include "engine/tiled/step_taker.hpp"
#include "gridlock/core/detail/counters_of_step.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

namespace gridlock::device {

namespace {

/// Returns the largest number of cells of a class in a tile.
std::size_t max_cells_of_class(Tiling const& tiling) {
  int max = 0;
  for (Tiling::Tile const& tile : tiling.tiles()) max = std::max(max, CellsOfClass(tile, 0).size());
  return static_cast<std::size_t>(max);
}

/// Returns the blocks of a grid, and behind them as many as it may need for any positions of the disks; those that no
/// cell uses are in a list.
std::vector<PackedBlock> with_free_blocks(PackedGrid const& grid, std::size_t disks) {
  std::span<PackedBlock const> const used = grid.blocks();
  std::vector<PackedBlock> blocks(used.begin(), used.end());
  blocks.resize(std::max(used.size(), grid.max_blocks_for(disks)) + 1);
  for (std::size_t k = used.size(); k < blocks.size(); ++k) blocks[k].next = static_cast<std::uint32_t>(k + 1);
  return blocks;
}

/// The memory of a device for TiledMemory.
struct Arrays {
  Arrays(PackedGrid const& grid, HotDisks const& all, ObstaclesView const& walls, Tiling const& tiling)
      : disks(std::span(&all[0], all.size())),
        blocks(with_free_blocks(grid, all.size())),
        places(grid.places()),
        free_head(1),
        obstacles(walls.all),
        begin_of_obstacles(walls.begin_of_cell),
        obstacles_in_cells(walls.in_cells),
        tiles(tiling.tiles()),
        terms(all.size()),
        last_step(all.size()),
        next_turn(all.size()),
        first_turn(static_cast<std::size_t>(grid.layout().count())),
        counts_of_cell(first_turn.size()),
        next_late(all.size()),
        first_late(tiles.size()),
        tiles_with_late(tiles.size()),
        sums(SumOfTile::kinds * tiles.size()),
        counts(1) {
    std::uint64_t const first_free = grid.blocks().size();
    free_head.upload(std::span(&first_free, 1));
  }

  Array<DiskInTurn> disks;
  Array<PackedBlock> blocks;
  Array<std::uint32_t> places;
  Array<std::uint64_t> free_head;
  Array<Obstacle> obstacles;
  Array<std::size_t> begin_of_obstacles;
  Array<std::uint32_t> obstacles_in_cells;
  Array<Tiling::Tile> tiles;
  Array<TurnTerms> terms;
  Array<std::uint32_t> last_step;
  Array<std::uint32_t> next_turn;
  Array<std::uint32_t> first_turn;
  Array<CellCounts> counts_of_cell;
  Array<std::uint32_t> next_late;
  Array<std::uint32_t> first_late;
  Array<std::uint32_t> tiles_with_late;
  Array<double> sums;
  Array<StepCounts> counts;
};

class TiledSteps final : public tiled::StepTaker {
 public:
  TiledSteps(HotDisks const& disks, tiled::TurnRule const& rule, CellLayout const& layout, Tiling const& tiling,
             std::uint64_t threads)
      : TiledSteps(grid_of<PackedGrid>(layout, disks), disks, rule, tiling, threads) {}

  void take_step(std::uint64_t step, Counters& counters) override {
    begin_step(step);
    for (std::size_t colour = 0; colour < Tiling::colours; ++colour) {
      std::size_t const first = tiling_.first_of(colour);
      std::size_t const tiles = tiling_.first_of(colour + 1) - first;
      for (std::size_t of_class = 0; of_class < ClassOrder::classes; ++of_class) take_turns(first, tiles, of_class);
    }
    launcher_.for_each(tiling_.tiles().size(), AddUpTile{memory_});
    arrays_.counts.download(std::span(&counts_, 1));
    if (counts_.tiles_with_late > 0) take_late_turns();
    add_to(counters);
  }

  [[nodiscard]] std::optional<tiled::TooFast> too_fast() const override {
    if (counts_.too_fast == no_disk) return std::nullopt;
    return tiled::TooFast{.row_in_state = row_in_state_[counts_.too_fast], .displacement = counts_.displacement};
  }

  void write_back(State& state) override {
    std::vector<DiskInTurn> disks(arrays_.disks.size());
    arrays_.disks.download(disks);
    for (DiskInTurn const& disk : disks) gridlock::write_back(disk, state.agents);
  }

 private:
  TiledSteps(PackedGrid const& grid, HotDisks const& disks, tiled::TurnRule const& rule, Tiling const& tiling,
             std::uint64_t threads)
      : launcher_(threads),
        rule_(rule),
        tiling_(tiling),
        max_cells_(max_cells_of_class(tiling)),
        arrays_(grid, disks, rule.walls.view(), tiling),
        memory_(memory_of(grid)),
        sums_(arrays_.sums.size()) {
    for (std::size_t k = 0; k < disks.size(); ++k) row_in_state_.push_back(disks[k].row_in_state);
  }

  TiledMemory memory_of(PackedGrid const& grid) {
    Arrays& a = arrays_;
    ObstaclesView const walls = rule_.walls.view();
    FreeBlocks const free_blocks{a.free_head.data()};
    return {.box = rule_.box,
            .substep = rule_.duration / static_cast<double>(rule_.substeps),
            .substeps = rule_.substeps,
            .contact = rule_.contact,
            .is_propelled = rule_.heading.is_on(),
            .has_walls = !rule_.box.is_periodic() || !walls.empty(),
            .heading = {},
            .walls = {std::span(a.obstacles.data(), a.obstacles.size()), walls.layout,
                      std::span(a.begin_of_obstacles.data(), a.begin_of_obstacles.size()),
                      std::span(a.obstacles_in_cells.data(), a.obstacles_in_cells.size())},
            .limits = TurnLimits(rule_.box, grid, rule_.radii, rule_.duration, rule_.substeps),
            .smallest_radius = rule_.radii.smallest,
            .cells = Cells(grid, a.blocks.data(), a.places.data(), free_blocks),
            .disks = std::span(a.disks.data(), a.disks.size()),
            .tiles = std::span(a.tiles.data(), a.tiles.size()),
            .terms = a.terms.data(),
            .last_step = a.last_step.data(),
            .next_turn = a.next_turn.data(),
            .first_turn = a.first_turn.data(),
            .counts_of_cell = a.counts_of_cell.data(),
            .next_late = a.next_late.data(),
            .first_late = a.first_late.data(),
            .tiles_with_late = a.tiles_with_late.data(),
            .sums = a.sums.data(),
            .counts = a.counts.data()};
  }

  void begin_step(std::uint64_t step) {
    ++steps_;
    if (memory_.is_propelled) memory_.heading = heading_step(rule_.heading, step);
    counts_ = {};
    counts_.too_fast = no_disk;
    arrays_.counts.upload(std::span(&counts_, 1));
  }

  void take_turns(std::size_t first_tile, std::size_t tiles, std::size_t of_class) {
    if (tiled::goes_around_box(memory_.cells.layout(), tiling_)) {
      launcher_.for_each(tiles, TakeTurnsOfTiles{memory_, steps_, first_tile, of_class});
    } else {
      launcher_.for_each(tiles * max_cells_, TakeTurnsOfCells{memory_, steps_, first_tile, of_class, max_cells_});
    }
  }

  void take_late_turns() {
    std::vector<std::uint32_t> tiles(counts_.tiles_with_late);
    arrays_.tiles_with_late.download(tiles);
    std::ranges::sort(tiles);
    arrays_.tiles_with_late.upload(tiles);
    launcher_.for_each(1, TakeLateTurns{memory_, steps_});
    arrays_.counts.download(std::span(&counts_, 1));
  }

  void add_to(Counters& counters) {
    std::size_t const tiles = tiling_.tiles().size();
    std::span<double> const sums = std::span(sums_).first(memory_.kinds_of_sums() * tiles);
    arrays_.sums.download(sums);
    Counters whole_numbers{.moves = counts_.moves,
                           .halted_moves = counts_.halted_moves,
                           .pair_collisions = counts_.pair_collisions,
                           .distance_checks = counts_.distance_checks,
                           .wall_hits = counts_.wall_hits,
                           .inner_wall_hits = counts_.inner_wall_hits};
    if (memory_.is_propelled) {
      whole_numbers.swum = static_cast<double>(counts_.swum);
      whole_numbers.swum_if_free = static_cast<double>(counts_.moves * rule_.substeps);
    }
    CountersOfStep of_step;
    of_step.add(whole_numbers);
    auto const of_kind = [&](std::size_t kind) { return sums.subspan(kind * tiles, tiles); };
    of_step.add_pair_virials(of_kind(SumOfTile::pair_virial));
    if (memory_.has_walls) {
      of_step.add_inner_wall_impulses(of_kind(SumOfTile::inner_wall_impulse));
      for (std::size_t wall = 0; wall < 4; ++wall)
        of_step.add_wall_impulses(wall, of_kind(SumOfTile::wall_impulse + wall));
    }
    of_step.add_to(counters);
  }

  Launcher launcher_;
  tiled::TurnRule rule_;
  Tiling const& tiling_;
  std::size_t max_cells_;
  Arrays arrays_;
  TiledMemory memory_;
  std::uint32_t steps_ = 0;
  StepCounts counts_{};
  std::vector<double> sums_;
  std::vector<std::uint32_t> row_in_state_;
};

}  // namespace

}  // namespace gridlock::device

namespace gridlock::tiled {

std::unique_ptr<StepTaker> steps_on_device(HotDisks const& disks, TurnRule const& rule, CellLayout const& layout,
                                           Tiling const& tiling, std::uint64_t threads) {
  return std::make_unique<device::TiledSteps>(disks, rule, layout, tiling, threads);
}

std::size_t bytes_on_device(std::size_t disks, CellLayout const& layout, Tiling const& tiling) {
  std::size_t const of_disk = sizeof(DiskInTurn) + sizeof(device::TurnTerms) + 4 * sizeof(std::uint32_t);
  std::size_t const blocks =
      static_cast<std::size_t>(layout.columns() + 2) * (layout.rows() + 2) + disks / PackedBlock::slots + 2;
  std::size_t const of_cell = sizeof(std::uint32_t) + sizeof(device::CellCounts);
  std::size_t const of_tile =
      sizeof(Tiling::Tile) + 2 * sizeof(std::uint32_t) + device::SumOfTile::kinds * sizeof(double);
  return disks * of_disk + blocks * sizeof(PackedBlock) + static_cast<std::size_t>(layout.count()) * of_cell +
         tiling.tiles().size() * of_tile;
}

}  // namespace gridlock::tiled
