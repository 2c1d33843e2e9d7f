#include "lattice/kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "lattice/sizes.hpp"

namespace gridlock {

namespace {

/// Returns the number of disks of each kind: fraction · count, rounded to the right sum, largest remainders first.
std::vector<std::uint64_t> numbers_of_kinds(std::vector<SpeciesSettings> const& species, std::uint64_t count) {
  std::vector<std::uint64_t> numbers;
  std::vector<double> remainders;
  std::uint64_t dealt = 0;
  for (SpeciesSettings const& kind : species) {
    double const share = kind.fraction * static_cast<double>(count);
    numbers.push_back(static_cast<std::uint64_t>(share));
    remainders.push_back(share - std::floor(share));
    dealt += numbers.back();
  }
  while (dealt < count) {
    auto const largest = std::ranges::max_element(remainders);
    ++numbers[static_cast<std::size_t>(largest - remainders.begin())];
    *largest = -1.0;
    ++dealt;
  }
  return numbers;
}

void require_whole(std::vector<SpeciesSettings> const& species) {
  double sum = 0.0;
  for (SpeciesSettings const& kind : species) sum += kind.fraction;
  if (std::abs(sum - 1.0) <= 1e-9) return;
  throw Error({.what = fmt::format("the fractions of the {} species add up to {}, not 1", species.size(), sum),
               .hint = "give every [[disks.species]] its share of the disks",
               .key = "disks.species"});
}

void require_one_description_of_sizes(DisksSettings const& settings) {
  if (settings.sizes == SizeDistribution::equal) {
    if (!settings.size_spread) return;
    throw Error({.what = fmt::format("disks.size_spread = {} is given for equal disks", *settings.size_spread),
                 .hint = "give disks.sizes as well: \"inverse_cube\", \"uniform\" or \"normal\"",
                 .key = "disks.size_spread"});
  }
  if (settings.species.empty()) return;
  throw Error({.what = "disks.sizes and disks.species are both given",
               .hint = "species are a few kinds, sizes a continuous distribution: leave one of them out",
               .key = "disks.sizes"});
}

}  // namespace

bool are_equal(DisksSettings const& settings) {
  return settings.species.empty() && settings.sizes == SizeDistribution::equal;
}

Kinds::Kinds(DisksSettings const& settings, std::uint64_t count, std::uint64_t seed) : count_(count) {
  require_one_description_of_sizes(settings);
  if (are_equal(settings)) {
    sum_of_squared_ratios_ = static_cast<double>(count_);
    return;
  }
  put_in_order(settings);
  if (count_ > 0) largest_ratio_ = *std::ranges::max_element(size_ratios_);
  deal(seed);
  sum_of_squared_ratios_ = std::inner_product(size_ratios_.begin(), size_ratios_.end(), size_ratios_.begin(), 0.0);
}

/// Puts the sizes in order: species after species, or the sizes of a distribution from the smallest to the largest.
void Kinds::put_in_order(DisksSettings const& settings) {
  if (settings.species.empty()) {
    size_ratios_ = sizes_in_order(settings, count_);
    masses_.assign(count_, 1.0);
    return;
  }
  require_whole(settings.species);
  size_ratios_.reserve(count_);
  masses_.reserve(count_);
  std::vector<std::uint64_t> const numbers = numbers_of_kinds(settings.species, count_);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    size_ratios_.insert(size_ratios_.end(), numbers[k], settings.species[k].size_ratio);
    SpeciesSettings const& kind = settings.species[k];
    double const mass = kind.fixed ? std::numeric_limits<double>::infinity() : kind.mass;
    masses_.insert(masses_.end(), numbers[k], mass);
  }
}

/// Shuffles the kinds by the method of Fisher and Yates: all assignments to sites are equally likely.
void Kinds::deal(std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::species);
  for (std::uint64_t left = count_; left > 1; --left) {
    std::uint64_t const last = left - 1;
    std::uint64_t const other = random.below(left);
    std::swap(size_ratios_[last], size_ratios_[other]);
    std::swap(masses_[last], masses_[other]);
  }
}

}  // namespace gridlock
