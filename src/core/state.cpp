#include "gridlock/core/state.hpp"

#include <xxhash.h>

namespace gridlock {

std::uint64_t hash_words(std::span<std::uint64_t const> words) { return XXH3_64bits(words.data(), words.size_bytes()); }

std::uint64_t hash(State const& state) { return hash(state.box, state.clock, state.seed, state.disks); }

void serialize(Archive& archive, Clock& clock) {
  archive.visit("step", clock.step);
  archive.visit("time", clock.time);
}

void serialize(Archive& archive, Box& box) {
  double width = box.width();
  double height = box.height();
  bool is_periodic = box.is_periodic();
  archive.visit("width", width);
  archive.visit("height", height);
  archive.visit("is_periodic", is_periodic);
  if (archive.is_restoring()) box = Box(width, height, is_periodic ? Edge::periodic : Edge::wall);
}

void serialize(Archive& archive, State& state) {
  serialize_inside(archive, "box", [&] { serialize(archive, state.box); });
  serialize_inside(archive, "clock", [&] { serialize(archive, state.clock); });
  archive.visit("seed", state.seed);
  serialize_inside(archive, "disks", [&] { state.disks.serialize(archive); });
}

}  // namespace gridlock
