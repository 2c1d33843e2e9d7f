#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// Where a run stands: whole steps taken and physical time passed.
struct Clock {
  std::uint64_t step = 0;
  double time = 0.0;

  friend bool operator==(Clock const&, Clock const&) = default;
};

/// All of the physics and nothing else: two equal states have equal futures under the same engine settings.
struct State {
  Box box;
  Disks disks;
  Clock clock;
  std::uint64_t seed = 0;
};

/// XXH3 of words of 64 bits.
std::uint64_t hash_words(std::span<std::uint64_t const> words);

/// The bits of a number, its sign extended.
template <class Value>
constexpr std::uint64_t word_of(Value value) {
  if constexpr (std::is_same_v<Value, double>) {
    return std::bit_cast<std::uint64_t>(value);
  } else {
    return static_cast<std::uint64_t>(value);
  }
}

/// The bitwise identity of a population of any kind at one moment: equal for equal bits of box, clock, seed and every column of every agent.
///
/// XXH3 of each agent's row under its Id, summed modulo 2⁶⁴, so that the order of the rows does not matter.
/// Cost: one pass over the agents.
template <class... Columns>
std::uint64_t hash(Box const& box, Clock const& clock, std::uint64_t seed, Population<Columns...> const& population) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < population.size(); ++i) {
    // Words of 64 bits, so that a record has no padding and the same bytes under every compiler.
    std::uint64_t const record[] = {population.ids()[i], word_of(population.template column<Columns>()[i])...};
    sum += hash_words(record);
  }
  std::uint64_t const record[] = {word_of(box.width()), word_of(box.height()),
                                  word_of(box.edge()),  word_of(clock.step),
                                  word_of(clock.time),  seed,
                                  population.size(),    sum};
  return hash_words(record);
}
std::uint64_t hash(State const& state);

/// Serializes every bit of a state. Errors: Error where what is restored is none.
void serialize(Archive& archive, Clock& clock);
void serialize(Archive& archive, Box& box);
void serialize(Archive& archive, State& state);

}  // namespace gridlock
