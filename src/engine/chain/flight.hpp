#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "gridlock/core/box.hpp"

namespace gridlock::chain {

/// Number of a disk in the memory of a grid; 0, 1, … is the order of the Ids before find() translates it.
using Number = std::uint32_t;
inline constexpr Number nobody = std::numeric_limits<Number>::max();

/// The direction of a chain: along +x, along +y, or along the velocity of each disk.
enum class Way { right, up, by_velocity };

/// The longest flight that is looked at at once, in largest contact distances. Where a disk flies farther, it stops and
/// goes on, so that the rounding of its place depends on no cells.
inline constexpr double longest_flight = 0.75;
/// The shortest side of a box in largest contact distances: no image of a disk that can be met is then mistaken.
inline constexpr double min_side = 4.0;

/// A disk that is about to move.
struct Flight {
  Number disk;
  Number previous;  ///< the disk that has just met it, which it leaves and cannot meet again on a straight way
  Vector place;
  Vector velocity;      ///< of length 1 in straight chains
  double square = 1.0;  ///< of the velocity
};

/// The first disk that a flight meets. A path is a time times `square`, in a straight chain a length.
struct Contact {
  double path;  ///< at first the longest one
  Number partner = nobody;
  Vector separation = {};  ///< from the disk at the start of its flight to its partner
};

/// Whether a place is below another, or beside it to the left: an order for disks that are met at the same time.
inline bool is_below(Vector place, Vector other) {
  return place.y < other.y || (place.y == other.y && place.x < other.x);
}

/// Lets a disk at `separation` that is met at the distance √`squared_contact` replace `first` if it is met earlier, or
/// at the same time below it. So the first contact is a function of places and velocities alone, whatever the order
/// and choice of candidates. Returns whether it does.
template <Way way>
inline bool meet(Flight const& flight, Vector separation, double squared_contact, Number other, Contact& first) {
  double ahead = separation.x;
  double aside = separation.y;
  double radicand = squared_contact;
  if constexpr (way == Way::up) std::swap(ahead, aside);
  if constexpr (way == Way::by_velocity) {
    ahead = separation.x * flight.velocity.x + separation.y * flight.velocity.y;
    aside = separation.x * flight.velocity.y - separation.y * flight.velocity.x;
    radicand = squared_contact * flight.square;
  }
  radicand -= aside * aside;
  if (!(ahead > 0.0 && radicand > 0.0)) return false;
  double const path = std::max(ahead - std::sqrt(radicand), 0.0);
  if (path > first.path) return false;
  if (path == first.path && first.partner != nobody && !is_below(separation, first.separation)) return false;
  if (other == flight.disk || other == flight.previous) return false;
  first.path = path;
  first.partner = other;
  first.separation = separation;
  return true;
}

/// Sums over the chains of a step.
struct ChainSums {
  std::uint64_t contacts = 0;
  std::uint64_t flights = 0;
  /// Σ over contacts of the distance of the two centres along the chain; for chains by velocity of (r_j − r_i)·v_i.
  double virial = 0.0;
};

/// Ends a run whose chain never ends: it goes around and around in a row of disks that touch, and nothing moves.
/// Errors: RunFailure.
[[noreturn]] void fail_without_end(std::uint64_t contacts);

/// Carries out one chain of a length, or a duration, with `most` contacts at most. `ChainDisks` have the disks by
/// number, move them and find contacts: CellsOfAnySize, NarrowCells. Inlined, so that it is compiled for the
/// instructions of its caller.
template <Way way, class ChainDisks>
[[gnu::always_inline]] inline void carry_out(ChainDisks& disks, Number in_order, double rest, std::uint64_t most,
                                             ChainSums& sums) {
  Number const first = disks.find(in_order);
  double const longest = disks.longest_flight();
  std::uint64_t const last_contact = sums.contacts + most;
  Flight flight{.disk = first, .previous = nobody, .place = disks.place(first), .velocity = {}};
  if constexpr (way == Way::by_velocity) flight.velocity = disks.velocity(first);
  for (;;) {
    double time = std::min(rest, longest);
    if constexpr (way == Way::by_velocity) {
      flight.square = squared_length(flight.velocity);
      time = std::min(rest, longest / std::sqrt(flight.square));
    }
    Contact contact{.path = time * flight.square};
    disks.template find_contact<way>(flight, contact);
    ++sums.flights;
    bool const hits = contact.partner != nobody;
    if (hits) time = contact.path / flight.square;
    rest -= time;
    Vector step{way == Way::right ? time : 0.0, way == Way::up ? time : 0.0};
    if constexpr (way == Way::by_velocity) step = time * flight.velocity;
    flight.place = disks.move(flight.disk, flight.place + step);
    if (!hits) {
      if (rest > 0.0) continue;
      break;
    }
    if (++sums.contacts > last_contact) [[unlikely]]
      fail_without_end(most);
    Vector const separation = contact.separation - step;
    if constexpr (way == Way::by_velocity) {
      Vector const other = disks.velocity(contact.partner);
      double const towards = dot(flight.velocity, separation);
      Vector const exchange = ((towards - dot(other, separation)) / squared_length(separation)) * separation;
      sums.virial += towards;
      disks.set_velocity(flight.disk, flight.velocity - exchange);
      flight.velocity = other + exchange;
    } else {
      sums.virial += way == Way::right ? separation.x : separation.y;
    }
    flight.previous = flight.disk;
    flight.disk = contact.partner;
    flight.place = disks.place(flight.disk);
  }
  if constexpr (way == Way::by_velocity) disks.set_velocity(flight.disk, flight.velocity);
  disks.end_chain();
}

}  // namespace gridlock::chain
