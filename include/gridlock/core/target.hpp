#pragma once

/// \file
/// Which instructions of the processor the fast kernels use.
///
/// ```cpp
/// std::string const instructions = to_text(target());  // "avx512", "avx2", "sse4", "neon" or "scalar"
/// ```

#include <string>
#include <vector>

namespace gridlock {

/// Instructions that kernels are written for, the plainest first. Results have the same bits with any. A kernel that is
/// not written for these takes the next plainer ones that it is written for.
enum class Target {
  scalar,  ///< what the compiler makes of plain C++
  sse4,    ///< two numbers at a time: x86 with SSE4.2
  neon,    ///< two numbers at a time: 64-bit ARM
  avx2,    ///< four numbers at a time: x86 with AVX2, FMA and BMI2
  avx512,  ///< eight numbers at a time: x86 with AVX-512 F, DQ, VL and BW
};
char const* to_text(Target target);
/// Whether this processor has the instructions of the target and this build has kernels for it.
bool is_available(Target target);
/// All that are, the plainest first.
std::vector<Target> available_targets();

/// The fastest instructions that this processor has, or those that the environment variable GRIDLOCK_TARGET names;
/// looked up once.
/// Errors: Error where it names none, or instructions that this processor or this build lacks.
Target target();

}  // namespace gridlock
