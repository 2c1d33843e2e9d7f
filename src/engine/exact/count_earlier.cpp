#include "engine/exact/count_earlier.hpp"

// This file is written once with Google Highway and compiled once for every target below, because it includes itself.
// It uses only headers of Highway; target() chooses the kernel. SVE is left out: its registers have no fixed size.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/exact/count_earlier.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Without vector instructions the plain C++ below is as fast as Highway with one lane.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::exact::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void count_earlier(double const* times, std::size_t batches, std::uint64_t* earlier) {
  using Times = hn::CappedTag<double, times_per_batch>;
  using Counts = hn::RebindToSigned<Times>;
  Times const tag;
  Counts const counts;
  constexpr std::size_t lanes = hn::MaxLanes(Times());
  constexpr std::size_t registers = times_per_batch / lanes;
  std::size_t const end = batches * times_per_batch;
  for (std::size_t k = 0; k < end; k += times_per_batch) {
    hn::Vec<Times> mine[registers];
    hn::Vec<Counts> count[registers];
    for (std::size_t r = 0; r < registers; ++r) {
      mine[r] = hn::LoadU(tag, times + k + r * lanes);
      count[r] = hn::Zero(counts);
    }
    for (std::size_t j = 0; j < end; ++j) {
      auto const other = hn::Set(tag, times[j]);
      for (std::size_t r = 0; r < registers; ++r) {
        // A true lane is −1, so subtracting it counts.
        count[r] = hn::Sub(count[r], hn::BitCast(counts, hn::VecFromMask(tag, hn::Lt(other, mine[r]))));
      }
    }
    for (std::size_t r = 0; r < registers; ++r) {
      hn::StoreU(hn::BitCast(hn::RebindToUnsigned<Times>(), count[r]), hn::RebindToUnsigned<Times>(),
                 earlier + k + r * lanes);
    }
  }
}

}  // namespace gridlock::exact::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock::exact {

namespace {

/// Counts by loops of fixed length, which compilers turn into vector instructions.
void count_earlier_plain(double const* times, std::size_t batches, std::uint64_t* earlier) {
  std::size_t const end = batches * times_per_batch;
  for (std::size_t k = 0; k < end; ++k) {
    std::uint64_t count = 0;
    for (std::size_t j = 0; j < end; j += times_per_batch) {
      for (std::size_t r = 0; r < times_per_batch; ++r) count += times[j + r] < times[k] ? 1 : 0;
    }
    earlier[k] = count;
  }
}

}  // namespace

CountEarlier count_earlier_kernel([[maybe_unused]] Target target) {
#if HWY_TARGETS & HWY_SSE4
  if (target == Target::sse4) return N_SSE4::count_earlier;
#endif
#if HWY_TARGETS & HWY_AVX2
  if (target == Target::avx2) return N_AVX2::count_earlier;
#endif
#if HWY_TARGETS & HWY_AVX3
  if (target == Target::avx512) return N_AVX3::count_earlier;
#endif
#if HWY_TARGETS & HWY_NEON
  if (target == Target::neon) return N_NEON::count_earlier;
#endif
  return count_earlier_plain;
}

}  // namespace gridlock::exact

#endif
