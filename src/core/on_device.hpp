#pragma once

/// Marks a function that kernels of a graphics processor call and that cannot be constexpr, as it takes square roots.
/// Compilers for such processors take constexpr functions as they are.
#if defined(__CUDACC__)
#define GRIDLOCK_ON_DEVICE __host__ __device__
#else
#define GRIDLOCK_ON_DEVICE
#endif
