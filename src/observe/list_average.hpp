#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// Averages of each entry of a list, such as a histogram, that may be longer in a later sample: an entry counts as 0 in
/// the samples before.
class ListAverage {
 public:
  void add(std::span<double const> values) {
    while (entries_.size() < values.size()) entries_.push_back(absent_);
    absent_.add(0.0);
    for (std::size_t k = 0; k < entries_.size(); ++k) entries_[k].add(k < values.size() ? values[k] : 0.0);
  }
  void clear() { *this = {}; }

  [[nodiscard]] std::span<BlockAverage const> entries() const { return entries_; }

  void serialize(Archive& archive, std::string_view name) {
    serialize_inside(archive, name, [&] {
      std::uint64_t size = entries_.size();
      archive.visit("size", size);
      archive.require(size <= max_size, "a list of averages is too long");
      entries_.resize(size);
      gridlock::serialize(archive, "entries", entries_);
      gridlock::serialize(archive, "absent", std::span(&absent_, 1));
    });
  }

 private:
  static constexpr std::uint64_t max_size = 100'000'000;

  std::vector<BlockAverage> entries_;
  BlockAverage absent_;  ///< as many samples as of any entry, all 0
};

}  // namespace gridlock
