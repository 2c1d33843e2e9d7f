#pragma once

/// \file
/// Random numbers that are a function of seed, step, agent and purpose.
///
/// ```cpp
/// RandomStream random(7, 100, 3, purpose_of_turn(0));  // seed, step, Id, purpose
/// double const angle = 6.283 * random.uniform();
/// std::uint64_t const die = 1 + random.below(6);
/// ```

#include <array>
#include <cstdint>

#include "gridlock/core/population.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// The purpose of a random number. Numbers of different purposes are independent. Never change a number here: it would
/// change the results of earlier runs.
enum class Purpose : std::uint64_t {
  start_position = 1,
  start_velocity = 2,
  species = 3,
  paper_study = 4,
  model_start = 5,     ///< positions and other values of the agents of a model at the start
  model_step = 6,      ///< events in a step that belong to no single agent
  swap_trial = 7,      ///< trial moves of swap Monte Carlo
  thermostat = 8,      ///< waiting times and velocities of kicks
  heading = 9,         ///< headings of self-propelled disks
  event_chain = 10,    ///< first disks of event chains
  model_take = 11,     ///< the order in which agents of a model take from a cell of a field
  model_network = 12,  ///< edges of a network
  model_turn = 256,    ///< this number and those above it: see purpose_of_turn()
};

/// Returns the purpose of random numbers that a model draws in a turn; `number` = 0, 1, 2 … tells its purposes apart.
constexpr Purpose purpose_of_turn(std::uint64_t number) {
  return static_cast<Purpose>(static_cast<std::uint64_t>(Purpose::model_turn) + number);
}

/// The random numbers of one agent, at one step, for one purpose.
///
/// Each number depends only on (seed, step, id, purpose) and on how many numbers were drawn before, not on thread,
/// process or the order of agents. Philox-4x64-10, period 2⁶⁴ blocks per stream (Salmon et al. 2011,
/// doi:10.1145/2063384.2063405).
/// All operations are exactly rounded, so every compiler gives the same bits. Cost: about 12 ns for four numbers, which
/// are drawn together.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t step, Id id, Purpose purpose)
      : seed_(seed), stream_{step, id, static_cast<std::uint64_t>(purpose)} {}

  /// Draws 64 random bits.
  std::uint64_t bits() {
    if (used_ == numbers_.size()) draw_block();
    return numbers_[used_++];
  }
  /// Draws a uniform number in [0, 1), a multiple of 2⁻⁵³.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  /// Draws a uniform whole number in [0, bound); bound > 0.
  std::uint64_t below(std::uint64_t bound);
  /// Draws a normal number with mean 0 and variance 1, by the ratio of uniforms (Kinderman & Monahan 1977,
  /// doi:10.1145/355744.355750).
  double normal();
  /// Draws an exponential number with mean 1, without a logarithm: it only compares uniform numbers (von Neumann 1951,
  /// Monte Carlo method, NBS Applied Mathematics Series 12, 36). Cost: about 4.3 uniform numbers.
  double exponential();
  /// Draws a uniform point in the disk of radius 1 around the origin, by rejection from the square.
  Vector in_unit_disk();

 private:
  /// Draws the next four numbers into numbers_.
  void draw_block();

  std::uint64_t seed_;
  std::array<std::uint64_t, 3> stream_;
  std::uint64_t block_ = 0;
  std::array<std::uint64_t, 4> numbers_;  ///< not initialized before draw_block()
  unsigned used_ = 4;
};

}  // namespace gridlock
