#include "gridlock/engine/device.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <string>

#include "device/backend.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// Returns the bytes that GRIDLOCK_DEVICE_MEMORY leaves of the free memory.
std::size_t within_limit(std::size_t free_memory) {
  char const* const text = std::getenv("GRIDLOCK_DEVICE_MEMORY");
  if (text == nullptr || *text == '\0') return free_memory;
  char* end = nullptr;
  unsigned long long const bytes = std::strtoull(text, &end, 10);
  if (*end == '\0' && *text != '-') return std::min<std::size_t>(free_memory, bytes);
  throw Error({.what = "GRIDLOCK_DEVICE_MEMORY is \"" + std::string(text) + "\"",
               .hint = "set it to the bytes that a run may take on the graphics processor, or unset it"});
}

}  // namespace

#if defined(__CUDACC__)

void device::require_success(cudaError_t error, char const* what) {
  if (error == cudaSuccess) return;
  throw RunFailure(std::string("the graphics processor fails: ") + what + " (" + cudaGetErrorString(error) + ")");
}

std::optional<DeviceInfo> find_device() {
  int count = 0;
  cudaDeviceProp properties;
  std::size_t free_memory = 0;
  std::size_t memory = 0;
  bool const is_found = cudaGetDeviceCount(&count) == cudaSuccess && count > 0 &&
                        cudaGetDeviceProperties(&properties, 0) == cudaSuccess &&
                        cudaMemGetInfo(&free_memory, &memory) == cudaSuccess;
  if (!is_found) return std::nullopt;
  return DeviceInfo{.name = properties.name, .memory = memory, .free_memory = within_limit(free_memory)};
}

void require_device() {
  if (find_device()) return;
  int count = 0;
  throw Error({.what = std::string("there is no graphics processor: ") + cudaGetErrorString(cudaGetDeviceCount(&count)),
               .hint = "use engine.device = \"cpu\"; nvidia-smi says which graphics processors there are",
               .key = "engine.device"});
}

#else

std::optional<DeviceInfo> find_device() {
  // As large as no graphics processor is.
  constexpr std::size_t memory = std::size_t{1} << 40U;
  return DeviceInfo{.name = "emulated", .memory = memory, .free_memory = within_limit(memory)};
}

void require_device() {}

#endif

}  // namespace gridlock
