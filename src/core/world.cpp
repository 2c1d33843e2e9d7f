#include "gridlock/core/world.hpp"

#include <xxhash.h>

namespace gridlock {

std::uint64_t hash_words(std::span<std::uint64_t const> words) { return XXH3_64bits(words.data(), words.size_bytes()); }

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

}  // namespace gridlock
