#include "gridlock/core/target.hpp"

#include <array>
#include <cstdlib>
#include <string_view>

#include "core/avx512.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

constexpr std::array all_targets{Target::scalar, Target::avx512};

bool is_here(Target target) {
  if (target == Target::scalar) return true;
#ifdef GRIDLOCK_AVX512
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
#else
  return false;
#endif
}

Target choose() {
  char const* const wish = std::getenv("GRIDLOCK_TARGET");
  std::string_view const name = wish == nullptr ? "" : wish;
  Target fastest = Target::scalar;
  std::string names;
  for (Target const target : all_targets) {
    if (!is_here(target)) continue;
    if (name == to_text(target)) return target;
    fastest = target;
    names += std::string(names.empty() ? "" : ", ") + to_text(target);
  }
  if (name.empty()) return fastest;
  throw Error({.what = "GRIDLOCK_TARGET is \"" + std::string(name) + "\"; this processor has: " + names,
               .hint = "use one of these, or unset the variable to get the fastest"});
}

}  // namespace

char const* to_text(Target target) { return target == Target::avx512 ? "avx512" : "scalar"; }

Target target() {
  static Target const chosen = choose();
  return chosen;
}

}  // namespace gridlock
