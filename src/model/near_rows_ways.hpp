#pragma once

#include "gridlock/model/near_rows.hpp"

namespace gridlock {

// The two ways of find_near_rows(), which a test compares.

std::size_t find_near_rows_plainly(NearRowsSearch const& search, std::span<Stretch const> stretches,
                                   std::uint32_t* found);

bool can_find_near_rows_with_avx512();
/// Contract: can_find_near_rows_with_avx512().
std::size_t find_near_rows_with_avx512(NearRowsSearch const& search, std::span<Stretch const> stretches,
                                       std::uint32_t* found);

}  // namespace gridlock
