#include "lattice/kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "lattice/sizes.hpp"

namespace gridlock {

namespace {

/// How many disks of each kind: fraction · count rounded so that the numbers add up, largest remainders first.
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

/// The kinds before they are dealt out: one species after the other, or the sizes of a distribution from the smallest
/// to the largest.
class KindsInOrder {
 public:
  /// All processes call it.
  KindsInOrder(DisksSettings const& settings, ShareOfRows const& share)
      : species_(settings.species), count_(share.all()) {
    if (species_.empty()) {
      sizes_.emplace(settings, share);
      return;
    }
    require_whole(species_);
    for (std::uint64_t const number : numbers_of_kinds(species_, count_)) {
      ends_.push_back(number + (ends_.empty() ? 0 : ends_.back()));
    }
  }

  [[nodiscard]] double size_ratio(std::uint64_t row) const {
    return sizes_ ? sizes_->at(row) : kind_of(row).size_ratio;
  }
  [[nodiscard]] double mass(std::uint64_t row) const { return sizes_ ? 1.0 : kind_of(row).mass; }
  [[nodiscard]] double largest_ratio() const {
    if (sizes_) return sizes_->largest();
    double largest = 0.0;
    std::uint64_t first = 0;
    for (std::size_t k = 0; k < species_.size(); ++k) {
      if (ends_[k] > first && first < count_) largest = std::max(largest, species_[k].size_ratio);
      first = ends_[k];
    }
    return largest;
  }

 private:
  [[nodiscard]] SpeciesSettings const& kind_of(std::uint64_t row) const {
    return species_[static_cast<std::size_t>(std::ranges::upper_bound(ends_, row) - ends_.begin())];
  }

  std::vector<SpeciesSettings> species_;
  std::uint64_t count_;
  std::vector<std::uint64_t> ends_;  ///< behind the last row of each
  std::optional<Sizes> sizes_;
};

/// The random numbers of a deal in reverse order. Generators only go forwards, so it remembers where they were at every
/// border of a block, and draws block by block.
class DealBackwards {
 public:
  DealBackwards(std::uint64_t count, std::uint64_t seed)
      : last_(count - 1), block_(std::max<std::uint64_t>(1024, std::bit_ceil(count) >> (std::bit_width(count) / 2))) {
    RandomStream random(seed, 0, 0, Purpose::species);
    for (std::uint64_t last = last_; last > 0; --last) {
      if ((last_ - last) % block_ == 0) borders_.push_back(random);
      static_cast<void>(random.below(last + 1));
    }
  }

  /// Calls visit(last, other) for each exchange, the last one first.
  template <class Visit>
  void for_each(Visit visit) const {
    std::vector<std::uint64_t> others;
    for (std::size_t k = borders_.size(); k-- > 0;) {
      RandomStream random = borders_[k];
      std::uint64_t const begin = last_ - k * block_;
      std::uint64_t const end = begin > block_ ? begin - block_ : 0;
      others.clear();
      for (std::uint64_t last = begin; last > end; --last) others.push_back(random.below(last + 1));
      for (std::uint64_t last = end + 1; last <= begin; ++last) visit(last, others[begin - last]);
    }
  }

 private:
  std::uint64_t last_;
  std::uint64_t block_;
  std::vector<RandomStream> borders_;
};

/// The places of some disks while all are dealt out: which of them is where is found in chains of those whose places
/// agree in their last bits, and a bit for each place of all tells quickly that none is there.
class PlacesInDeal {
 public:
  /// They begin at first … end − 1.
  PlacesInDeal(std::uint64_t count, std::uint64_t first, std::uint64_t end)
      : is_taken_(count, false),
        places_(end - first),
        next_(places_.size(), nobody),
        chains_(std::bit_ceil(places_.size()), nobody) {
    for (std::uint64_t k = 0; k < places_.size(); ++k) put(k, first + k);
  }

  /// Swaps the disks at two places.
  void exchange(std::uint64_t place, std::uint64_t other) {
    if (place == other || (!is_taken_[place] && !is_taken_[other])) return;
    std::uint64_t const at_place = take(place);
    std::uint64_t const at_other = take(other);
    if (at_place != nobody) put(at_place, other);
    if (at_other != nobody) put(at_other, place);
  }

  [[nodiscard]] std::vector<std::uint64_t> take_places() { return std::move(places_); }

 private:
  static constexpr std::uint64_t nobody = std::numeric_limits<std::uint64_t>::max();

  [[nodiscard]] std::uint64_t& chain_of(std::uint64_t place) { return chains_[place & (chains_.size() - 1)]; }

  void put(std::uint64_t disk, std::uint64_t place) {
    std::uint64_t& first = chain_of(place);
    places_[disk] = place;
    next_[disk] = first;
    first = disk;
    is_taken_[place] = true;
  }

  [[nodiscard]] std::uint64_t take(std::uint64_t place) {
    if (!is_taken_[place]) return nobody;
    is_taken_[place] = false;
    std::uint64_t* link = &chain_of(place);
    while (places_[*link] != place) link = &next_[*link];
    std::uint64_t const disk = *link;
    *link = next_[disk];
    return disk;
  }

  std::vector<bool> is_taken_;
  std::vector<std::uint64_t> places_;  ///< by disk
  std::vector<std::uint64_t> next_;    ///< by disk: the next one of its chain
  std::vector<std::uint64_t> chains_;  ///< the first disk of each
};

}  // namespace

bool are_equal(DisksSettings const& settings) {
  return settings.species.empty() && settings.sizes == SizeDistribution::equal;
}

std::vector<std::uint64_t> rows_before_deal(std::uint64_t count, std::uint64_t seed, std::uint64_t first,
                                            std::uint64_t end) {
  if (first == end) return {};
  PlacesInDeal places(count, first, end);
  DealBackwards(count, seed).for_each([&](std::uint64_t last, std::uint64_t other) { places.exchange(last, other); });
  return places.take_places();
}

Kinds::Kinds(DisksSettings const& settings, ShareOfRows const& share, std::uint64_t seed)
    : count_(share.all()), first_(share.first()) {
  require_one_description_of_sizes(settings);
  if (are_equal(settings)) {
    sum_of_squared_ratios_ = static_cast<double>(count_);
    return;
  }
  deal(settings, share, seed);
  sum_of_squared_ratios_ = share.add_in_order(0.0, [this](double& sum) {
    sum = std::inner_product(size_ratios_.begin(), size_ratios_.end(), size_ratios_.begin(), sum);
  });
}

void Kinds::deal(DisksSettings const& settings, ShareOfRows const& share, std::uint64_t seed) {
  KindsInOrder const kinds(settings, share);
  largest_ratio_ = kinds.largest_ratio();
  size_ratios_.reserve(share.size());
  masses_.reserve(share.size());
  auto const add = [&](std::uint64_t row) {
    size_ratios_.push_back(kinds.size_ratio(row));
    masses_.push_back(kinds.mass(row));
  };
  if (share.size() < count_) {
    std::ranges::for_each(rows_before_deal(count_, seed, share.first(), share.end()), add);
    return;
  }
  for (std::uint64_t row = 0; row < count_; ++row) add(row);
  // Fisher–Yates, so that every deal of the kinds over the sites is as likely as any other.
  RandomStream random(seed, 0, 0, Purpose::species);
  for (std::uint64_t last = count_ - 1; last > 0; --last) {
    std::uint64_t const other = random.below(last + 1);
    std::swap(size_ratios_[last], size_ratios_[other]);
    std::swap(masses_[last], masses_[other]);
  }
}

}  // namespace gridlock
