// The random numbers of a model in Python.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "gridlock/core/random.hpp"
#include "model_world.hpp"

namespace gridlock::python {

RandomStream ModelWorld::stream_of(std::uint64_t row, std::uint64_t purpose) const {
  // At the start the step is 0, so the purpose takes its position in the random stream.
  if (phase_ == Phase::start) return {world_.seed, purpose, row, Purpose::model_start};
  return {world_.seed, world_.clock.step, world_.agents.ids()[row], purpose_of_turn(purpose)};
}

template <class RowAt>
nb::object ModelWorld::draw(std::size_t rows, RowAt row_at, std::size_t each, std::uint64_t purpose,
                            bool is_normal) const {
  UninitializedArray<double> numbers(rows * each);
  double* next = numbers.data();
  for (std::size_t k = 0; k < rows; ++k) {
    RandomStream stream = stream_of(row_at(k), purpose);
    for (std::size_t n = 0; n < each; ++n) *next++ = is_normal ? stream.normal() : stream.uniform();
  }
  return nb::cast(owned_array(std::move(numbers), {rows, each}));
}

nb::object ModelWorld::numbers(RowNumbers const& rows, std::size_t each, std::uint64_t purpose, bool is_normal) const {
  require_open();
  for (std::size_t k = 0; k < rows.shape(0); ++k) require_rows({rows(k), rows(k) + 1});
  return draw(
      rows.shape(0), [&](std::size_t k) { return rows(k); }, each, purpose, is_normal);
}

nb::object ModelWorld::numbers_from(RowsFromTo rows, std::size_t each, std::uint64_t purpose, bool is_normal) const {
  require_rows(phase_ == Phase::start ? RowsFromTo() : rows);
  return draw(
      rows.second - rows.first, [&](std::size_t k) { return rows.first + k; }, each, purpose, is_normal);
}

nb::object ModelWorld::random_order(RowsFromTo rows, std::uint64_t purpose) const {
  require_rows(rows);
  std::size_t const count = rows.second - rows.first;
  // Uniform numbers spread evenly over as many buckets as there are rows: each has few to be sorted.
  std::vector<std::uint64_t> numbers(count);
  std::vector<std::size_t> ends(count + 1);
  auto const bucket_of = [&](std::uint64_t number) { return ((number >> 32U) * count) >> 21U; };
  for (std::size_t k = 0; k < count; ++k) {
    numbers[k] = stream_of(rows.first + k, purpose).bits() >> 11U;
    ++ends[bucket_of(numbers[k]) + 1];
  }
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  UninitializedArray<std::int64_t> order(count);
  // From the last row on, each bucket is filled from its end: rows with equal numbers keep their order.
  std::vector<std::size_t> next(ends.begin() + 1, ends.end());
  for (std::size_t k = count; k-- > 0;) order[--next[bucket_of(numbers[k])]] = static_cast<std::int64_t>(k);
  for (std::size_t bucket = 0; bucket < count; ++bucket) {
    if (ends[bucket + 1] - ends[bucket] < 2) continue;
    auto const at = [&](std::size_t place) { return order.begin() + static_cast<std::ptrdiff_t>(place); };
    std::sort(at(ends[bucket]), at(ends[bucket + 1]), [&](std::int64_t a, std::int64_t b) {
      return std::pair(numbers[static_cast<std::size_t>(a)], a) < std::pair(numbers[static_cast<std::size_t>(b)], b);
    });
  }
  return nb::cast(owned_array(std::move(order)));
}

nb::object ModelWorld::numbers_of_step(std::size_t count) const {
  require_open();
  RandomStream stream(world_.seed, world_.clock.step, 0, Purpose::model_step);
  std::vector<double> numbers(count);
  std::ranges::generate(numbers, [&] { return stream.uniform(); });
  return nb::cast(owned_array(std::move(numbers)));
}

}  // namespace gridlock::python
