#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/core/frame_source.hpp"
#include "gridlock/core/network.hpp"
#include "io/hdf5.hpp"

namespace gridlock::h5md {

/// Returns the group of a network, with a dataset `value` of shape (frames, edges, 2), the Ids at both ends of each
/// edge, and a dataset `weight` of shape (frames, edges). Entries beyond the edges of a frame have Ids that are absent.
std::string path_of_network(std::string const& name);

/// Creates the group and the datasets of a network, without frames. `agents` is the group of the agents; empty: none.
/// Errors of all functions here: hdf5::Failure.
void create_network(hdf5::Handle const& file, Network const& network, std::string const& agents, int compression);
/// Writes a network as frame `frame`, the last one. Errors: hdf5::Failure if the file has no such network.
void put_network(hdf5::Handle const& file, Network const& network, std::size_t frame);
/// Returns the networks of a frame, in the order of their names. A file of `bytes` bytes cannot have larger ones.
std::vector<Network> read_networks(hdf5::Handle const& file, std::size_t frame, std::uint64_t bytes);

/// Creates the groups of the fields and networks of a frame, with the steps and times of the group of the agents.
void create_beside(hdf5::Handle const& file, FrameSource const& frame, std::string const& agents, int compression);
/// Writes the fields and networks of a frame as frame `k`, the last one.
void put_beside(hdf5::Handle const& file, FrameSource const& frame, std::size_t k);
/// Returns an upper bound of the bytes that the fields and networks of a frame add to a file.
std::size_t max_bytes_beside(FrameSource const& frame);

}  // namespace gridlock::h5md
