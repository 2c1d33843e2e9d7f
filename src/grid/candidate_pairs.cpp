#include "grid/candidate_pairs.hpp"

#include <algorithm>
#include <array>

#include "grid/require.hpp"

namespace gridlock {

namespace {

using Block = PackedGrid::Block;
using LocalPoint = PackedGrid::LocalPoint;

constexpr std::array<unsigned, PackedGrid::slots> later_slots{14U, 12U, 8U, 0U};

/// Writes the pairs of an agent with the slots of a block whose bits are set. Returns the end of the pairs.
inline PairBuffer::Pair* write_pairs(std::uint32_t agent, Block const& block, unsigned slots_set,
                                     PairBuffer::Pair* pair) {
  for (std::size_t s = 0; s < PackedGrid::slots; ++s) {
    *pair = {agent, block.agent[s]};
    pair += (slots_set >> s) & 1U;
  }
  return pair;
}

/// Finds pairs for blocks that go around a periodic box: it searches whole blocks and keeps each pair for its higher
/// row.
void find_pairs_of_whole_blocks(PackedGrid const& grid, int reach_columns, int reach_rows, PairBuffer& buffer) {
  CellNumbers const cells(grid.layout(), grid.window());
  for (int row = 0; row < cells.rows(); ++row) {
    for (int column = 0; column < cells.columns(); ++column) {
      int const cell = cells.row_at(row) * grid.layout().columns() + cells.column_at(column);
      grid.for_each_in_cell(cell, [&](std::size_t i) {
        grid.for_each_in_block(cell, reach_columns, reach_rows, [&](std::size_t j) {
          PairBuffer::Pair* const pair = buffer.room_for(1);
          *pair = {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)};
          buffer.keep_until(pair + (j < i ? 1 : 0));
        });
      });
    }
  }
}

}  // namespace

std::span<SeenBlock const> blocks_seen_from(HalfBlock& half, int column, int row) {
  PackedGrid const& grid = half.grid;
  PlacesOfWindow const columns = columns_of_window(grid);
  PlacesOfWindow const rows = rows_of_window(grid);
  half.seen.clear();
  auto const add_cell = [&](int dc, int dr) {
    if (!columns.has(column + dc) || !rows.has(row + dr)) return;
    float const shift_x = -static_cast<float>(dc) * grid.local_width();
    float const shift_y = -static_cast<float>(dr) * grid.local_height();
    for (Block const* block = &grid.block_at(columns.at(column + dc), rows.at(row + dr));;
         block = &grid.next_of(*block)) {
      half.seen.push_back({block, shift_x, shift_y});
      if (block->next == PackedGrid::none) return;
    }
  };
  for (int dc = 0; dc <= half.reach_columns; ++dc) add_cell(dc, 0);
  for (int dr = 1; dr <= half.reach_rows; ++dr) {
    for (int dc = -half.reach_columns; dc <= half.reach_columns; ++dc) add_cell(dc, dr);
  }
  return half.seen;
}

void add_pairs_of_cell_scalar(HalfBlock& half, int column, int row, PairBuffer& buffer) {
  constexpr std::size_t max_at_once = 64;
  std::span<SeenBlock const> const seen = blocks_seen_from(half, column, row);
  float const limit = half.limit;
  Block const* home = seen.front().block;
  for (std::size_t k = 0;; ++k) {
    for (std::uint32_t s = 0; s < home->count; ++s) {
      unsigned allowed = later_slots[s];
      for (std::size_t first = k; first < seen.size(); first += max_at_once) {
        PairBuffer::Pair* pair = buffer.room_for(PackedGrid::slots * max_at_once);
        for (SeenBlock const& other : seen.subspan(first, std::min(max_at_once, seen.size() - first))) {
          LocalPoint const p{home->x[s] + other.shift_x, home->y[s] + other.shift_y};
          unsigned const near = PackedGrid::near_bits(*other.block, p, limit);
          pair = write_pairs(home->agent[s], *other.block, near & allowed, pair);
          allowed = ~0U;
        }
        buffer.keep_until(pair);
      }
    }
    if (home->next == PackedGrid::none) return;
    home = &half.grid.next_of(*home);
  }
}

