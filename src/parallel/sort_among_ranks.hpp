#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/row_division.hpp"
#include "parallel/exchange.hpp"
#include "parallel/keys_at.hpp"

namespace gridlock {

/// Returns where a rank cuts its sorted values so that the first pieces of all ranks are the rows of rank 0 in the
/// order of the keys, the second those of rank 1: the end of each piece. Contract: all keys differ. All ranks call it.
/// Cost: a round of messages for each bit of the largest key.
template <class Value, class KeyOf>
std::vector<std::size_t> cuts_of_sorted(Communicator& ranks, std::vector<Value> const& values, RowDivision const& rows,
                                        KeyOf key_of) {
  auto const count_below = [&](std::uint64_t key) {
    return std::ranges::lower_bound(values, key, {}, key_of) - values.begin();
  };
  std::vector<std::uint64_t> const behind_cuts =
      keys_at(rows.begins().subspan(1), highest_bit_of_all(ranks, values.empty() ? 0 : key_of(values.back())),
              count_below, [&](std::span<std::uint64_t> counts) { all_sum(ranks, counts); });
  std::size_t const cuts = rows.ranks();
  std::vector<std::size_t> ends(cuts);
  for (std::size_t cut = 0; cut < cuts; ++cut) ends[cut] = static_cast<std::size_t>(count_below(behind_cuts[cut]));
  for (std::size_t cut = 0; cut < cuts; ++cut) {
    if (rows.end(cut) == rows.rows()) ends[cut] = values.size();
  }
  return ends;
}

/// Sorts the values of all ranks by key and gives each rank its rows of the division. Contract: all keys differ. All
/// ranks call it. Memory: a second copy of the values of a rank.
template <class Value, class KeyOf>
void sort_among_ranks(Communicator& ranks, std::vector<Value>& values, RowDivision const& rows, KeyOf key_of) {
  std::ranges::sort(values, {}, key_of);
  std::vector<std::size_t> const ends = cuts_of_sorted(ranks, values, rows, key_of);
  std::vector<Value> come;
  come.reserve(rows.rows_of(ranks.rank()));
  std::size_t rank = 0;
  exchange_values<Value>(
      ranks, values.size(),
      [&](std::size_t k, auto give) {
        while (k >= ends[rank]) ++rank;
        give(rank, values[k]);
      },
      [&](Value const& value) { come.push_back(value); });
  values = std::move(come);
  std::ranges::sort(values, {}, key_of);
}

}  // namespace gridlock
