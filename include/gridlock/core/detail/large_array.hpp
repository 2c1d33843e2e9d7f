#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace gridlock {

/// Allocates `bytes` bytes, in huge pages if the system has them. With small pages a run of a million disks spends much
/// of its time on misses of the address cache (TLB). Errors: std::bad_alloc.
void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes) noexcept;

/// During the life of this object, all arrays that this thread allocates with allocate_large() are placed one behind
/// the other in one block of `room` bytes, as long as they fit. The block is freed with the last of its arrays.
class SideBySide {
 public:
  explicit SideBySide(std::size_t room);
  ~SideBySide();
  SideBySide(SideBySide const&) = delete;
  SideBySide& operator=(SideBySide const&) = delete;

  /// Returns the bytes that an array of `bytes` bytes takes in a block.
  static std::size_t room_for(std::size_t bytes);

 private:
  struct MemoryBlock* before_;
};

/// Returns whether two arrays of allocate_large() are in the same block of a SideBySide.
bool are_side_by_side(void const* one, void const* other);

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

/// A vector that is aligned to cache lines and, if it is long, in huge pages.
template <class Value>
using LargeArray = std::vector<Value, LargePageAllocator<Value>>;

/// Like LargePageAllocator, but resize() does not initialize new elements: for numbers that are all written before they
/// are read.
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
