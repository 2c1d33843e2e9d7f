#include "gridlock/engine/device.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "device/backend.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// Returns the bytes that GRIDLOCK_DEVICE_MEMORY leaves of the free memory.
std::size_t within_limit(std::size_t free_memory) {
  char const* const text = std::getenv("GRIDLOCK_DEVICE_MEMORY");
  if (text == nullptr || *text == '\0') return free_memory;
  std::string_view const digits = text;
  bool const is_number = digits.size() < 19 && digits.find_first_not_of("0123456789") == std::string_view::npos;
  if (is_number) return std::min<std::size_t>(free_memory, std::strtoull(text, nullptr, 10));
  throw Error({.what = "GRIDLOCK_DEVICE_MEMORY is \"" + std::string(text) + "\"",
               .hint = "set it to the bytes that a run may take on the graphics processor, or unset it"});
}

}  // namespace

#if defined(__CUDACC__)

void device::require_success(cudaError_t error, char const* what) {
  if (error == cudaSuccess) return;
  throw RunFailure(std::string("the graphics processor fails: ") + what + " (" + cudaGetErrorString(error) + ")");
}

namespace {

__global__ void do_nothing() {}

/// Looks for the first device, and whether this program has kernels for it.
cudaError_t look_for(DeviceInfo& device) {
  int count = 0;
  cudaDeviceProp properties;
  cudaFuncAttributes attributes;
  cudaError_t error = cudaGetDeviceCount(&count);
  if (error == cudaSuccess) error = cudaGetDeviceProperties(&properties, 0);
  if (error == cudaSuccess) error = cudaMemGetInfo(&device.free_memory, &device.memory);
  if (error == cudaSuccess) error = cudaFuncGetAttributes(&attributes, do_nothing);
  if (error != cudaSuccess) return error;
  device.name = properties.name;
  device.free_memory = within_limit(device.free_memory);
  return error;
}

}  // namespace

std::optional<DeviceInfo> find_device() {
  DeviceInfo device;
  return look_for(device) == cudaSuccess ? std::optional(device) : std::nullopt;
}

void require_device() {
  DeviceInfo device;
  cudaError_t const error = look_for(device);
  if (error == cudaSuccess) return;
  throw Error({.what = std::string("there is no graphics processor: ") + cudaGetErrorString(error),
               .hint = "use engine.device = \"cpu\" or GRIDLOCK_DEVICE=cpu; nvidia-smi says which there are",
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
