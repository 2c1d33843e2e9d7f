#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// One number for each disk and direction.
struct Columns {
  std::vector<double> x;
  std::vector<double> y;

  Columns() = default;
  explicit Columns(std::size_t size) : x(size), y(size) {}
};

/// What forces on all disks add up to.
struct ForceSums {
  double energy = 0.0;
  double contact_forces = 0.0;  ///< Σ f over contacts
  double overlaps = 0.0;        ///< Σ δ over contacts
  std::uint64_t contacts = 0;
  double largest_square = 0.0;  ///< of the net force on a disk
  double force_squares = 0.0;   ///< Σ F²
  double power = 0.0;           ///< Σ F·v
  double speed_squares = 0.0;   ///< Σ v²

  void add(ForceSums const& part);
  /// Adds one contact.
  void count(double energy_of_contact, double force, double overlap) {
    energy += energy_of_contact;
    contact_forces += force;
    overlaps += overlap;
    ++contacts;
  }
  /// Largest net force over the mean contact force; 0 without contacts.
  [[nodiscard]] double residual() const;
};

/// The forces between soft disks, by a Verlet list: pairs nearer than their contact distance and a skin, found anew once disks
/// may have crossed it.
///
/// A disk adds up the forces of its partners in the order of their numbers, and sums over disks are taken block by block, so that the
/// bits depend neither on the list nor on the threads.
class SoftForces {
 public:
  SoftForces(Packing const& packing, Potential potential, std::uint64_t threads);

  /// Forces at these positions and radii; `velocities` only for the sums.
  ForceSums evaluate(Packing const& packing, Columns const& velocities, Columns& forces);

  /// All pairs that overlap there, sorted.
  std::vector<Contact> contacts(Packing const& packing);

 private:
  /// Pairs that overlap, column by column.
  struct Touching {
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> second;
    std::vector<double> dx;
    std::vector<double> dy;
    std::vector<double> square;  ///< of the distance
    std::vector<double> sigma;
    std::vector<double> overlap;
    std::vector<double> force;
    std::vector<double> scale;  ///< force over distance

    void make_room_for(std::size_t entries);
  };

  void refresh(Packing const& packing);
  void build(Packing const& packing);
  [[nodiscard]] bool is_outdated(Packing const& packing) const;
  template <Potential potential, bool is_half>
  ForceSums evaluate_block(Packing const& packing, Columns const& velocities, Columns& forces, std::size_t block) const;
  /// Those of the entries of these disks that overlap; returns how many.
  std::size_t find_touching(Packing const& packing, std::size_t first, std::size_t end, Touching& touching) const;
  template <Potential potential>
  static std::size_t compute_eight_pushes(Touching& touching, std::size_t count);
  template <Potential potential>
  static void compute_pushes(Touching& touching, std::size_t count);
  template <Potential potential>
  static void push_from_walls(Packing const& packing, std::size_t first, std::size_t end, Columns& forces,
                              ForceSums& sums);
  template <Potential potential>
  ForceSums evaluate_all(Packing const& packing, Columns const& velocities, Columns& forces);
  [[nodiscard]] std::uint32_t entry_of(Packing const& packing, std::uint32_t i, std::uint32_t j) const;

  Potential potential_;
  double skin_of_smallest_ = 0.25;  ///< in smallest diameters
  double skin_ = 0.0;               ///< at the last build
  double largest_contact_ = 0.0;    ///< at the last build
  Columns built_at_;
  std::vector<double> built_radii_;
  std::vector<std::size_t> begin_;
  /// A partner in the lower bits, and above them which of its images is near: half of the pairs for one thread, both ways for more.
  std::vector<std::uint32_t> entries_;
  std::vector<Vector> shifts_;  ///< by the upper bits of an entry
  ThreadPool pool_;
  std::vector<ForceSums> block_sums_;
};

}  // namespace gridlock
