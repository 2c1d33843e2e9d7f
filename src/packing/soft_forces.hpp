#pragma once

#include <array>
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

/// The sums of the forces on all disks.
struct ForceSums {
  double energy = 0.0;
  double contact_forces = 0.0;  ///< Σ f over contacts
  double overlaps = 0.0;        ///< Σ δ over contacts
  std::uint64_t contacts = 0;
  double largest_square = 0.0;  ///< of the net force on a disk
  double force_squares = 0.0;   ///< Σ F²
  double power = 0.0;           ///< Σ F·v
  double speed_squares = 0.0;   ///< Σ v²

  ForceSums& operator+=(ForceSums const& part);
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

/// The numbers of a disk that its force needs, side by side: where two of these have every other number subtracted and
/// the rest added, their distances along x and y and their contact distance come out.
struct alignas(32) SoftDiskRow {
  double x;
  double radius;
  double y;
  double unused = 0.0;
};

/// The forces between soft disks, by a Verlet list: pairs nearer than their contact distance and a skin, found anew
/// once disks may have crossed it.
///
/// A disk adds up the forces of its partners in the order of their numbers, and sums over disks are taken block by
/// block, so that the bits depend neither on the list nor on the threads.
class SoftForces {
 public:
  SoftForces(Packing const& packing, Potential potential, std::uint64_t threads);

  /// Forces at these positions and radii; `velocities` only for the sums.
  ForceSums evaluate(Packing const& packing, Columns const& velocities, Columns& forces);

  /// All pairs that overlap there, sorted.
  std::vector<Contact> contacts(Packing const& packing);

  /// The threads that share the work.
  ThreadPool& pool() { return pool_; }

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
  /// Copies the disks to rows_; returns how far two of them can have come nearer since the list was built.
  double update_rows(Packing const& packing);
  template <Potential potential, bool is_half>
  ForceSums evaluate_block(Packing const& packing, Columns const& velocities, Columns& forces, std::size_t first,
                           std::size_t end) const;
  /// Those of the entries from first to end that overlap; returns how many.
  std::size_t find_touching(std::size_t first, std::size_t end, Touching& touching) const;
  /// The same for as many eights as there are; returns the entry it has come to, and counts.
  std::size_t find_touching_of_eights(std::size_t first, std::size_t end, Touching& touching, std::size_t& count) const;
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
  Columns built_at_;
  std::vector<double> built_radii_;
  std::vector<std::size_t> begin_;
  /// A partner in the lower bits, and above them which of its images is near: half of the pairs for one thread, both
  /// ways for more.
  std::vector<std::uint32_t> entries_;
  std::vector<std::uint32_t> owners_;  ///< the disk in whose list an entry is
  std::vector<SoftDiskRow> rows_;
  std::array<double, 8> shifts_x_{};  ///< of images, by the middle bits of an entry
  std::array<double, 8> shifts_y_{};  ///< the same by the upper bits
  ThreadPool pool_;
};

}  // namespace gridlock
