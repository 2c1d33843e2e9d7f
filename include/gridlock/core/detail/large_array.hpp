#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace gridlock {

/// Memory for `bytes` bytes, in huge pages where the system has them: with small pages, a run of a million disks spends
/// much of its time looking up addresses. Errors: std::bad_alloc.
void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes) noexcept;

template <class Value>
struct LargePageAllocator {
  using value_type = Value;
  LargePageAllocator() = default;
  template <class Other>
  LargePageAllocator(LargePageAllocator<Other> const&) {}

  Value* allocate(std::size_t count) { return static_cast<Value*>(allocate_large(count * sizeof(Value))); }
  void deallocate(Value* memory, std::size_t count) noexcept { free_large(memory, count * sizeof(Value)); }

  friend bool operator==(LargePageAllocator const&, LargePageAllocator const&) { return true; }
};

/// A vector whose elements are aligned to cache lines, in huge pages when it is long.
template <class Value>
using LargeArray = std::vector<Value, LargePageAllocator<Value>>;

/// The same, but resize() leaves new elements as they are in memory: for numbers that are all written before they are read.
template <class Value>
struct UninitializedPageAllocator : LargePageAllocator<Value> {
  template <class Other>
  struct rebind {
    using other = UninitializedPageAllocator<Other>;
  };
  template <class Other>
  void construct(Other* element) noexcept {
    ::new (static_cast<void*>(element)) Other;
  }
};

template <class Value>
using UninitializedArray = std::vector<Value, UninitializedPageAllocator<Value>>;

}  // namespace gridlock
