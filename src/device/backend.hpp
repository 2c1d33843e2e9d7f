#pragma once

/// \file
/// The device as kernels see it: a graphics processor where nvcc compiles this, else the cores of the machine, which
/// take the threads of a launch in an order of no meaning, side by side, so that a kernel that depends on it is found.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/on_device.hpp"
#include "gridlock/engine/device.hpp"

#if defined(__CUDACC__)
#include <cuda_runtime.h>
#else
#include <atomic>

#include "gridlock/core/detail/thread_pool.hpp"
#endif

namespace gridlock::device {

// Functions of kernels. Each reads and writes a number at once, whatever other threads of the launch do.

/// Adds to a number, and returns the number before.
GRIDLOCK_ON_DEVICE inline std::uint32_t fetch_add(std::uint32_t& number, std::uint32_t term) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(&number, term);
#else
  return __atomic_fetch_add(&number, term, __ATOMIC_RELAXED);
#endif
}
GRIDLOCK_ON_DEVICE inline void add(std::uint64_t& number, std::uint64_t term) {
#if defined(__CUDA_ARCH__)
  atomicAdd(reinterpret_cast<unsigned long long*>(&number), static_cast<unsigned long long>(term));
#else
  __atomic_fetch_add(&number, term, __ATOMIC_RELAXED);
#endif
}
GRIDLOCK_ON_DEVICE inline std::uint32_t load(std::uint32_t const& number) {
#if defined(__CUDA_ARCH__)
  return *const_cast<std::uint32_t const volatile*>(&number);
#else
  return __atomic_load_n(&number, __ATOMIC_RELAXED);
#endif
}
GRIDLOCK_ON_DEVICE inline void store(std::uint32_t& number, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  *const_cast<std::uint32_t volatile*>(&number) = value;
#else
  __atomic_store_n(&number, value, __ATOMIC_RELAXED);
#endif
}
GRIDLOCK_ON_DEVICE inline std::uint64_t load(std::uint64_t const& number) {
#if defined(__CUDA_ARCH__)
  std::uint64_t const value = *const_cast<std::uint64_t const volatile*>(&number);
  __threadfence();
  return value;
#else
  return __atomic_load_n(&number, __ATOMIC_ACQUIRE);
#endif
}
/// Replaces a number by another one if it is `expected`; if it is not, `expected` becomes the number.
GRIDLOCK_ON_DEVICE inline bool replace(std::uint64_t& number, std::uint64_t& expected, std::uint64_t by) {
#if defined(__CUDA_ARCH__)
  __threadfence();
  auto const before = atomicCAS(reinterpret_cast<unsigned long long*>(&number),
                                static_cast<unsigned long long>(expected), static_cast<unsigned long long>(by));
  __threadfence();
  bool const is_replaced = before == expected;
  expected = before;
  return is_replaced;
#else
  return __atomic_compare_exchange_n(&number, &expected, by, false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE);
#endif
}

#if defined(__CUDACC__)

/// Throws RunFailure with the words of the driver where a call failed.
void require_success(cudaError_t error, char const* what);

template <class Kernel>
__global__ void run_kernel(std::size_t count, __grid_constant__ Kernel const kernel) {
  std::size_t const k = blockIdx.x * std::size_t{blockDim.x} + threadIdx.x;
  if (k < count) kernel(k);
}

/// Launches kernels, one after the other.
class Launcher {
 public:
  explicit Launcher(std::uint64_t /*threads*/) {}

  /// Calls kernel(k) on the device for each k < count, in any order and side by side.
  template <class Kernel>
  void for_each(std::size_t count, Kernel const& kernel) {
    if (count == 0) return;
    constexpr unsigned threads_of_block = 128;
    auto const blocks = static_cast<unsigned>((count + threads_of_block - 1) / threads_of_block);
    void* arguments[] = {&count, const_cast<Kernel*>(&kernel)};
    auto const* const function = reinterpret_cast<void const*>(&run_kernel<Kernel>);
    require_success(cudaLaunchKernel(function, dim3(blocks), dim3(threads_of_block), arguments, 0, nullptr),
                    "a kernel cannot be launched");
  }
};

/// An array in the memory of the device.
template <class T>
class Array {
 public:
  explicit Array(std::size_t size) : size_(size) {
    // One element where there are none, so that the pointer is one of the device.
    require_success(cudaMalloc(&data_, (size > 0 ? size : 1) * sizeof(T)), "the device has no memory left");
    cudaError_t const error = cudaMemset(data_, 0, size_ * sizeof(T));
    if (error != cudaSuccess) cudaFree(data_);
    require_success(error, "the device cannot clear memory");
  }
  explicit Array(std::span<T const> values) : Array(values.size()) { upload(values); }
  Array(Array const&) = delete;
  Array(Array&& other) noexcept : size_(other.size_), data_(std::exchange(other.data_, nullptr)) {}
  Array& operator=(Array const&) = delete;
  Array& operator=(Array&& other) noexcept {
    std::swap(size_, other.size_);
    std::swap(data_, other.data_);
    return *this;
  }
  ~Array() { cudaFree(data_); }

  [[nodiscard]] T* data() { return data_; }
  void clear() { require_success(cudaMemset(data_, 0, size_ * sizeof(T)), "the device cannot clear memory"); }
  [[nodiscard]] std::size_t size() const { return size_; }
  void upload(std::span<T const> values) {
    require_success(cudaMemcpy(data_, values.data(), values.size_bytes(), cudaMemcpyHostToDevice),
                    "the device takes no data");
  }
  void download(std::span<T> values) const {
    require_success(cudaMemcpy(values.data(), data_, values.size_bytes(), cudaMemcpyDeviceToHost),
                    "the device gives no data");
  }

 private:
  std::size_t size_;
  T* data_ = nullptr;
};

#else

class Launcher {
 public:
  explicit Launcher(std::uint64_t threads) : threads_(threads) {}

  template <class Kernel>
  void for_each(std::size_t count, Kernel const& kernel) {
    std::size_t const parts = threads_.size();
    threads_.for_each(parts, [&](std::size_t part) {
      for (std::size_t k = part; k < count; k += parts) kernel(count - 1 - k);
    });
  }

 private:
  ThreadPool threads_;
};

template <class T>
class Array {
 public:
  explicit Array(std::size_t size) : values_(size) {}
  explicit Array(std::span<T const> values) : values_(values.begin(), values.end()) {}

  [[nodiscard]] T* data() { return values_.data(); }
  void clear() { std::fill(values_.begin(), values_.end(), T{}); }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  void upload(std::span<T const> values) { std::copy(values.begin(), values.end(), values_.begin()); }
  void download(std::span<T> values) const {
    std::copy_n(values_.begin(), static_cast<std::ptrdiff_t>(values.size()), values.begin());
  }

 private:
  std::vector<T> values_;
};

#endif

}  // namespace gridlock::device
