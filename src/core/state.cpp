#include "gridlock/core/state.hpp"

#include <xxhash.h>

#include <bit>
#include <type_traits>

namespace gridlock {

namespace {

/// Words of 64 bits, so that a record has no padding and the same bytes under every compiler.
template <class Value>
std::uint64_t word(Value value) {
  if constexpr (std::is_same_v<Value, double>) {
    return std::bit_cast<std::uint64_t>(value);
  } else {
    return static_cast<std::uint64_t>(value);
  }
}

template <class... Columns>
std::uint64_t hash_rows(Population<Columns...> const& population) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < population.size(); ++i) {
    std::uint64_t const record[] = {population.ids()[i], word(population.template column<Columns>()[i])...};
    sum += XXH3_64bits(record, sizeof record);
  }
  return sum;
}

}  // namespace

std::uint64_t hash(State const& state) {
  std::uint64_t const record[] = {word(state.box.width()),  word(state.box.height()), word(state.box.edge()),
                                  word(state.clock.step),   word(state.clock.time),   state.seed,
                                  word(state.disks.size()), hash_rows(state.disks)};
  return XXH3_64bits(record, sizeof record);
}

}  // namespace gridlock
