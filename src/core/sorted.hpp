#pragma once

#include <algorithm>
#include <vector>

namespace gridlock {

/// Sorts values and removes duplicates.
template <class Value>
void sort_and_drop_repeats(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace gridlock
