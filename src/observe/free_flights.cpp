#include "observe/free_flights.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "gridlock/core/error.hpp"
#include "observe/motion.hpp"

namespace gridlock {

namespace {

constexpr unsigned bits_within_bin = 52 - 3;

}  // namespace

void FreeFlights::begin(Snapshot const& start) {
  if (count_of_moving(start) < start.count()) {
    throw Error({.what = "observe.free_flights needs disks that all move",
                 .hint = "let no species be fixed: hits of fixed disks are not among the collisions of two disks",
                 .key = "observe.free_flights"});
  }
  reset({{"mean_free_path", "length", "Mean path of a disk between two pair collisions."}});
  last_.assign(start.count(), no_value);
  paths_ = 0.0;
  flights_ = 0;
  times_ = lengths_ = {};
}

void FreeFlights::Histogram::add(double value) {
  std::uint64_t const bin = std::bit_cast<std::uint64_t>(std::abs(value)) >> bits_within_bin;
  if (counts.empty()) first = bin;
  if (bin < first) counts.insert(counts.begin(), first - bin, 0);
  first = std::min(first, bin);
  if (bin - first >= counts.size()) counts.resize(bin - first + 1, 0);
  ++counts[bin - first];
}

double FreeFlights::Histogram::lower_edge(std::size_t bin) const {
  return std::bit_cast<double>((first + bin) << bits_within_bin);
}

void FreeFlights::collided(PairCollision const& collision) {
  end_flight(collision.i, collision.time, collision.velocity_i);
  end_flight(collision.j, collision.time, collision.velocity_j);
}

void FreeFlights::end_flight(std::size_t disk, double time, Vector velocity) {
  double const duration = time - std::exchange(last_[disk], time);
  if (std::isnan(duration)) return;
  double const path = duration * std::sqrt(squared_length(velocity));
  ++flights_;
  paths_ += path;
  times_.add(duration);
  lengths_.add(path);
}

void FreeFlights::sample(Snapshot const& /*now*/, std::span<double> row, bool counts_for_average) {
  auto const flights = static_cast<double>(std::exchange(flights_, 0));
  double const paths = std::exchange(paths_, 0.0);
  row[0] = flights > 0.0 ? paths / flights : no_value;
  if (!counts_for_average) {
    times_ = lengths_ = {};
  } else if (flights > 0.0) {
    average(0, row[0], flights);
  }
}

Distribution FreeFlights::distribution_of(Histogram const& histogram, std::string const& quantity,
                                          std::string const& unit) {
  std::uint64_t const flights = std::accumulate(histogram.counts.begin(), histogram.counts.end(), std::uint64_t{0});
  std::vector<std::vector<double>> values(4);
  for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    double const lower = histogram.lower_edge(bin);
    double const upper = histogram.lower_edge(bin + 1);
    auto const count = static_cast<double>(histogram.counts[bin]);
    double const all = static_cast<double>(flights) * (upper - lower);
    values[0].push_back(0.5 * (lower + upper));
    values[1].push_back(count / all);
    values[2].push_back(count > 0.0 ? std::sqrt(count) / all : no_value);
    values[3].push_back(count);
  }
  return {
      .name = quantity + "_distribution",
      .columns = {{quantity, unit, "Middle of the bin."},
                  {"density", "1 / " + unit, "Share of the flights in the bin over its width."},
                  {"error", "1 / " + unit, "One standard error of the density of independent flights."},
                  {.name = "flights", .unit = "", .documentation = "Number of flights in the bin.", .is_count = true}},
      .columns_of_values = std::move(values)};
}

std::vector<Distribution> FreeFlights::distributions() const {
  if (times_.counts.empty()) return {};
  return {distribution_of(times_, "free_time", "time"), distribution_of(lengths_, "free_path", "length")};
}

void FreeFlights::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  std::size_t const disks = last_.size();
  archive.visit("last", last_);
  archive.require(last_.size() == disks, "the flights are those of other disks");
  archive.visit("paths", paths_);
  archive.visit("flights", flights_);
  archive.visit("first_time", times_.first);
  archive.visit("times", times_.counts);
  archive.visit("first_length", lengths_.first);
  archive.visit("lengths", lengths_.counts);
}

}  // namespace gridlock
