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

void carry(Archive& archive, Clock& clock) {
  archive.visit("step", clock.step);
  archive.visit("time", clock.time);
}

void carry(Archive& archive, Box& box) {
  double width = box.width();
  double height = box.height();
  bool is_periodic = box.is_periodic();
  archive.visit("width", width);
  archive.visit("height", height);
  archive.visit("is_periodic", is_periodic);
  if (archive.is_restoring()) box = Box(width, height, is_periodic ? Edge::periodic : Edge::wall);
}

void carry(Archive& archive, State& state) {
  carry_inside(archive, "box", [&] { carry(archive, state.box); });
  carry_inside(archive, "clock", [&] { carry(archive, state.clock); });
  archive.visit("seed", state.seed);
  carry_inside(archive, "disks", [&] { state.disks.carry(archive); });
}

}  // namespace gridlock
