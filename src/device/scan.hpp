#pragma once

#include <cstddef>

#include "device/backend.hpp"

namespace gridlock::device {

/// Numbers of a chunk of a sum that a thread takes.
constexpr std::size_t numbers_of_chunk = 256;

/// Replaces each number of a chunk by the sum of the numbers of the chunk up to it.
template <class Number>
struct SumInChunk {
  Number* numbers;
  Number* totals;
  std::size_t count;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t chunk) const {
    Number sum = 0;
    std::size_t const end = (chunk + 1) * numbers_of_chunk < count ? (chunk + 1) * numbers_of_chunk : count;
    for (std::size_t k = chunk * numbers_of_chunk; k < end; ++k) numbers[k] = sum += numbers[k];
    totals[chunk] = sum;
  }
};

/// Adds the sum of all chunks before.
template <class Number>
struct AddTotal {
  Number* numbers;
  Number const* totals;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t k) const {
    if (k >= numbers_of_chunk) numbers[k] += totals[k / numbers_of_chunk - 1];
  }
};

/// Replaces each number by the sum of all up to it.
template <class Number>
void sum_up(Launcher& launcher, Array<Number>& numbers, std::size_t count) {
  if (count == 0) return;
  std::size_t const chunks = (count + numbers_of_chunk - 1) / numbers_of_chunk;
  Array<Number> totals(chunks);
  launcher.for_each(chunks, SumInChunk<Number>{numbers.data(), totals.data(), count});
  if (chunks == 1) return;
  sum_up(launcher, totals, chunks);
  launcher.for_each(count, AddTotal<Number>{numbers.data(), totals.data()});
}

}  // namespace gridlock::device
