#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/soft/disks.hpp"
#include "engine/soft/drag.hpp"
#include "engine/soft/forces.hpp"
#include "engine/soft/lists.hpp"
#include "engine/soft/moves.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::soft {

/// Returns the distances of lists for disks with these radii in a box. Errors: Error for a box that is too small for
/// the cutoff.
ListReach list_reach(PotentialSettings const& potential, Box const& box, RadiusRange const& radii);

/// Soft disks on their way from one state to a later one.
///
/// Each disk adds up the forces of all its neighbours. The sums are exact, so that the bits depend neither on the lists
/// nor on the threads; two disks give each other opposite forces to the last bit.
class System {
 public:
  /// Contract: a state and settings that the engine accepts. `skin` in smallest diameters changes no bits.
  System(EngineSettings const& settings, State const& state, ThreadPool& pool, double skin);

  /// Moves all disks on by one time step. Errors: RunFailure for disks that move or approach too far in a step.
  void take_step(std::uint64_t step);

  [[nodiscard]] double duration() const { return moves_.duration; }
  [[nodiscard]] Disks const& disks() const { return disks_; }
  [[nodiscard]] Box const& box() const { return box_; }
  /// Returns the energy of all pairs.
  [[nodiscard]] double potential_energy() const;
  [[nodiscard]] double kinetic_energy() const;

 private:
  /// Calls do_part(band, result) for each band, and adds up the results.
  template <class Result, class DoPart>
  Result for_bands(DoPart do_part);
  template <class DoPart>
  void for_each_band(DoPart do_part);
  void list_again();
  /// Moves the images of the box with the flow for one time step.
  void move_images();
  /// Returns whether a pair that no list has may be nearer than the cutoff.
  [[nodiscard]] bool are_lists_old(double squared_drift) const;
  void compute_forces(std::uint64_t step);
  using UseDrags = double (*)(DragRule const& rule, Box const& box, Band const& band, Disks& disks);
  /// Calls use() for each band. Errors: RunFailure for drags that cannot be added up.
  void use_drags(std::uint64_t step, UseDrags use);
  [[noreturn]] void throw_long_step(std::uint64_t step, LongestWays const& ways) const;
  [[noreturn]] void throw_near_pair(std::uint64_t step) const;
  [[noreturn]] void throw_strong_drag(std::uint64_t step, double drag) const;

  EngineSettings settings_;
  Box box_;
  ThreadPool& pool_;
  double smallest_diameter_;
  ForceRule forces_;
  std::optional<DragRule> drag_;
  MoveRule moves_;
  ListReach reach_;
  ComputeForces kernel_;
  Disks disks_;
  std::vector<Band> bands_;
};

}  // namespace gridlock::soft
