#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/engine/swap_monte_carlo.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

namespace gridlock {

/// The disks of a state, in the order of their Ids, and the trial moves of swap Monte Carlo.
class SwapTrials {
 public:
  explicit SwapTrials(State const& state);

  struct Sweep {
    std::uint64_t number = 0;  ///< number of the sweep among all sweeps, which selects its random numbers
    double swap_fraction = 0.0;
    double step = 0.0;  ///< largest displacement along x and along y, at most half the shorter side
  };
  /// Makes N trial moves, where N is the number of disks.
  void take(Sweep const& sweep, SwapCounts& counts);

  /// Multiplies all radii by one factor, unless two disks or a disk and a wall would then overlap; returns whether it
  /// did.
  bool scale_radii(double factor);

  void write_back(State& state) const;

  [[nodiscard]] std::size_t size() const { return disks_.size(); }
  [[nodiscard]] Vector position(std::size_t i) const { return disks_[i].position; }
  /// Returns the position of disk i without wrapping into the periodic box.
  [[nodiscard]] Vector unwrapped(std::size_t i) const {
    Disk const& disk = disks_[i];
    return {disk.position.x + disk.image_x * box_.width(), disk.position.y + disk.image_y * box_.height()};
  }
  [[nodiscard]] Box const& box() const { return box_; }
  [[nodiscard]] PackedGrid const& grid() const { return grid_; }

 private:
  struct alignas(32) Disk {
    Vector position;
    double radius = 0.0;
    std::int32_t image_x = 0;
    std::int32_t image_y = 0;
  };
  /// A trial move drawn from random numbers.
  struct Trial {
    bool is_swap;
    std::uint32_t disk;
    std::uint32_t other;  ///< the other disk of a swap
    Vector displacement;  ///< used unless the trial is a swap
  };
  static constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

  /// Sorts the disks into cells that are as wide as the largest contact distance after radii grow by `growth`.
  void fill_grid(double growth);
  [[nodiscard]] Trial draw(Sweep const& sweep, std::uint64_t number) const;
  void displace(Trial const& trial, SwapCounts& counts);
  void swap(Trial const& trial, SwapCounts& counts);
  /// A disk's position and radius in a trial, and two disks that it may overlap: itself and its partner in a swap.
  struct Room {
    Vector place;
    double radius;
    std::uint32_t disk;
    std::uint32_t other;
  };
  /// Returns whether no disk but the excepted two overlaps `room`.
  [[nodiscard]] bool is_free(Room const& room) const;
  [[nodiscard]] bool is_free_in_further_blocks(std::array<PackedGrid::Block const*, 9> const& around,
                                               Room const& room) const;
  [[nodiscard]] PackedGrid::LocalPoint seen_from(PackedGrid::LocalPoint here, std::size_t k) const;
  [[nodiscard]] bool is_inside(Vector p, double radius) const;
  [[nodiscard]] bool overlaps(Vector p, double radius, std::uint32_t j) const;

  Box box_;
  std::uint64_t seed_;
  std::vector<Disk> disks_;
  std::vector<std::uint32_t> row_;  ///< row of each disk in the state
  double largest_radius_;
  double widest_contact_ = 0.0;  ///< contact distance for which the cells of the grid are wide enough
  PackedGrid grid_;
  double limit_per_area_ = 0.0;
  float limit_error_ = 0.0F;
  std::vector<double> radii_before_;  ///< radii before the last change of all
};

}  // namespace gridlock
