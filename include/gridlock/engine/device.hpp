#pragma once

/// \file
/// The graphics processor that a program can use.
///
/// ```cpp
/// std::optional<DeviceInfo> const device = find_device();
/// std::string const name = device ? device->name : "none";
/// ```

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gridlock {

/// The processor that advances a system: the cores of the machine, or its graphics processor.
enum class Device : std::int32_t { cpu, gpu };

/// Returns the device that the environment variable GRIDLOCK_DEVICE names, "cpu" or "gpu", or else the setting.
/// Errors: Error where the variable is neither of these nor empty.
Device device_of(Device setting);

/// A graphics processor.
struct DeviceInfo {
  std::string name;             ///< the name that its maker gave it, or "emulated"
  std::size_t memory = 0;       ///< in bytes
  std::size_t free_memory = 0;  ///< in bytes
};

/// Returns the graphics processor that this program can use; nothing where it was built without, or where there is
/// none. A program built with GRIDLOCK_DEVICE=emulated has an emulated one, which runs on the cores. Cost: the first
/// call may take some tenths of a second.
std::optional<DeviceInfo> find_device();

/// Throws Error, with the key "engine.device", where find_device() finds none; its hint says why.
void require_device();
/// Throws Error, with the key "engine.device" and the number that fits, where `count` disks or agents that need `bytes`
/// bytes do not fit into the free memory of the device.
void require_room_on_device(std::size_t count, std::string_view things, std::size_t bytes);

}  // namespace gridlock
