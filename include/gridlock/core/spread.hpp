#pragma once

#include "gridlock/core/box.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/field.hpp"
#include "gridlock/core/target.hpp"

namespace gridlock {

/// Spreads a field by diffusion for a time t, and lets it decay: ∂u/∂t = D ∇²u − k u on the cells of the grid.
///
/// The step is the exact solution for cells that exchange with their four neighbours, whatever D t is: each value is
/// distributed along x and then along y with the weights e^(−2λ) Iₙ(2λ), λ = D t / h² with h the width of a cell and Iₙ
/// the modified Bessel function (T. Lindeberg, 1990, doi:10.1109/34.49051). Nothing flows through walls; periodic edges
/// are closed. So the sum of all values is multiplied by e^(−k t), but for rounding, and no value goes below the least
/// one or above the largest one before. Only the four operations are used: the bits are the same on any number of
/// threads and on any processor.
/// Errors: Error if an amount is negative, infinite or no number. Cost: about 2 (7 + 10 √λ) multiplications a cell.
///
/// ```cpp
/// Box const box(1.0, 1.0, Edge::wall);
/// Field heat("heat", 50, 50);
/// heat.values()[1275] = 1.0;
/// ThreadPool threads(1);
/// double const time = 0.5;
/// spread(heat, box, {.diffusion = 1e-3 * time, .decay = 0.1 * time}, threads);
/// ```
struct Spreading {
  double diffusion = 0.0;  ///< D t, an area
  double decay = 0.0;      ///< k t, a pure number
};
void spread(Field& field, Box const& box, Spreading const& amounts, ThreadPool& threads,
            Target instructions = target());

}  // namespace gridlock
