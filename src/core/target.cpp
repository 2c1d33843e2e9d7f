#include "gridlock/core/target.hpp"

#include <array>
#include <cstdlib>
#include <string_view>

#include "core/avx512.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

constexpr std::array all_targets{Target::scalar, Target::sse4, Target::neon, Target::avx2, Target::avx512};

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
  if (target == Target::sse4) return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("pclmul");
  if (target == Target::avx2) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2");
  }
#endif
#ifdef GRIDLOCK_AVX512
  if (target == Target::avx512) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
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
