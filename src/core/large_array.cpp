#include "gridlock/core/detail/large_array.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace gridlock {

namespace {

constexpr std::size_t huge_page = std::size_t{1} << 21;
constexpr std::size_t cache_line = 64;

/// Returns the offset of an array in its first huge page, different for each of 32 consecutive arrays. Caches find
/// lines by the low bits of addresses: columns that all began at a page border would evict each other.
std::size_t next_shift() {
  static std::atomic<std::size_t> arrays{0};
  constexpr std::size_t places = 32;
  constexpr std::size_t lines_apart =
      33;  // one more than a power of two, so that caches that use few bits see 32 different offsets too
  return arrays.fetch_add(1, std::memory_order_relaxed) % places * lines_apart * cache_line;
}

void* allocate_alone(std::size_t bytes) {
  if (bytes < huge_page) return ::operator new (bytes, std::align_val_t{cache_line});
  std::size_t const shift = next_shift();
  auto* const memory = static_cast<std::byte*>(::operator new (shift + bytes, std::align_val_t{huge_page}));
#if defined(__linux__)
  // The kernel may ignore this advice: the memory works without huge pages.
  static_cast<void>(madvise(memory, shift + bytes, MADV_HUGEPAGE));
#endif
  return memory + shift;
}

void free_alone(void* memory, std::size_t bytes) noexcept {
  if (bytes < huge_page) return ::operator delete (memory, std::align_val_t{cache_line});
  std::size_t const shift = reinterpret_cast<std::uintptr_t>(memory) % huge_page;
  ::operator delete (static_cast<std::byte*>(memory) - shift, std::align_val_t{huge_page});
}

/// The header in the cache line before each array.
struct alignas(cache_line) Head {
  MemoryBlock* block;  ///< block that contains the array, or nullptr
};

Head* head_of(void const* memory) {
  return reinterpret_cast<Head*>(const_cast<std::byte*>(static_cast<std::byte const*>(memory)) - sizeof(Head));
}

}  // namespace

struct MemoryBlock {
  std::byte* memory;
  std::size_t room;
  std::size_t used = 0;                ///< bytes used, changed only by the thread that made the block
  std::atomic<std::size_t> users = 1;  ///< number of arrays in the block, plus its SideBySide
};

namespace {

thread_local MemoryBlock* open_block = nullptr;

void leave(MemoryBlock* block) noexcept {
  if (block->users.fetch_sub(1) != 1) return;
  free_alone(block->memory, block->room);
  delete block;
}

}  // namespace

SideBySide::SideBySide(std::size_t room) : before_(open_block) {
  std::unique_ptr<MemoryBlock> block(new MemoryBlock{.memory = nullptr, .room = std::max(room, cache_line)});
  block->memory = static_cast<std::byte*>(allocate_alone(block->room));
  open_block = block.release();
}

SideBySide::~SideBySide() { leave(std::exchange(open_block, before_)); }

std::size_t SideBySide::room_for(std::size_t bytes) {
  return sizeof(Head) + (bytes + cache_line - 1) / cache_line * cache_line;
}

bool are_side_by_side(void const* one, void const* other) {
  return head_of(one)->block != nullptr && head_of(one)->block == head_of(other)->block;
}

void* allocate_large(std::size_t bytes) {
  std::size_t const room = SideBySide::room_for(bytes);
  MemoryBlock* const block =
      open_block != nullptr && open_block->room - open_block->used >= room ? open_block : nullptr;
  void* memory = nullptr;
  if (block != nullptr) {
    memory = block->memory + std::exchange(block->used, block->used + room);
    ++block->users;
  } else {
    memory = allocate_alone(room);
  }
  return static_cast<std::byte*>(static_cast<void*>(::new (memory) Head{block})) + sizeof(Head);
}

void free_large(void* memory, std::size_t bytes) noexcept {
  Head* const head = head_of(memory);
  if (head->block != nullptr) return leave(head->block);
  free_alone(head, SideBySide::room_for(bytes));
}

}  // namespace gridlock
