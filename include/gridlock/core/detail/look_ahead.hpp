#pragma once

#include <cstddef>

namespace gridlock {

/// Prefetches the memory at `address`, which will be written soon; harmless for any address.
[[gnu::always_inline]] inline void prefetch(void const* address) {
  // The level-2 cache: dozens of lines prefetched into level 1 would evict each other (AMD Zen 4: 40 ns a line, here 7
  // ns).
  __builtin_prefetch(address, 1, 2);
  // Without this statement gcc drops calls of functions that do nothing but prefetch, as calls without effect.
  asm volatile("" : : "r"(address));
}

/// Prefetches memory that will be read next, into the level-1 cache.
[[gnu::always_inline]] inline void prefetch_near(void const* address) {
  __builtin_prefetch(address, 0, 3);
  asm volatile("" : : "r"(address));
}

/// Does `count` pieces of work in order, and prefetches the memory of later pieces meanwhile.
///
///     piece k + 16   1st step   prefetches the index that gives its address
///     piece k + 8    2nd step   prefetches the memory at this address
///     piece k        last step  does the work
///
/// Reading memory at a random address takes as long as a thousand instructions, but a dozen such reads can overlap.
/// Contract: all steps but the last only prefetch, since they run before the work of earlier pieces is done.
template <class... Steps>
void carry_out_with_look_ahead(std::size_t count, Steps... steps) {
  constexpr std::size_t distance = 8;
  constexpr std::size_t farthest = distance * (sizeof...(Steps) - 1);
  for (std::size_t k = 0; k < count + farthest; ++k) {
    std::size_t behind = 0;
    auto const take = [&](auto& step) {
      if (k >= behind && k - behind < count) step(k - behind);
      behind += distance;
    };
    (take(steps), ...);
  }
}

}  // namespace gridlock