void add_pairs_of_row_scalar(HalfBlock& half, int row, PairBuffer& buffer) {
  PackedGrid const& grid = half.grid;
  float const width = grid.local_width();
  float const height = grid.local_height();
  bool const is_3_by_3 = half.reach_columns <= 1 && half.reach_rows <= 1;
  float const limit = half.limit;
  RowOfCells const cells(grid, row);
  for (int column = 0; column < cells.columns(); ++column) {
    FiveBlocks const blocks = cells.at(column);
    if (!is_3_by_3 || !blocks.are_all()) {
      add_pairs_of_cell_scalar(half, column, row, buffer);
      continue;
    }
    Block const& home = blocks.home;
    PairBuffer::Pair* pair = buffer.room_for(5 * PackedGrid::slots * PackedGrid::slots);
    for (std::uint32_t s = 0; s < home.count; ++s) {
      LocalPoint const p{home.x[s], home.y[s]};
      std::uint32_t const agent = home.agent[s];
      auto const add = [&](Block const& block, LocalPoint seen, unsigned allowed) {
        pair = write_pairs(agent, block, PackedGrid::near_bits(block, seen, limit) & allowed, pair);
      };
      add(home, p, later_slots[s]);
      add(blocks.east, {p.x - width, p.y}, ~0U);
      add(blocks.north_west, {p.x + width, p.y - height}, ~0U);
      add(blocks.north, {p.x, p.y - height}, ~0U);
      add(blocks.north_east, {p.x - width, p.y - height}, ~0U);
    }
    buffer.keep_until(pair);
  }
}

AddPairsOfRow add_pairs_kernel(Target target) {
  if (AddPairsOfRow const kernel = add_pairs_with_avx512(target)) return kernel;
#ifdef GRIDLOCK_HIGHWAY
  if (AddPairsOfRow const kernel = add_pairs_with_highway(target)) return kernel;
#endif
  return add_pairs_of_row_scalar;
}

void find_candidate_pairs(PackedGrid const& grid, double cutoff, AddPairsOfRow add_pairs_of_row,
                          OnPairs const& on_pairs) {
  CellLayout const& layout = grid.layout();
  int const columns = layout.columns_within(cutoff);
  int const rows = layout.rows_within(cutoff);
  PairBuffer buffer(on_pairs);
  // Half of the block, to the right and above, finds every pair once, unless the block goes around the box.
  bool const goes_around = (layout.is_periodic_x() && 2.0 * columns + 1.0 > layout.columns()) ||
                           (layout.is_periodic_y() && 2.0 * rows + 1.0 > layout.rows());
  if (goes_around) {
    find_pairs_of_whole_blocks(grid, columns, rows, buffer);
    buffer.flush();
    return;
  }
  HalfBlock half{grid, columns, rows, grid.local_limit(cutoff * cutoff, std::max(columns, rows))};
  for (int row = 0; row < rows_of_window(grid).count(); ++row) add_pairs_of_row(half, row, buffer);
  buffer.flush();
}

bool are_scattered(std::span<AgentPair const> pairs) {
  // Agents whose rows differ by more than this have their lists far apart in memory.
  constexpr std::uint32_t far = 256;
  constexpr std::size_t sample = 16;
  std::size_t scattered = 0;
  for (std::size_t k = 0; k < sample && !pairs.empty(); ++k) {
    AgentPair const& pair = pairs[k * pairs.size() / sample];
    scattered += pair.first > pair.second + far || pair.second > pair.first + far ? 1 : 0;
  }
  return 2 * scattered > sample;
}

void PackedGrid::find_candidate_pairs(double cutoff, OnPairs const& on_pairs) const {
  require_cutoff(cutoff);
  static AddPairsOfRow const kernel = add_pairs_kernel(target());
  gridlock::find_candidate_pairs(*this, cutoff, kernel, on_pairs);
}

}  // namespace gridlock
