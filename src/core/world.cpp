#include "gridlock/core/world.hpp"

#include <xxhash.h>

namespace gridlock {

std::uint64_t hash_words(std::span<std::uint64_t const> words) { return XXH3_64bits(words.data(), words.size_bytes()); }

std::uint64_t hash_of_world(Box const& box, Clock const& clock, std::uint64_t seed, std::size_t agents,
                            std::uint64_t sum_of_agents) {
  std::uint64_t const record[] = {word_of(box.width()),
                                  word_of(box.height()),
                                  number_of_edges(box),
                                  word_of(clock.step),
                                  word_of(clock.time),
                                  seed,
                                  agents,
                                  sum_of_agents};
  if (!box.is_oblique()) return hash_words(record);
  std::uint64_t const of_oblique[] = {hash_words(record), word_of(box.shift())};
  return hash_words(of_oblique);
}

void serialize(Archive& archive, Clock& clock) {
  archive.visit("step", clock.step);
  archive.visit("time", clock.time);
}

void serialize(Archive& archive, Box& box) {
  double width = box.width();
  double height = box.height();
  bool is_periodic_x = box.is_periodic_x();
  bool is_periodic_y = box.is_periodic_y();
  archive.visit("width", width);
  archive.visit("height", height);
  bool const has_equal_edges = archive.is_restoring() ? archive.has("is_periodic") : is_periodic_x == is_periodic_y;
  if (has_equal_edges) {
    archive.visit("is_periodic", is_periodic_x);
    is_periodic_y = is_periodic_x;
  } else {
    archive.visit("is_periodic_x", is_periodic_x);
    archive.visit("is_periodic_y", is_periodic_y);
  }
  // A saved rectangle has no shift, whatever the box was that it replaces.
  double shift = archive.is_restoring() ? 0.0 : box.shift();
  if (archive.is_restoring() ? archive.has("shift") : box.is_oblique()) archive.visit("shift", shift);
  if (!archive.is_restoring()) return;
  auto const edge = [](bool is_periodic) { return is_periodic ? Edge::periodic : Edge::wall; };
  box = Box(width, height, edge(is_periodic_x), edge(is_periodic_y)).shifted(shift);
}

}  // namespace gridlock
