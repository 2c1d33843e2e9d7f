#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "gridlock/core/network.hpp"

namespace gridlock {

/// Writes networks as one frame of an HDF5 file, as in a trajectory: /connectivity/networks/NAME. Errors: RunFailure.
void write_networks(std::span<Network const> networks, std::filesystem::path const& path);
/// Reads the networks of such a file, in the order of their names. Errors: Error.
std::vector<Network> read_networks(std::filesystem::path const& path);

}  // namespace gridlock
