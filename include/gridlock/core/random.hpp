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

/// The purpose of a random number. Numbers of different purposes are independent; never renumber, old runs depend on
/// it.
enum class Purpose : std::uint64_t {
  start_position = 1,
  start_velocity = 2,
  species = 3,
  paper_study = 4,
  model_start = 5,   ///< where and what the agents of a model are at first
  model_step = 6,    ///< events of a whole model in one step
  swap_trial = 7,    ///< trial moves of swap Monte Carlo
  model_turn = 256,  ///< and after it, see purpose_of_turn()
};

/// The purposes of a model's own random numbers in a turn, 0, 1, 2 …
constexpr Purpose purpose_of_turn(std::uint64_t number) {
  return static_cast<Purpose>(static_cast<std::uint64_t>(Purpose::model_turn) + number);
}

/// The random numbers of one agent, at one step, for one purpose.
///
/// A pure function of (seed, step, id, purpose) and of how many were drawn before: never of thread, process or visiting
/// order. Philox-4x64-10, period 2⁶⁴ blocks per stream (Salmon et al. 2011, doi:10.1145/2063384.2063405).
/// Uniform and normal numbers come out of exactly rounded operations alone, so every compiler gives the same bits.
/// Cost: about 12 ns for every four numbers, which are drawn at once.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t step, Id id, Purpose purpose)
      : seed_(seed), stream_{step, id, static_cast<std::uint64_t>(purpose)} {}

  /// 64 random bits.
  std::uint64_t bits() {
    if (used_ == numbers_.size()) draw_block();
    return numbers_[used_++];
  }
  /// Uniform in [0, 1), a multiple of 2⁻⁵³.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  /// Uniform whole number in [0, bound); bound > 0.
  std::uint64_t below(std::uint64_t bound);
  /// Normal with mean 0 and variance 1, by the ratio of uniforms (Kinderman & Monahan 1977, doi:10.1145/355744.355750).
  double normal();
  /// Exponential with mean 1, by comparing uniform numbers alone (von Neumann 1951, Monte Carlo method, NBS Applied
  /// Mathematics Series 12, 36), so that no logarithm is needed. Cost: about 4.3 numbers.
  double exponential();
  /// Uniform in the disk of radius 1 around the origin, by rejection from the square.
  Vector in_unit_disk();

 private:
  /// The next four numbers. They are drawn in the library, and handed out where they are used.
  void draw_block();

  std::uint64_t seed_;
  std::array<std::uint64_t, 3> stream_;
  std::uint64_t block_ = 0;
  std::array<std::uint64_t, 4> numbers_;  ///< read after draw_block() only
  unsigned used_ = 4;
};

}  // namespace gridlock
