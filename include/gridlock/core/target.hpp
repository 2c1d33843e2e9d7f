#pragma once

/// \file
/// Which instructions of the processor the fast kernels use.
///
/// ```cpp
/// std::string const instructions = to_text(target());  // "avx512" on a processor that has them, "scalar" elsewhere
/// ```

#include <string>

namespace gridlock {

/// Instructions that kernels are written for, the plainest first. Results have the same bits with any.
enum class Target {
  scalar,  ///< what the compiler makes of plain C++
  avx512,  ///< eight numbers at a time: x86 with AVX-512 F, DQ, VL and BW
};
char const* to_text(Target target);

/// The fastest instructions that this processor has, or those that the environment variable GRIDLOCK_TARGET names; looked up once.
/// Errors: Error where it names none, or instructions that this processor or this build lacks.
Target target();

}  // namespace gridlock
