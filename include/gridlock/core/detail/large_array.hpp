#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace gridlock {

/// Memory for `bytes` bytes, in huge pages where the system has them: with small pages, a run of a million disks spends
/// much of its time looking up addresses. Errors: std::bad_alloc.
void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes) noexcept;

/// While it lives, what this thread asks allocate_large() for lies in one block of memory, one array behind the other
/// and nothing else between, as long as it has room. The block goes with the last of them.
class SideBySide {
 public:
  explicit SideBySide(std::size_t room);
  ~SideBySide();
  SideBySide(SideBySide const&) = delete;
  SideBySide& operator=(SideBySide const&) = delete;

  /// The room that an array of so many bytes takes.
  static std::size_t room_for(std::size_t bytes);

 private:
  struct MemoryBlock* before_;
};

/// Whether two arrays of allocate_large() lie in one such block.
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

/// A vector whose elements are aligned to cache lines, in huge pages when it is long.
template <class Value>
using LargeArray = std::vector<Value, LargePageAllocator<Value>>;

/// The same, but resize() leaves new elements as they are in memory: for numbers that are all written before they are
/// read.
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
