#include "gridlock/core/detail/large_array.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace gridlock {

namespace {

constexpr std::size_t huge_page = std::size_t{1} << 21;
constexpr std::size_t cache_line = 64;

/// Where an array begins in its first huge page, another place for each of 32 arrays that follow one another.
///
/// A cache keeps a line in one of few places that the low bits of its address choose. Columns that all began at the
/// border of a page, and are read side by side, would drive one another out.
std::size_t next_shift() {
  static std::atomic<std::size_t> arrays{0};
  constexpr std::size_t places = 32;
  constexpr std::size_t lines_apart =
      33;  // one more than a power of two, so that also caches of few bits see 32 places
  return arrays.fetch_add(1, std::memory_order_relaxed) % places * lines_apart * cache_line;
}

}  // namespace

void* allocate_large(std::size_t bytes) {
  if (bytes < huge_page) return ::operator new (bytes, std::align_val_t{cache_line});
  std::size_t const shift = next_shift();
  auto* const memory = static_cast<std::byte*>(::operator new (shift + bytes, std::align_val_t{huge_page}));
#if defined(__linux__)
  // Only advice: where it is not taken the memory still works.
  static_cast<void>(madvise(memory, shift + bytes, MADV_HUGEPAGE));
#endif
  return memory + shift;
}

void free_large(void* memory, std::size_t bytes) noexcept {
  if (bytes < huge_page) return ::operator delete (memory, std::align_val_t{cache_line});
  std::size_t const shift = reinterpret_cast<std::uintptr_t>(memory) % huge_page;
  ::operator delete (static_cast<std::byte*>(memory) - shift, std::align_val_t{huge_page});
}

}  // namespace gridlock
