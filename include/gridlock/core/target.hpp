#pragma once

/// \file
/// The vector instructions of the processor that kernels use.
///
/// ```cpp
/// std::string const instructions = to_text(target());  // "avx512", "avx2", "sse4", "neon" or "scalar"
/// ```

#include <string>
#include <vector>

namespace gridlock {

/// The vector instructions for which kernels are written, the slowest first. Results have the same bits with all of
/// them. A kernel without a variant for a target uses its variant for the nearest slower target.
enum class Target {
  scalar,  ///< no vector instructions: plain C++
  sse4,    ///< two numbers at a time: x86 with SSE4.2
  neon,    ///< two numbers at a time: 64-bit ARM
  avx2,    ///< four numbers at a time: x86 with AVX2, FMA and BMI2
  avx512,  ///< eight numbers at a time: x86 with AVX-512 F, DQ, VL and BW
};
char const* to_text(Target target);
/// Returns whether this processor has the instructions of the target and this build has kernels for it.
bool is_available(Target target);
/// Returns all targets for which is_available() is true, the slowest first.
std::vector<Target> available_targets();

/// Returns the fastest available target, or the target that the environment variable GRIDLOCK_TARGET names; the
/// variable is read once.
/// Errors: Error if GRIDLOCK_TARGET names no target, or one that is not available.
Target target();

}  // namespace gridlock
