#include "gridlock/core/detail/counters_of_step.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace gridlock {

namespace {

void write_sum(MessageWriter& message, ExactSum const& sum) {
  std::vector<std::int64_t> const numbers = sum.packed();
  message.add(std::uint64_t{numbers.size()});
  message.add_all(std::span(numbers));
}

ExactSum read_sum(MessageReader& message) {
  ExactSum sum;
  sum.add_packed(message.next_values<std::int64_t>(message.next<std::uint64_t>()));
  return sum;
}

}  // namespace

void CountersOfStep::add(Counters const& of_tile) {
  pair_virial_.add(of_tile.pair_virial);
  inner_wall_impulse_.add(of_tile.inner_wall_impulse);
  for (std::size_t wall = 0; wall < wall_impulse_.size(); ++wall) wall_impulse_[wall].add(of_tile.wall_impulse[wall]);
  Counters whole_numbers = of_tile;
  whole_numbers.pair_virial = 0.0;
  whole_numbers.inner_wall_impulse = 0.0;
  whole_numbers.wall_impulse = {};
  gridlock::add(whole_numbers_, whole_numbers);
}

void CountersOfStep::add(CountersOfStep const& others) {
  gridlock::add(whole_numbers_, others.whole_numbers_);
  pair_virial_.add(others.pair_virial_);
  inner_wall_impulse_.add(others.inner_wall_impulse_);
  for (std::size_t wall = 0; wall < wall_impulse_.size(); ++wall) wall_impulse_[wall].add(others.wall_impulse_[wall]);
}

void CountersOfStep::add_to(Counters& counters) const {
  Counters rounded = whole_numbers_;
  rounded.pair_virial = pair_virial_.value();
  rounded.inner_wall_impulse = inner_wall_impulse_.value();
  for (std::size_t wall = 0; wall < wall_impulse_.size(); ++wall) {
    rounded.wall_impulse[wall] = wall_impulse_[wall].value();
  }
  gridlock::add(counters, rounded);
}

void CountersOfStep::write(MessageWriter& message) const {
  message.add(whole_numbers_);
  write_sum(message, pair_virial_);
  write_sum(message, inner_wall_impulse_);
  for (ExactSum const& sum : wall_impulse_) write_sum(message, sum);
}

CountersOfStep CountersOfStep::read(MessageReader& message) {
  CountersOfStep counters;
  counters.whole_numbers_ = message.next<Counters>();
  counters.pair_virial_ = read_sum(message);
  counters.inner_wall_impulse_ = read_sum(message);
  for (ExactSum& sum : counters.wall_impulse_) sum = read_sum(message);
  return counters;
}

}  // namespace gridlock
