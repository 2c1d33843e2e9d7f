#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/exchange.hpp"
#include "gridlock/core/detail/ranks.hpp"
#include "gridlock/core/detail/row_division.hpp"

namespace gridlock {

/// Where a rank cuts its sorted values so that the first pieces of all ranks are the rows of rank 0 in the order of the keys, the second those of
/// rank 1: the end of each piece. No key is there twice. All call it. Cost: a round of messages for each bit of the largest key.
template <class Value, class KeyOf>
std::vector<std::size_t> cuts_of_sorted(Ranks& ranks, std::vector<Value> const& values, RowDivision const& rows,
                                        KeyOf key_of) {
  std::uint64_t bits = 0;
  std::uint64_t const largest = values.empty() ? 0 : key_of(values.back());
  for (Ranks::Bytes const& bytes : ranks.gather_for_all(message_of(largest))) {
    bits |= MessageReader(bytes).next<std::uint64_t>();
  }
  std::size_t const cuts = rows.ranks();
  std::vector<std::uint64_t> first(cuts, 0);  // key behind each cut
  std::vector<std::size_t> ends(cuts, 0);
  // Bit by bit from the highest: the largest key with no more keys below it than there are rows before the cut.
  for (std::uint64_t bit = std::uint64_t{1} << 63; bit != 0; bit >>= 1) {
    if (bit > bits) continue;
    std::vector<std::uint64_t> below;
    for (std::uint64_t const key : first) {
      auto const found = std::ranges::lower_bound(values, key | bit, {}, key_of);
      below.push_back(static_cast<std::uint64_t>(found - values.begin()));
    }
    std::vector<std::uint64_t> of_all(cuts, 0);
    for (Ranks::Bytes const& bytes : ranks.gather_for_all(message_of_all(std::span<std::uint64_t const>(below)))) {
      MessageReader message(bytes);
      for (std::uint64_t& count : of_all) count += message.next<std::uint64_t>();
    }
    for (std::size_t cut = 0; cut < cuts; ++cut) {
      if (of_all[cut] > rows.end(cut)) continue;
      first[cut] |= bit;
      ends[cut] = below[cut];
    }
  }
  for (std::size_t cut = 0; cut < cuts; ++cut) {
    if (rows.end(cut) == rows.rows()) ends[cut] = values.size();
  }
  return ends;
}

/// Puts the values of all ranks in the order of their keys, of which no two are equal: each rank gets its rows of the division. All call it.
/// Memory: the values of a rank once more.
template <class Value, class KeyOf>
void sort_among_ranks(Ranks& ranks, std::vector<Value>& values, RowDivision const& rows, KeyOf key_of) {
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
