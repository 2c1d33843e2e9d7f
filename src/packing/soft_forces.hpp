#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// A vector for each disk, in two arrays.
struct Columns {
  std::vector<double> x;
  std::vector<double> y;

  Columns() = default;
  explicit Columns(std::size_t size) : x(size), y(size) {}
};

/// Sums over all disks and contacts.
struct ForceSums {
  double energy = 0.0;
  double contact_forces = 0.0;  ///< Σ f over contacts
  double overlaps = 0.0;        ///< Σ δ over contacts
  std::uint64_t contacts = 0;
  double largest_square = 0.0;  ///< square of the largest net force on a disk
  double box_square = 0.0;      ///< square of the force on a box whose shape is free, see SiteForces
  double force_squares = 0.0;   ///< Σ F²
  double power = 0.0;           ///< Σ F·v
  double speed_squares = 0.0;   ///< Σ v²
  double pure_shear = 0.0;      ///< Σ ½ f r (n_x² − n_y²) over contacts; 0 where it is not asked for, as the next
  double simple_shear = 0.0;    ///< Σ f r n_x n_y over contacts

  ForceSums& operator+=(ForceSums const& part);
  /// Adds a contact.
  void count(double energy_of_contact, double force, double overlap) {
    energy += energy_of_contact;
    contact_forces += force;
    overlaps += overlap;
    ++contacts;
  }
  /// Returns the largest net force on a disk over the mean contact force; 0 without contacts.
  [[nodiscard]] double residual_of_disks() const { return over_mean_force(largest_square); }
  /// Returns the same with the force on the box.
  [[nodiscard]] double residual() const { return over_mean_force(std::max(largest_square, box_square)); }

 private:
  [[nodiscard]] double over_mean_force(double square) const;
};

/// The numbers of a disk that its force needs. Of two rows the numbers are subtracted or added in turn, which gives the
/// distance along x, the contact distance and the distance along y.
struct alignas(32) SoftDiskRow {
  double x;
  double radius;
  double y;
  double unused = 0.0;
};

/// The forces between soft disks, by a Verlet list: pairs nearer than their contact distance plus a skin, searched
/// again once disks may have crossed the skin.
///
/// A disk adds up the forces of its partners in the order of their numbers, and sums over disks are taken block by
/// block, so that the bits depend on neither the list nor the threads.
class SoftForces {
 public:
  SoftForces(Packing const& packing, Potential potential, std::uint64_t threads);

  /// Lets evaluate() add up pure_shear and simple_shear too.
  void add_up_shear() { adds_up_shear_ = true; }

  /// Computes forces at these positions and radii; `velocities` are used for the sums only.
  ForceSums evaluate(Packing const& packing, Columns const& velocities, Columns& forces);

  /// Returns all pairs that overlap, sorted.
  std::vector<Contact> contacts(Packing const& packing);

  /// The threads that compute forces.
  ThreadPool& pool() { return pool_; }

 private:
  /// Pairs that overlap, one array for each quantity.
  struct Touching {
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> second;
    std::vector<double> dx;
    std::vector<double> dy;
    std::vector<double> square;  ///< square of the distance
    std::vector<double> sigma;
    std::vector<double> overlap;
    std::vector<double> force;
    std::vector<double> scale;  ///< force over distance

    void make_room_for(std::size_t entries);
  };

  void refresh(Packing const& packing);
  void build(Packing const& packing);
  /// Copies the disks to rows_. Returns the largest distance by which two that are not listed can have approached since
  /// the last search, also by a deformation of the box.
  double update_rows(Packing const& packing);
  template <Potential potential, bool is_half>
  ForceSums evaluate_block(Packing const& packing, Columns const& velocities, Columns& forces, std::size_t first,
                           std::size_t end) const;
  /// Finds the entries from `first` to `end` that overlap; returns their number.
  std::size_t find_touching(std::size_t first, std::size_t end, Touching& touching) const;
  /// Finds entries as find_touching(), eight at a time. Returns the first entry not searched, and adds to `count`.
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
  /// Computes the shifts of images for a box.
  void take_box(Box const& box);
  /// Adds the shear of contacts that have been computed.
  template <bool is_half>
  static void add_shear(Touching const& touching, std::size_t count, ForceSums& sums);
  /// Returns the shift of the image of an entry.
  [[nodiscard]] Vector shift_of(std::uint32_t entry) const;
  [[nodiscard]] std::uint32_t entry_of(Packing const& packing, std::uint32_t i, std::uint32_t j) const;

  Potential potential_;
  double skin_of_smallest_ = 0.25;  ///< skin in smallest diameters
  double skin_ = 0.0;               ///< skin at the last search
  double longest_ = 0.0;            ///< largest contact distance plus skin, at the last search
  bool adds_up_shear_ = false;
  Columns built_at_;
  std::vector<double> built_radii_;
  std::vector<std::size_t> begin_;
  /// Partner and image for each entry. Each pair is listed once for one thread, twice for more threads.
  std::vector<std::uint32_t> entries_;
  std::vector<std::uint32_t> owners_;  ///< disk whose list has the entry
  std::vector<SoftDiskRow> rows_;
  Box built_box_;                     ///< box at the last search
  Box box_;                           ///< box of the shifts
  std::array<double, 8> shifts_x_{};  ///< shift in x of an image, by the middle bits of an entry
  std::array<double, 8> shifts_y_{};  ///< shift in y of an image, by the upper bits of an entry
  std::array<double, 8> slants_{};    ///< further shift in x of an image in an oblique box, by the upper bits
  ThreadPool pool_;
};

}  // namespace gridlock
