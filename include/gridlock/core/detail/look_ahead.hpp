#pragma once

#include <cstddef>

namespace gridlock {

/// Asks for the memory at `address`, which is going to be changed soon; changes nothing, whatever the address.
[[gnu::always_inline]] inline void prefetch(void const* address) {
  // Into the second cache: asked into the first, dozens of lines at once keep one another out (AMD Zen 4: 7 ns a line
  // instead of 40).
  __builtin_prefetch(address, 1, 2);
  // Without this a function that does nothing but prefetch counts as one without effect, and gcc drops the call.
  asm volatile("" : : "r"(address));
}

/// Asks for a few lines of memory that are needed next, into the first cache.
[[gnu::always_inline]] inline void prefetch_near(void const* address) {
  __builtin_prefetch(address, 0, 3);
  asm volatile("" : : "r"(address));
}

/// Carries out `count` pieces of work in their order, while the memory that the next ones need is fetched.
///
///     piece k + 16   1st step   asks for what says where its memory is
///     piece k + 8    2nd step   asks for that memory
///     piece k        last step  does the work
///
/// A line of memory at a random place takes as long to come as a thousand instructions, but a dozen come in the time of
/// one. Contract: all steps but the last only ask for memory; they see a world in which earlier pieces are still to do.
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
