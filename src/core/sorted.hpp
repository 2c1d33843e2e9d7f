#pragma once

#include <algorithm>
#include <vector>

namespace gridlock {

/// Sorts values and keeps one of those that are equal.
template <class Value>
void sort_and_drop_repeats(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace gridlock
