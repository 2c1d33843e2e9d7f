#pragma once

// The compiler for WebAssembly includes this file before every source: parts of C++20 that the standard library of
// Emscripten 3.1.6 lacks. Results keep their bits: range algorithms are those of range-v3, on which the standard is
// modelled, and numbers are read by fast_float and written by fmt, which round correctly, as charconv does.

#include <range/v3/algorithm.hpp>
#include <range/v3/range/access.hpp>
#include <range/v3/range/primitives.hpp>

#include <algorithm>
#include <atomic>
#include <bit>
#include <charconv>
#include <cstddef>
#include <functional>
#include <memory>
#include <system_error>
#include <type_traits>

// Random123 refuses unknown processors. Its results do not depend on the processor; only x86 has special instructions.
#define R123_USE_GNU_UINT128 1
#define __riscv
#include <Random123/features/compilerfeatures.h>
#undef __riscv

namespace std {  // the missing parts of it

template <class To, class From>
requires(sizeof(To) == sizeof(From) && is_trivially_copyable_v<To> && is_trivially_copyable_v<From>) constexpr To
    bit_cast(From const& from) noexcept {
  return __builtin_bit_cast(To, from);
}

template <class Array>
requires is_unbounded_array_v<Array> unique_ptr<Array> make_unique_for_overwrite(size_t size) {
  return unique_ptr<Array>(new remove_extent_t<Array>[size]);
}

/// A replacement without synchronization, since there is only one thread.
template <class Value>
class atomic_ref {
 public:
  explicit atomic_ref(Value& value) : value_(&value) {}
  Value load(memory_order = memory_order_seq_cst) const { return *value_; }
  Value fetch_add(Value number, memory_order = memory_order_seq_cst) const {
    Value const before = *value_;
    *value_ += number;
    return before;
  }
  Value fetch_sub(Value number, memory_order = memory_order_seq_cst) const {
    Value const before = *value_;
    *value_ -= number;
    return before;
  }
  Value fetch_or(Value bits, memory_order = memory_order_seq_cst) const {
    Value const before = *value_;
    *value_ |= bits;
    return before;
  }

 private:
  Value* value_;
};

from_chars_result from_chars(char const* first, char const* last, double& value);
to_chars_result to_chars(char* first, char* last, double value, chars_format format);

namespace ranges {
using ::ranges::adjacent_find;
using ::ranges::all_of;
using ::ranges::any_of;
using ::ranges::binary_search;
using ::ranges::copy;
using ::ranges::copy_if;
using ::ranges::count;
using ::ranges::count_if;
using ::ranges::empty;
using ::ranges::equal;
using ::ranges::fill;
using ::ranges::find;
using ::ranges::find_if;
using ::ranges::for_each;
using ::ranges::is_sorted;
using ::ranges::lower_bound;
using ::ranges::max;
using ::ranges::max_element;
using ::ranges::merge;
using ::ranges::min;
using ::ranges::min_element;
using ::ranges::minmax;
using ::ranges::mismatch;
using ::ranges::move;
using ::ranges::none_of;
using ::ranges::nth_element;
using ::ranges::pop_heap;
using ::ranges::push_heap;
using ::ranges::replace;
using ::ranges::reverse;
using ::ranges::set_difference;
using ::ranges::size;
using ::ranges::sort;
using ::ranges::stable_sort;
using ::ranges::transform;
using ::ranges::upper_bound;
}  // namespace ranges

}  // namespace std
