#include "gridlock/core/target.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#include <cpuid.h>
#endif

#include <array>
#include <cstdlib>
#include <string_view>

#include "core/avx512.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

constexpr std::array all_targets{Target::scalar, Target::sse4, Target::neon, Target::avx2, Target::avx512};

#if defined(__x86_64__) && defined(__GNUC__)
/// The instructions of the processor. The compilers' own question for them needs a library that not every system has.
struct Features {
  unsigned first = 0;     ///< bits of leaf 1
  unsigned extended = 0;  ///< bits of leaf 7
  unsigned saved = 0;     ///< registers that the system saves between processes: 0x6 for AVX, 0xE6 for AVX-512

  [[nodiscard]] bool has(unsigned in_first, unsigned in_extended, unsigned in_saved) const {
    return (first & in_first) == in_first && (extended & in_extended) == in_extended && (saved & in_saved) == in_saved;
  }
};

Features features_of_processor() {
  Features features;
  unsigned unused = 0;
  __get_cpuid(1, &unused, &unused, &features.first, &unused);
  __get_cpuid_count(7, 0, &unused, &features.extended, &unused, &unused);
  if ((features.first & bit_OSXSAVE) != 0) asm("xgetbv" : "=a"(features.saved), "=d"(unused) : "c"(0));
  return features;
}
#endif

Target choose() {
  char const* const wish = std::getenv("GRIDLOCK_TARGET");
  std::string_view const name = wish == nullptr ? "" : wish;
  Target fastest = Target::scalar;
  std::string names;
  for (Target const target : available_targets()) {
    if (name == to_text(target)) return target;
    fastest = target;
    names += std::string(names.empty() ? "" : ", ") + to_text(target);
  }
  if (name.empty()) return fastest;
  throw Error({.what = "GRIDLOCK_TARGET is \"" + std::string(name) + "\"; this processor has: " + names,
               .hint = "use one of these, or unset the variable to get the fastest"});
}

}  // namespace

char const* to_text(Target target) {
  switch (target) {
    case Target::sse4:
      return "sse4";
    case Target::neon:
      return "neon";
    case Target::avx2:
      return "avx2";
    case Target::avx512:
      return "avx512";
    case Target::scalar:
      break;
  }
  return "scalar";
}

bool is_available(Target target) {
  if (target == Target::scalar) return true;
#if defined(__x86_64__) && defined(__GNUC__)
  static Features const features = features_of_processor();
  if (target == Target::sse4) return features.has(bit_SSE4_2 | bit_PCLMUL, 0, 0);
  if (target == Target::avx2) return features.has(bit_FMA | bit_OSXSAVE, bit_AVX2 | bit_BMI | bit_BMI2, 0x6);
  if (target == Target::avx512) {
    return features.has(bit_OSXSAVE, bit_AVX512F | bit_AVX512DQ | bit_AVX512VL | bit_AVX512BW, 0xE6);
  }
#endif
#ifdef __aarch64__
  if (target == Target::neon) return true;
#endif
  return false;
}

std::vector<Target> available_targets() {
  std::vector<Target> targets;
  for (Target const target : all_targets) {
    if (is_available(target)) targets.push_back(target);
  }
  return targets;
}

Target target() {
  static Target const chosen = choose();
  return chosen;
}

}  // namespace gridlock
